#include "app/render/camera.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
Result<CameraRays> make_camera_rays(const CameraView& camera, double aspect) {
  const auto out_of_range = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!is_finite(camera.eye) || !is_finite(camera.target) || !is_finite(camera.up)) return out_of_range("the camera is not finite");
  if (!(camera.vertical_fov > 0.0 && camera.vertical_fov < 3.0)) return out_of_range("the camera's field of view must be in (0, 3) rad");
  const Vec3 view = camera.target - camera.eye;
  const double distance = glm::length(view);
  if (!(distance > 0.0)) return out_of_range("the camera's eye and target are one point");
  const Vec3 forward = view / distance;
  Vec3 side = glm::cross(forward, camera.up);
  if (glm::length(side) < 1e-9 * std::max(1e-300, glm::length(camera.up)) || glm::length(camera.up) == 0.0)
    side = glm::cross(forward, std::abs(forward.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(0, 1, 0));
  side = glm::normalize(side);
  const double half = std::tan(0.5 * camera.vertical_fov);
  return CameraRays{camera.eye, forward, side * (half * aspect), glm::cross(side, forward) * half};
}

DepthRange fit_depth_range(const CameraRays& rays, std::span<const Vec3> points) {
  double least = 1.0, most = kNearestPlane;
  for (const Vec3& p : points) {
    const double depth = glm::dot(p - rays.eye, rays.forward);
    least = std::min(least, depth);
    most = std::max(most, depth);
  }
  const double near_plane = std::max(kNearestPlane, 0.99 * least);
  return {near_plane, std::max(1.01 * most, 2.0 * near_plane)};
}

glm::dmat4 clip_from_world(const CameraRays& rays, const DepthRange& range) {
  // Rows by what they must give for p - eye = t (forward + x right + y up): clip = (x t, y t, 2 depth t - t, t).
  const Vec3 x_row = rays.right / glm::dot(rays.right, rays.right);
  const Vec3 y_row = rays.up / glm::dot(rays.up, rays.up);
  const double near_plane = range.near_plane, far_plane = range.far_plane;
  const double scale = (far_plane + near_plane) / (far_plane - near_plane);
  const double offset = -2.0 * far_plane * near_plane / (far_plane - near_plane);
  const glm::dvec4 rows[4] = {glm::dvec4(x_row, -glm::dot(x_row, rays.eye)), glm::dvec4(y_row, -glm::dot(y_row, rays.eye)),
                              glm::dvec4(scale * rays.forward, offset - scale * glm::dot(rays.forward, rays.eye)),
                              glm::dvec4(rays.forward, -glm::dot(rays.forward, rays.eye))};
  return glm::transpose(glm::dmat4(rows[0], rows[1], rows[2], rows[3]));
}

}  // namespace burrhole
