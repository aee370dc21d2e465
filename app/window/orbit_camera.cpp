#include "app/window/orbit_camera.h"

#include <algorithm>
#include <cmath>

#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kField = 0.6;                                        // [rad] vertical, as in the pictures of a run
constexpr double kMicroscopeField = 0.16;                             // [rad]
constexpr double kLowest = 3.0 * kDegree, kHighest = 87.0 * kDegree;  // elevation
constexpr double kSurgeonElevation = 72.0 * kDegree;                  // the shaft does not hide the tip
constexpr double kNearest = 0.012, kFarthest = 0.6;                   // [m]
constexpr double kFollow = 0.25;                                      // [s] time constant

}  // namespace

const char* name_of(CameraMode mode) noexcept {
  switch (mode) {
    case CameraMode::orbit:
      return "orbit";
    case CameraMode::surgeon:
      return "surgeon";
    case CameraMode::microscope:
      return "microscope";
  }
  return "";
}

OrbitCamera::OrbitCamera(const Pose& world_from_approach, double azimuth, double elevation, double distance, double deep) noexcept
    : world_from_approach_(world_from_approach),
      azimuth_(azimuth),
      elevation_(std::clamp(elevation, kLowest, kHighest)),
      distance_(std::clamp(distance, kNearest, kFarthest)),
      start_azimuth_(azimuth_),
      start_elevation_(elevation_),
      start_distance_(distance_),
      start_target_(0.0, 0.0, -deep),
      target_(start_target_) {}

void OrbitCamera::turn(double azimuth, double elevation) noexcept {
  if (!std::isfinite(azimuth) || !std::isfinite(elevation)) return;
  azimuth_ = std::remainder(azimuth_ + azimuth, 360.0 * kDegree);
  elevation_ = std::clamp(elevation_ + elevation, kLowest, kHighest);
}

void OrbitCamera::pan(double right, double up) noexcept {
  const double reach = start_distance_;
  const Vec3 moved = target_ + right * right_across() + up * up_across();
  if (is_finite(moved)) target_ = glm::clamp(moved, start_target_ - reach, start_target_ + reach);
}

void OrbitCamera::zoom(double factor) noexcept {
  if (!(std::isfinite(factor) && factor > 0.0)) return;
  if (mode_ == CameraMode::orbit)
    distance_ = std::clamp(distance_ / factor, kNearest, kFarthest);
  else
    zoom_ = std::clamp(zoom_ * factor, 0.3, 4.0);
}

void OrbitCamera::next_mode() noexcept {
  mode_ = mode_ == CameraMode::orbit ? CameraMode::surgeon : mode_ == CameraMode::surgeon ? CameraMode::microscope : CameraMode::orbit;
}

void OrbitCamera::frame() noexcept {
  mode_ = CameraMode::orbit;
  azimuth_ = start_azimuth_;
  elevation_ = start_elevation_;
  distance_ = start_distance_;
  target_ = start_target_;
  zoom_ = 1.0;
}

void OrbitCamera::follow(const Vec3& tip, double dt) noexcept {
  // A tip that hardly moves leaves the picture alone, so that only what changed is drawn again.
  constexpr double kStart = 4e-4, kStop = 2e-5;  // [m]
  if (!is_finite(tip)) return;
  const double away = glm::length(tip - tip_);
  follows_ = follows_ ? away > kStop : away > kStart;
  if (follows_) tip_ += (tip - tip_) * (1.0 - std::exp(-dt / kFollow));
}

double OrbitCamera::elevation() const noexcept { return mode_ == CameraMode::surgeon ? kSurgeonElevation : elevation_; }
double OrbitCamera::field() const noexcept { return mode_ == CameraMode::microscope ? kMicroscopeField / zoom_ : kField; }
double OrbitCamera::distance() const noexcept {
  return mode_ == CameraMode::orbit ? distance_ : mode_ == CameraMode::surgeon ? 1.1 * start_distance_ / zoom_ : 1.6 * start_distance_;
}
Vec3 OrbitCamera::target() const noexcept { return mode_ == CameraMode::orbit ? target_ : tip_; }

Vec3 OrbitCamera::outward() const noexcept {
  const double up = elevation();
  return {std::sin(azimuth_) * std::cos(up), -std::cos(azimuth_) * std::cos(up), std::sin(up)};
}

CameraView OrbitCamera::camera() const noexcept {
  CameraView out;
  out.target = world_from_approach_ * target();
  out.eye = world_from_approach_ * (target() + outward() * distance());
  out.up = world_from_approach_.rotate(Vec3(0.0, 0.0, 1.0));
  out.vertical_fov = field();
  if (mode_ == CameraMode::microscope) out.fog.emplace();
  return out;
}

Vec3 OrbitCamera::right_across() const noexcept { return {std::cos(azimuth_), std::sin(azimuth_), 0.0}; }
Vec3 OrbitCamera::up_across() const noexcept { return {-std::sin(azimuth_), std::cos(azimuth_), 0.0}; }
double OrbitCamera::length_of(double share_of_height) const noexcept {
  return share_of_height * 2.0 * distance() * std::tan(0.5 * field());
}

}  // namespace burrhole
