#include "app/view/camera.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
Result<CameraRays> make_camera_rays(const CameraView& camera, double aspect) {
  const auto out_of_range = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!is_finite(camera.eye) || !is_finite(camera.target) || !is_finite(camera.up) || !is_finite(Vec3(camera.shift, 0.0)))
    return out_of_range("the camera is not finite");
  if (!(camera.vertical_fov > 0.0 && camera.vertical_fov < 3.0)) return out_of_range("the camera's field of view must be in (0, 3) rad");
  const Vec3 view = camera.target - camera.eye;
  const double distance = glm::length(view);
  if (!(distance > 0.0)) return out_of_range("the camera's eye and target are one point");
  const Vec3 axis = view / distance;
  Vec3 side = glm::cross(axis, camera.up);
  if (glm::length(side) < 1e-9 * std::max(1e-300, glm::length(camera.up)) || glm::length(camera.up) == 0.0)
    side = glm::cross(axis, std::abs(axis.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(0, 1, 0));
  side = glm::normalize(side);
  const double half = std::tan(0.5 * camera.vertical_fov);
  const Vec3 right = side * (half * aspect), up = glm::cross(side, axis) * half;
  return CameraRays{camera.eye, axis + camera.shift.x * right + camera.shift.y * up, right, up, axis};
}

DepthRange fit_depth_range(const CameraRays& rays, std::span<const Vec3> points) {
  double least = 1.0, most = kNearestPlane;
  for (const Vec3& p : points) {
    const double depth = glm::dot(p - rays.eye, rays.axis);
    least = std::min(least, depth);
    most = std::max(most, depth);
  }
  const double near_plane = std::max(kNearestPlane, 0.99 * least);
  return {near_plane, std::max(1.01 * most, 2.0 * near_plane)};
}

glm::dmat4 clip_from_world(const CameraRays& rays, const DepthRange& range) {
  // Rows from the condition for p - eye = t (forward + x right + y up): clip = (x t, y t, 2 depth t - t, t).
  // With forward = axis + sx right + sy up, (p - eye) . right / right^2 = (x + sx) t and t = (p - eye) . axis, likewise y.
  const double right_square = glm::dot(rays.right, rays.right), up_square = glm::dot(rays.up, rays.up);
  const Vec3 x_row = rays.right / right_square - glm::dot(rays.forward, rays.right) / right_square * rays.axis;
  const Vec3 y_row = rays.up / up_square - glm::dot(rays.forward, rays.up) / up_square * rays.axis;
  const double near_plane = range.near_plane, far_plane = range.far_plane;
  const double scale = (far_plane + near_plane) / (far_plane - near_plane);
  const double offset = -2.0 * far_plane * near_plane / (far_plane - near_plane);
  const glm::dvec4 rows[4] = {glm::dvec4(x_row, -glm::dot(x_row, rays.eye)), glm::dvec4(y_row, -glm::dot(y_row, rays.eye)),
                              glm::dvec4(scale * rays.axis, offset - scale * glm::dot(rays.axis, rays.eye)),
                              glm::dvec4(rays.axis, -glm::dot(rays.axis, rays.eye))};
  return glm::transpose(glm::dmat4(rows[0], rows[1], rows[2], rows[3]));
}

}  // namespace burrhole
