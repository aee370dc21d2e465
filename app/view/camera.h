/// app/view/camera.h: a pinhole camera as rays and as a projection matrix. No OpenGL.
///   Frame world.  Units m, rad.   Errors  out_of_range.   Source  own derivation, shown in camera.cpp.
#pragma once

#include <span>

#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Ray of a pixel: p(t) = eye + t * (forward + x * right + y * up), x and y in -1..1 (y up), t the view depth [m] along `axis`.
/// `axis` has length 1 and is perpendicular to `right` and `up`, whose lengths are the half widths of the view at depth 1. `forward` is the
/// ray of the picture's centre with axis . forward = 1; it equals `axis` unless the frustum is off-axis.
struct CameraRays {
  Vec3 eye, forward, right, up, axis;  ///< [m], others [-]

  [[nodiscard]] Vec3 direction(double x, double y) const noexcept { return forward + x * right + y * up; }
};

inline constexpr double kNearestPlane = 1e-3;  ///< [m]

/// Depth range of a picture, 0 < near < far.
struct DepthRange {
  double near_plane = 0.0, far_plane = 0.0;  ///< [m]

  /// @returns the depth buffer value in 0..1 of a view depth t [m]: far / (far - near) * (1 - near / t).
  [[nodiscard]] double depth_of(double t) const noexcept { return far_plane / (far_plane - near_plane) * (1.0 - near_plane / t); }
  /// @returns the view depth [m] of a depth buffer value.
  [[nodiscard]] double view_depth_of(double depth) const noexcept {
    return near_plane / (1.0 - depth * (far_plane - near_plane) / far_plane);
  }
};

/// @param aspect width / height > 0. An `up` parallel to the view is replaced by another direction.
/// @returns ErrorCode::out_of_range if a value is not finite, eye and target are equal, or the field of view is outside (0, 3) rad.
[[nodiscard]] Result<CameraRays> make_camera_rays(const CameraView& camera, double aspect);

/// @returns the narrowest range that contains all points in front of the camera; the near plane is at least kNearestPlane.
[[nodiscard]] DepthRange fit_depth_range(const CameraRays& rays, std::span<const Vec3> points);

/// @returns the matrix of clip = matrix * (p_world, 1); consistent with DepthRange::depth_of and the rays.
[[nodiscard]] glm::dmat4 clip_from_world(const CameraRays& rays, const DepthRange& range);

}  // namespace burrhole
