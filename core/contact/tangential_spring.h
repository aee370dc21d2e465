/// core/contact/tangential_spring.h: applies a tangential law to a tool of prescribed pose, as in penalty models. A spring connects the
///   tool to a massless slider; the law holds or moves the slider; the spring's load acts on the tool.
///   Frame  any in which bone is at rest.   Units  SI.   Thread  contact or servo; never allocates.
///   There is one slider for the whole tool, not one per point: points that join or leave do not change the stretch, so a varying load
///   causes no creep of the tool. The spring's stiffness must be constant; a variable stiffness would generate energy.
///   Source  own derivation; the spring and slider in series are the elastic-plastic friction model with return mapping.
#pragma once

#include <array>
#include <span>

#include "core/base/assert.h"
#include "core/contact/penalty_model.h"
#include "core/contact/tangential_law.h"

namespace burrhole {

/// Pressed points, at most kMaxPressedPoints.
struct PressedPoints {
  std::array<PressedPoint, kMaxPressedPoints> points{};
  std::size_t count = 0;
  [[nodiscard]] std::span<const PressedPoint> list() const noexcept { return {points.data(), count}; }
};

/// Lists the contacts of a penalty evaluation in the bone frame, each with its share of the normal force [N], in proportion to depth. More
/// than kMaxPressedPoints are merged in a grid of 4 x 4 x 4 cells over their bounding box; the sum of the loads along their normals is
/// preserved.
/// @param force [N] world frame, of the evaluation.
void list_pressed(std::span<const Contact> contacts, const Vec3& force, const Pose& world_from_bone, const Vec3& tool_origin,
                  PressedPoints& out) noexcept BH_REALTIME;

struct TangentialSpringConfig {
  double stiffness = 1.0;       ///< [N/m] > 0
  double turn_stiffness = 1.0;  ///< [N m/rad] > 0; may be infinite
};

/// [m^2] Mean square distance of a shell's points from the tool origin: the ratio of rotational to translational stiffness.
[[nodiscard]] double mean_square_lever(const PointShell& shell) noexcept;

class TangentialSpring {
 public:
  void clear() noexcept { placed_ = false; }
  /// One step of dt [s]. @param spin [rad/s] of the tool's surface. @returns the tangential load on the tool: force [N], torque [N m] about
  /// the tool origin. When no point is pressed it returns zero and resets the slider.
  [[nodiscard]] Wrench step(TangentialLaw& law, const TangentialSpringConfig& config, std::span<const PressedPoint> points,
                            const Pose& bone_from_tool, const Vec3& spin, double dt) noexcept BH_REALTIME;

 private:
  Pose before_;
  SmallMove stretch_;  // pose of the tool relative to the slider
  bool placed_ = false;
};

}  // namespace burrhole
