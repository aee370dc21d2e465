/// core/mesh/mesh_contact.h: penalty contact with the triangles of the surface.
///   Frame  world.   Units  SI.   Thread  contact; no state.
///   Source [TellesONeill10] section 4.3.2: from the nearest triangle to the tool, the distance to its plane is the depth (linkDist) and its
///          normal the direction of the force; section 4.3.3 eq. (1): force = matUltStrength x scaleFactor x linkDist x forceVector. The
///          product of the first two is the stiffness k.
///   Departures  The paper's tool is a ball; here each point of the shell has its nearest triangle, which for a ball is the same up to the
///          distance of its points. The paper has no sign of the distance; here a point collides if it is on the inner side of the mesh.
///          Eq. (2), the limit of the change of the force, is that of the servo (servo.slew_N_per_s).
#pragma once

#include "core/base/result.h"
#include "core/contact/penalty_model.h"

namespace burrhole {

/// How the forces of n colliding points combine.
enum class MeshStacking : std::uint8_t {
  deepest,  ///< eq. (1) of the deepest point alone
  average,  ///< the mean of all, as in [AcostaLiu07] section 2
};

struct MeshContactConfig {
  double stiffness = 2000.0;  ///< [N/m] k, > 0
  MeshStacking stacking = MeshStacking::deepest;
};

class MeshContact final : public PenaltyModel {
 public:
  /// Errors: out_of_range when stiffness is not finite and positive, or the shell is empty or too large.
  [[nodiscard]] static Result<std::unique_ptr<PenaltyModel>> create(const MeshContactConfig& config, PointShell shell);
  /// kContactOutsideWindow: a point is outside the window. kContactNoSurface: a point is in bone, and the window has no triangle. Such
  /// points have no force.
  void evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept BH_REALTIME override;
  [[nodiscard]] const PointShell& shell() const noexcept override { return shell_; }
  [[nodiscard]] double stiffness() const noexcept override { return config_.stiffness; }

 private:
  MeshContact(const MeshContactConfig& config, PointShell shell) : config_(config), shell_(std::move(shell)) {}

  MeshContactConfig config_;
  PointShell shell_;
};

}  // namespace burrhole
