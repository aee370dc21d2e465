/// core/contact/voxmap_contact.h: penalty contact by the original voxmap point-shell: the tangent plane of a point runs through the centre
/// of its voxel and is perpendicular to its tool vector; the gradient of the bone is not asked for.
///   Frame   world.   Units  SI.   Thread  contact.
///   Source  [McNeely99] and [Renz01] as [AcostaLiu07] section 2 tells them ("A tangent plane always runs through the center of the voxel
///           and is perpendicular to the haptic point's tool vector"; F = k d); how forces stack, at each Stacking.
///   Its staircase is the finding, not a fault: the plane jumps by s |N_t| (s the voxel edge, N_t the part of the tool vector along the
///   way) at each voxel boundary crossed, and lies half a voxel under a surface that runs along voxel faces.
#pragma once

#include "core/base/result.h"
#include "core/contact/contact_model.h"

namespace burrhole {

/// How the forces of n colliding points (those at d = 0 included) become one. A flat face of n points, all at depth d:
enum class Stacking : std::uint8_t {
  sum,          ///< n k d.              [McNeely99]: forces are added; stiffness grows with the face
  sum_limited,  ///< min(n, 10) k d.     [McNeely99]'s remedy: the sum is divided by n/10 once n > 10 (recalled, not read again)
  average,      ///< k d.                [AcostaLiu07] section 2: "by averaging the individually sampled forces"; falls as points join
  deepest,      ///< k d.                [Petersik03]: along the sum, as long as the longest projection of a point's vector on it
};

/// Which voxel the tangent plane runs through.
enum class PlaneVoxel : std::uint8_t {
  own,     ///< the one that the point is in: one look-up a point; d is at most half a diagonal, and begins anew in every layer
  surface  ///< the last solid one along the tool vector, "followed until an empty voxel is found" ([AcostaLiu07] section 2, figure 4)
};

struct VoxmapContactConfig {
  double stiffness = 2000.0;  ///< [N/m] k of one point, > 0
  Stacking stacking = Stacking::sum_limited;
  PlaneVoxel plane_voxel = PlaneVoxel::own;
  bool paper_mode = false;  ///< true: any non-zero density is solid; false: density of the voxel at least 0.5
  int max_march = 64;       ///< [voxels] along the tool vector, for PlaneVoxel::surface
};

/// Own derivations where the sources are silent: a `deepest` result keeps the line of action of the sum (force and torque scaled alike);
/// points that cancel (no direction left) give nothing. Contact::normal is the tool vector, the model's only idea of "out".
class VoxmapContact final : public ContactModel {
 public:
  /// out_of_range when stiffness is not finite and positive, the shell is empty or too large, or the march limit is not positive.
  [[nodiscard]] static Result<std::unique_ptr<ContactModel>> create(const VoxmapContactConfig& config, PointShell shell);
  /// kContactNoSurface: a march met max_march; kContactOutsideWindow: the point or its march left what is known. Such points give no force.
  void evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept BH_REALTIME override;
  [[nodiscard]] const PointShell& shell() const noexcept override { return shell_; }

 private:
  VoxmapContact(const VoxmapContactConfig& config, PointShell shell) : config_(config), shell_(std::move(shell)) {}
  [[nodiscard]] bool solid(float density) const noexcept { return config_.paper_mode ? density > 0.0f : density >= kSurfaceLevel; }
  /// 0 when found, else the flag that says why not.
  [[nodiscard]] std::uint32_t find_surface(const ContactView& bone, const Vec3& index, const Vec3& step, Vec3i& voxel) const noexcept;
  void stack(ContactResult& out, const Vec3& tool_origin) const noexcept;

  VoxmapContactConfig config_;
  PointShell shell_;
};

}  // namespace burrhole
