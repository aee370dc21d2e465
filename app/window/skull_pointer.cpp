#include "app/window/skull_pointer.h"

#include <algorithm>
#include <cmath>

#include "app/view/camera.h"
#include "core/base/bounds.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kUp = 0.25;                       // [-] of half the picture: the bone is seen above the middle, and slices have room below
constexpr double kField = 0.6;                     // [rad] vertical, as in a run
constexpr double kTurn = 0.008, kTurnByKey = 1.2;  // [rad/pixel], [rad/s]
constexpr double kSteepest = 85.0 * kDegree;       // elevation, up and down
constexpr double kZoomStep = 1.1;
constexpr double kStep = 1.0e-3, kSpeed = 0.020;  // [m] of a key, [m/s] of one that is held
constexpr double kHold = 0.3;                     // [s] after which a key is held
constexpr double kAside = 38.0 * kDegree;         // of the view beside the region that it shows
constexpr double kHigher = 14.0 * kDegree;

double between(bool minus, bool plus) { return (plus ? 1.0 : 0.0) - (minus ? 1.0 : 0.0); }

bool is_arrow(Key key) { return key == Key::left || key == Key::right || key == Key::up || key == Key::down; }

}  // namespace

SkullPointer::SkullPointer(std::shared_ptr<const BoneModel> bone) : bone_(std::move(bone)) {
  const VoxelBox& box = bone_->bone_box();
  const Bounds around = bounds_under(bone_->bone_from_index(), Bounds{Vec3(box.lo), Vec3(box.hi - 1)});
  target_ = 0.5 * (around.lo + around.hi);
  distance_ = start_distance_ = std::max(0.02, 0.55 * glm::length(around.hi - around.lo)) / std::sin(0.5 * kField);
  constexpr std::array<std::size_t, 6> kOrder{2, 3, 0, 1, 4, 5};  // a parietal bone first
  for (const std::size_t n : kOrder) {
    show_region(n);
    if (site_) return;
  }
}

void SkullPointer::set_picture_size(int width, int height) noexcept {
  width_ = std::max(1, width);
  height_ = std::max(1, height);
}

void SkullPointer::handle(const WindowEvent& event, bool taken) {
  switch (event.kind) {
    case WindowEvent::Kind::key:
      if (const auto key = held_.take_key(event)) press(*key);
      return;
    case WindowEvent::Kind::button:
      if (held_.take_button(event, taken, width_) && held_.dragging() == MouseButton::left) pointed_ = glm::dvec2(event.x, event.y);
      break;
    case WindowEvent::Kind::motion:
      if (held_.dragging() == MouseButton::left) pointed_ = glm::dvec2(event.x, event.y);
      if (held_.dragging() == MouseButton::right || held_.dragging() == MouseButton::middle) {
        azimuth_ -= kTurn * (event.x - x_);
        elevation_ = std::clamp(elevation_ + kTurn * (event.y - y_), -kSteepest, kSteepest);
      }
      break;
    case WindowEvent::Kind::scroll:
      if (!taken && std::isfinite(event.y))
        distance_ =
            std::clamp(distance_ / std::pow(kZoomStep, std::clamp(event.y, -20.0, 20.0)), 0.2 * start_distance_, 3.0 * start_distance_);
      return;
    case WindowEvent::Kind::focus:
      held_.clear();
      return;
    case WindowEvent::Kind::character:
    case WindowEvent::Kind::size:
    case WindowEvent::Kind::close:
      return;
  }
  x_ = event.x;
  y_ = event.y;
}

void SkullPointer::press(Key key) {
  const int digit = static_cast<int>(key) - static_cast<int>(Key::digit_0);
  if (digit >= 1 && digit <= static_cast<int>(skull_regions().size())) return show_region(static_cast<std::size_t>(digit - 1));
  const auto zoom = [&](double factor) { distance_ = std::clamp(distance_ / factor, 0.2 * start_distance_, 3.0 * start_distance_); };
  if (key == Key::equal || key == Key::pad_plus) return zoom(kZoomStep);
  if (key == Key::minus || key == Key::pad_minus) return zoom(1.0 / kZoomStep);
  if (key == Key::f) {
    distance_ = start_distance_;
    if (site_) look_from(-site_->axis);
    return;
  }
  if (!is_arrow(key) || turns()) return;
  held_for_ = 0.0;
  const double step = kStep * scale();
  move(step * between(key == Key::left, key == Key::right), step * between(key == Key::down, key == Key::up));
}

void SkullPointer::step(double dt) {
  const double right = between(held(Key::left), held(Key::right)), up = between(held(Key::down), held(Key::up));
  if (turns()) {
    azimuth_ += kTurnByKey * dt * right;
    elevation_ = std::clamp(elevation_ + kTurnByKey * dt * up, -kSteepest, kSteepest);
  } else if (right != 0.0 || up != 0.0) {
    held_for_ += dt;
    if (held_for_ > kHold) move(kSpeed * scale() * dt * right, kSpeed * scale() * dt * up);
  }
  if (!pointed_) return;
  const glm::dvec2 pixel = *pointed_;
  pointed_.reset();
  const auto rays = make_camera_rays(camera(), static_cast<double>(width_) / height_);
  if (!rays) return;
  point_at(rays->eye, glm::normalize(rays->direction(2.0 * (pixel.x + 0.5) / width_ - 1.0, 1.0 - 2.0 * (pixel.y + 0.5) / height_)));
}

void SkullPointer::show_region(std::size_t n) {
  const SkullRegion& region = skull_regions()[n];
  look_from(region.outward);
  const auto found = find_region(*bone_, region);
  if (!found) {
    site_.reset();
    problem_ = std::string("There is no bone in the direction ") + region.name;
    return;
  }
  point_at(*found + 0.05 * region.outward, -region.outward);
  if (site_) look_from(-site_->axis);
}

void SkullPointer::look_from(const Vec3& outward) noexcept {
  const double side = outward.x < 0.0 ? 1.0 : -1.0;  // from the face, past the region
  azimuth_ = std::atan2(outward.x, -outward.y) + side * kAside;
  elevation_ = std::clamp(std::asin(std::clamp(outward.z, -1.0, 1.0)) + kHigher, -kSteepest, kSteepest);
}

void SkullPointer::point_at(const Vec3& from, const Vec3& direction) {
  const auto found = find_bone(*bone_, from, direction);
  if (!found) {
    if (!site_) problem_ = "There is no bone under the pointer";
    return;  // beside the bone the site stays where it was
  }
  at_ = *found;
  auto made = make_site(*bone_, at_, -direction);
  problem_ = made ? std::string() : "No hole can be planned here: " + made.error().message;
  site_ = made ? std::optional(*made) : std::nullopt;
  if (site_) at_ = site_->entry;
}

void SkullPointer::move(double right, double up) {
  const auto rays = make_camera_rays(camera(), static_cast<double>(width_) / height_);
  if (!rays) return;
  const Vec3 to = at_ + right * glm::normalize(rays->right) + up * glm::normalize(rays->up);
  point_at(rays->eye, glm::normalize(to - rays->eye));
}

Vec3 SkullPointer::outward() const noexcept {
  return {std::sin(azimuth_) * std::cos(elevation_), -std::cos(azimuth_) * std::cos(elevation_), std::sin(elevation_)};
}

CameraView SkullPointer::camera() const noexcept {
  CameraView out;
  out.target = target_;
  out.eye = target_ + distance_ * outward();
  out.up = Vec3(0.0, 0.0, 1.0);
  out.vertical_fov = kField;
  out.shift = {0.0, -kUp};
  return out;
}

}  // namespace burrhole
