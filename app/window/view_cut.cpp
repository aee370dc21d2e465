#include "app/window/view_cut.h"

#include <algorithm>
#include <cmath>

#include "core/base/units.h"

namespace burrhole {

Vec3 ViewCut::normal() const noexcept { return {std::sin(azimuth), -std::cos(azimuth), 0.0}; }

void ViewCut::open_towards(const CameraView& camera, const Pose& world_from_approach) noexcept {
  const Vec3 towards = world_from_approach.inverse().rotate(camera.eye - camera.target);
  on = true;
  offset = 0.0;
  azimuth = std::atan2(towards.x, -towards.y);
}

void ViewCut::move(double by) noexcept {
  if (std::isfinite(by)) offset = std::clamp(offset + by, -kFurthest, kFurthest);
}

void ViewCut::turn(double by) noexcept {
  if (std::isfinite(by)) azimuth = std::remainder(azimuth + by, 360.0 * kDegree);
}

FrameView::Cut ViewCut::plane(const Pose& world_from_approach) const noexcept {
  const Vec3 world = world_from_approach.rotate(normal());
  return {world, glm::dot(world, world_from_approach * (offset * normal()))};
}

std::optional<glm::dvec2> project(const CameraView& camera, const Vec3& point, int width, int height) noexcept {
  const Vec3 ahead = glm::normalize(camera.target - camera.eye);
  const Vec3 right = glm::normalize(glm::cross(ahead, camera.up)), up = glm::cross(right, ahead);
  const Vec3 to = point - camera.eye;
  const double deep = glm::dot(to, ahead);
  if (!(deep > 0.0)) return std::nullopt;
  const double scale = 0.5 * height / (deep * std::tan(0.5 * camera.vertical_fov));
  return glm::dvec2(0.5 * width * (1.0 - camera.shift.x) + scale * glm::dot(to, right),
                    0.5 * height * (1.0 + camera.shift.y) - scale * glm::dot(to, up));
}

}  // namespace burrhole
