/// core/contact/voxmap_contact.h: penalty contact by the original voxmap point-shell: the tangent plane of a point passes through the
///   centre of its voxel, perpendicular to the point's tool vector; the gradient of bone is not used.
///   Frame   world.   Units  SI.   Thread  contact.
///   Source  [McNeely99] and [Renz01] as described in [AcostaLiu07] section 2 ("A tangent plane always runs through the center of the voxel
///           and is perpendicular to the haptic point's tool vector"; F = k d); how forces combine: see Stacking.
///   The staircase is a property of the published model and is kept: the plane jumps by s |N_t| (s the voxel edge, N_t the component of the
///   tool vector along the path) at each voxel boundary, and lies half a voxel below a surface along voxel faces.
#pragma once

#include "core/base/result.h"
#include "core/contact/penalty_model.h"

namespace burrhole {

/// How the forces of n colliding points (including those at d = 0) combine. The formulas are for a flat face of n points, all at depth d:
enum class Stacking : std::uint8_t {
  sum,          ///< n k d.              [McNeely99]: forces are added; stiffness grows with the face
  sum_limited,  ///< min(n, 10) k d.     own derivation, below: the sum, divided by n/10 for n > 10
  average,      ///< k d.                [AcostaLiu07] section 2: "by averaging the individually sampled forces"; falls as points join
  deepest,      ///< k d.                [Petersik03]: along the sum, with the length of the longest projection of a point's vector on it
};
// Why 10. A sum grows with the face without bound. An average is bounded, but falls when a shallow point joins: by 1/(n + 1) of the force
// for one point at depth 0 beside n others. A sum up to m points and an average beyond bounds the stiffness by m k. A join is imperceptible
// while 1/(m + 1) is below the 10 % of a force that people notice; m = 10 is the least such number. ([McNeely99] is said to have the same
// rule; the paper was not available.)

/// The voxel that the tangent plane passes through.
enum class PlaneVoxel : std::uint8_t {
  own,     ///< the voxel of the point: one lookup per point; d is at most half a diagonal, and restarts in every layer
  surface  ///< the last solid one along the tool vector, "followed until an empty voxel is found" ([AcostaLiu07] section 2, figure 4)
};

struct VoxmapContactConfig {
  double stiffness = 2000.0;  ///< [N/m] k of one point, > 0
  Stacking stacking = Stacking::sum_limited;
  PlaneVoxel plane_voxel = PlaneVoxel::own;
  bool paper_mode = false;  ///< true: any non-zero density is solid; false: density of the voxel at least 0.5
  int max_march = 64;       ///< [voxels] along the tool vector, for PlaneVoxel::surface
};

/// Own choices where the sources give no rule: a `deepest` result keeps the line of action of the sum (force and torque scaled alike);
/// points whose forces cancel (no direction) give zero. Contact::normal is the tool vector, the model's only normal.
class VoxmapContact final : public PenaltyModel {
 public:
  /// Errors: out_of_range when stiffness is not finite and positive, the shell is empty or too large, or the march limit is not positive.
  [[nodiscard]] static Result<std::unique_ptr<PenaltyModel>> create(const VoxmapContactConfig& config, PointShell shell);
  /// kContactNoSurface: a march reached max_march. kContactOutsideWindow: the point or its march left the known part. Such points have no
  /// force.
  void evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept BH_REALTIME override;
  [[nodiscard]] const PointShell& shell() const noexcept override { return shell_; }
  [[nodiscard]] double stiffness() const noexcept override { return config_.stiffness; }

 private:
  VoxmapContact(const VoxmapContactConfig& config, PointShell shell) : config_(config), shell_(std::move(shell)) {}
  [[nodiscard]] bool solid(float density) const noexcept { return config_.paper_mode ? density > 0.0f : density >= kSurfaceLevel; }
  /// @returns 0 when found, else the flag of the reason.
  [[nodiscard]] std::uint32_t find_surface(const ContactView& bone, const Vec3& index, const Vec3& step, Vec3i& voxel) const noexcept;
  void stack(ContactResult& out, const Vec3& tool_origin) const noexcept;

  VoxmapContactConfig config_;
  PointShell shell_;
};

}  // namespace burrhole
