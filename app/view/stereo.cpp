#include "app/view/stereo.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/view/camera.h"
#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr std::array<std::pair<const char*, StereoMode>, 5> kModes{{{"off", StereoMode::off},
                                                                    {"side-by-side", StereoMode::side_by_side},
                                                                    {"top-bottom", StereoMode::top_bottom},
                                                                    {"anaglyph", StereoMode::anaglyph},
                                                                    {"quad", StereoMode::quad}}};

Error out_of_range(const char* why) { return {ErrorCode::out_of_range, why, {}}; }

std::size_t at(const Image& image, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
}

void place(const Image& part, int x0, int y0, Image& whole) {
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) whole.pixels[at(whole, x0 + x, y0 + y)] = part.pixels[at(part, x, y)];
}

}  // namespace

Result<std::array<CameraView, 2>> make_stereo_cameras(const CameraView& camera, const StereoView& stereo, double aspect) {
  if (!(stereo.separation >= 0.0 && std::isfinite(stereo.separation))) return out_of_range("the eyes' separation must be 0 or more");
  if (!(stereo.screen > 0.0 && std::isfinite(stereo.screen)))
    return out_of_range("the screen of a stereo picture must lie in front of the eyes");
  const auto rays = make_camera_rays(camera, aspect);
  if (!rays) return rays.error();
  const double half_width = glm::length(rays->right);  // at depth 1
  std::array<CameraView, 2> eyes{camera, camera};
  for (const int side : {-1, +1}) {
    CameraView& eye = eyes[side < 0 ? 0 : 1];
    const double moved = 0.5 * side * stereo.separation;
    const Vec3 offset = moved / half_width * rays->right;
    eye.eye += offset;
    eye.target += offset;
    eye.shift.x -= moved / (half_width * stereo.screen);
  }
  return eyes;
}

Result<CameraView> make_screen_camera(const Vec3& eye, const ScreenView& screen) {
  if (!(screen.width > 0.0 && screen.height > 0.0 && std::isfinite(screen.width) && std::isfinite(screen.height)))
    return out_of_range("a screen needs a width and a height");
  const Vec3 seen_from = screen.world_from_screen.inverse() * eye;
  if (!is_finite(seen_from) || !(seen_from.z > 0.0)) return out_of_range("the eye is not in front of the screen");
  CameraView camera;
  camera.eye = eye;
  camera.target = screen.world_from_screen * Vec3(seen_from.x, seen_from.y, 0.0);  // the foot of the eye on the screen's plane
  camera.up = screen.world_from_screen.rotate(Vec3(0.0, 1.0, 0.0));
  camera.vertical_fov = 2.0 * std::atan(0.5 * screen.height / seen_from.z);
  camera.shift = {-seen_from.x / (0.5 * screen.width), -seen_from.y / (0.5 * screen.height)};
  return camera;
}

Result<std::array<CameraView, 2>> make_workbench_cameras(const Pose& world_from_head, double separation, const ScreenView& screen) {
  std::array<CameraView, 2> eyes;
  for (const int side : {-1, +1}) {
    auto camera = make_screen_camera(world_from_head * Vec3(0.5 * side * separation, 0.0, 0.0), screen);
    if (!camera) return camera.error();
    eyes[side < 0 ? 0 : 1] = camera.value();
  }
  return eyes;
}

const char* stereo_name(StereoMode mode) noexcept {
  return std::ranges::find(kModes, mode, &std::pair<const char*, StereoMode>::second)->first;
}

StereoMode stereo_mode(std::string_view name) noexcept {
  const auto found = std::ranges::find(kModes, name, &std::pair<const char*, StereoMode>::first);
  return found == kModes.end() ? StereoMode::off : found->second;
}

Result<std::vector<CameraView>> make_eye_cameras(const CameraView& camera, const StereoView& stereo, double aspect) {
  const bool both = stereo.mode != StereoMode::off;
  if (!stereo.workbench) {
    if (!both) return std::vector<CameraView>{camera};
    const auto eyes = make_stereo_cameras(camera, stereo, aspect);
    if (!eyes) return eyes.error();
    return std::vector<CameraView>(eyes->begin(), eyes->end());
  }
  const auto rays = make_camera_rays(camera, aspect);
  if (!rays) return rays.error();
  const Vec3 towards = glm::normalize(camera.eye - camera.target), right = glm::normalize(rays->right);
  const Quat turned = glm::quat_cast(glm::dmat3(right, glm::cross(towards, right), towards));
  const ScreenView screen{{turned, camera.target}, stereo.workbench->height * aspect, stereo.workbench->height};
  const Pose world_from_head{turned, screen.world_from_screen * stereo.workbench->head};
  std::vector<CameraView> out;
  if (both) {
    const auto eyes = make_workbench_cameras(world_from_head, stereo.separation, screen);
    if (!eyes) return eyes.error();
    out.assign(eyes->begin(), eyes->end());
  } else {
    const auto eye = make_screen_camera(world_from_head.translation, screen);
    if (!eye) return eye.error();
    out.push_back(*eye);
  }
  for (CameraView& eye : out) eye.fog = camera.fog;  // the screen stands at the camera's target
  return out;
}

Image make_screen_picture(const StereoView& stereo, std::vector<Image> eyes) {
  BH_ASSERT(eyes.size() == (stereo.mode == StereoMode::off ? 1u : 2u));
  Image out = eyes.size() == 1 ? std::move(eyes.front()) : join_eyes(stereo.mode, eyes[0], eyes[1]);
  if (!stereo.workbench || !stereo.workbench->mirrored) return out;
  // Each eye's picture is turned upside down by itself: the left eye stays left, and above stays above.
  const int parts = stereo.mode == StereoMode::top_bottom ? 2 : 1, rows = out.height / parts;
  for (int part = 0; part < parts; ++part)
    for (int y = 0; y < rows / 2; ++y) {
      const auto row = [&](int n) { return out.pixels.begin() + static_cast<std::ptrdiff_t>(at(out, 0, part * rows + n)); };
      std::swap_ranges(row(y), row(y) + out.width, row(rows - 1 - y));
    }
  return out;
}

std::vector<Image> make_buffer_pictures(const StereoView& stereo, std::vector<Image> eyes) {
  std::vector<Image> out;
  if (stereo.mode != StereoMode::quad) {
    out.push_back(make_screen_picture(stereo, std::move(eyes)));
    return out;
  }
  StereoView of_eye = stereo;
  of_eye.mode = StereoMode::off;
  for (Image& eye : eyes) {
    std::vector<Image> one;
    one.push_back(std::move(eye));
    out.push_back(make_screen_picture(of_eye, std::move(one)));
  }
  return out;
}

Image join_eyes(StereoMode mode, const Image& left, const Image& right) {
  BH_ASSERT(left.width == right.width && left.height == right.height);
  if (mode == StereoMode::anaglyph) {
    Image out = right;
    for (std::size_t n = 0; n < out.pixels.size(); ++n) {
      const Rgba8& p = left.pixels[n];
      out.pixels[n].r = static_cast<std::uint8_t>((299 * p.r + 587 * p.g + 114 * p.b + 500) / 1000);
    }
    return out;
  }
  const bool stacked = mode == StereoMode::top_bottom;
  Image out{stacked ? left.width : 2 * left.width, stacked ? 2 * left.height : left.height, {}};
  out.pixels.resize(2 * left.pixels.size());
  place(left, 0, 0, out);
  place(right, stacked ? 0 : left.width, stacked ? left.height : 0, out);
  return out;
}

}  // namespace burrhole
