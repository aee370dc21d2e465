/// app/render/camera.h: a pinhole camera as rays and as a projection. No OpenGL; own derivation, shown in camera.cpp.
///   Frame world.  Units m, rad.
#pragma once

#include <span>

#include "app/engine/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Ray of a pixel: p(t) = eye + t * (forward + x * right + y * up), x and y in -1..1 (y up), t the view depth [m] along `axis`.
/// `axis` has length 1 and is square to `right` and `up`, which carry the half widths of the view at depth 1; `forward` is the ray of the
/// picture's middle, axis . forward = 1: the axis itself unless the frustum is off-axis.
struct CameraRays {
  Vec3 eye, forward, right, up, axis;

  [[nodiscard]] Vec3 direction(double x, double y) const noexcept { return forward + x * right + y * up; }
};

inline constexpr double kNearestPlane = 1e-3;  ///< [m]

/// Depth range of a picture [m], 0 < near < far.
struct DepthRange {
  double near_plane = 0.0, far_plane = 0.0;

  /// Depth buffer value in 0..1 of a view depth t: far / (far - near) * (1 - near / t).
  [[nodiscard]] double depth_of(double t) const noexcept { return far_plane / (far_plane - near_plane) * (1.0 - near_plane / t); }
  /// The other way round [m].
  [[nodiscard]] double view_depth_of(double depth) const noexcept {
    return near_plane / (1.0 - depth * (far_plane - near_plane) / far_plane);
  }
};

/// @param aspect width / height > 0. An `up` along the view is replaced by another direction.
/// @returns ErrorCode::out_of_range if a value is not finite, eye and target agree, or the field of view is outside (0, 3).
[[nodiscard]] Result<CameraRays> make_camera_rays(const CameraView& camera, double aspect);

/// The narrowest range that holds all points in front of the camera; the near plane is never nearer than kNearestPlane.
[[nodiscard]] DepthRange fit_depth_range(const CameraRays& rays, std::span<const Vec3> points);

/// clip = matrix * (p_world, 1); agrees with DepthRange::depth_of and with the rays.
[[nodiscard]] glm::dmat4 clip_from_world(const CameraRays& rays, const DepthRange& range);

}  // namespace burrhole
