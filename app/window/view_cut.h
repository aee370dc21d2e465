/// app/window/view_cut.h: the plane at which a person cuts the picture open. The plane is parallel to the approach axis.
///   Frame  approach frame unless stated.   Units  SI; pixels.   Errors  none.   Thread  any.
#pragma once

#include <optional>

#include "app/view/view.h"

namespace burrhole {

struct ViewCut {
  static constexpr double kFurthest = 0.02;  ///< [m] of the plane from the axis

  bool on = false;
  double azimuth = 0.0;  ///< [rad] of the side that is not drawn, about the approach axis, from -y towards +x as the camera's
  double offset = 0.0;   ///< [m] of the plane from the axis, towards that side

  /// Opens the picture at the axis, towards the eye.
  void open_towards(const CameraView& camera, const Pose& world_from_approach) noexcept;
  /// Moves the plane, within kFurthest.
  void move(double by) noexcept;
  void turn(double by) noexcept;

  [[nodiscard]] Vec3 normal() const noexcept;  ///< towards the side that is not drawn
  [[nodiscard]] FrameView::Cut plane(const Pose& world_from_approach) const noexcept;
  friend bool operator==(const ViewCut&, const ViewCut&) = default;
};

/// @returns where a picture shows a point; nothing if it lies behind the eye. @param point [m] world. @param width, height [pixels].
[[nodiscard]] std::optional<glm::dvec2> project(const CameraView& camera, const Vec3& point, int width, int height) noexcept;

}  // namespace burrhole
