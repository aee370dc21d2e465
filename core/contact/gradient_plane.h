/// core/contact/gradient_plane.h: penalty contact by the modified voxmap point-shell of Acosta & Liu.
///   Frame  world.   Units  SI.   Thread  contact.
///   Source  [AcostaLiu07] section 2: surface search along the tool vector, then along the gradient; tangent plane on an exposed facet or
///           through the voxel centre (figure 5); eqs. 1 and 2; the resultant is the average of the colliding points' forces.
#pragma once

#include "core/base/result.h"
#include "core/contact/packed_plane.h"
#include "core/contact/penalty_model.h"

namespace burrhole {

struct GradientPlaneConfig {
  double stiffness = 2000.0;  ///< [N/m] k of eq. 2, > 0
  bool paper_mode = false;    ///< true: any non-zero density collides and counts as bone; false: the 0.5 surface
  int max_march = 64;         ///< [voxels] along the tool vector
  int max_ascent = 64;        ///< [voxels] along the gradient
};

/// Choices where the text of the paper is not definite: N = -grad/|grad| points out of bone. A search that starts in an empty voxel
/// (possible in the default mode only, where the trilinear density decides) begins at the densest corner of its cell. Marches are bounded.
/// The tool vector replaces a missing gradient of the surface voxel.
/// Where bone has packed words, vector kernels walk them (packed_plane.h); otherwise each point walks floats or grids in double precision.
class GradientPlane final : public PenaltyModel {
 public:
  /// Errors: out_of_range when stiffness is not finite and positive, the shell is empty or too large, or a limit is not positive.
  [[nodiscard]] static Result<std::unique_ptr<PenaltyModel>> create(const GradientPlaneConfig& config, PointShell shell);
  void evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept BH_REALTIME override;
  [[nodiscard]] const PointShell& shell() const noexcept override { return shell_; }
  [[nodiscard]] double stiffness() const noexcept override { return config_.stiffness; }

 private:
  GradientPlane(const GradientPlaneConfig& config, PointShell shell) : config_(config), shell_(std::move(shell)), packed_(shell_) {}
  struct Surface;
  void evaluate_points(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept;
  [[nodiscard]] bool solid(const ContactView& bone, const Vec3i& v) const noexcept;
  [[nodiscard]] bool collides(const ContactView& bone, const Vec3& index) const noexcept;
  [[nodiscard]] bool find_surface(const ContactView& bone, const Vec3& index, const Vec3& index_tool_vector, Surface& found) const noexcept;

  GradientPlaneConfig config_;
  PointShell shell_;
  PackedPlane packed_;
};

}  // namespace burrhole
