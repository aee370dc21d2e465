/// app/window/skull_pointer.h: the place on a bone to which a person points, and the camera that they turn. It knows no window system.
///   Frame  bone frame; pixels of the picture, origin at the top left.   Units  SI.   Errors  none: problem() says why there is no site.
///   Thread one at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/view/view.h"
#include "app/window/held_input.h"
#include "app/window/skull_site.h"
#include "app/window/window_event.h"

namespace burrhole {

class SkullPointer {
 public:
  /// Points at the first region that has bone, and shows it.
  explicit SkullPointer(std::shared_ptr<const BoneModel> bone);

  void set_picture_size(int width, int height) noexcept;
  /// Left click and drag: the point of the bone there. Arrows: move it over the bone; Shift: a fifth of the way. 1 to 6: a region of the
  /// skull. Right drag, Ctrl + arrows: turn the view. Wheel, +, -: zoom. F: the site from outside. @param taken the mouse is not the picture's.
  void handle(const WindowEvent& event, bool taken);
  /// Advances by `dt` [s]: held keys, and the site where the person points now.
  void step(double dt);

  [[nodiscard]] CameraView camera() const noexcept;
  [[nodiscard]] const std::optional<DrillSite>& site() const noexcept { return site_; }
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }  ///< empty where there is a site
  [[nodiscard]] const BoneModel& bone() const noexcept { return *bone_; }

 private:
  void press(Key key);
  void show_region(std::size_t n);
  /// Views a direction from outside, a little from the side, so that a bit does not hide its own tip.
  void look_from(const Vec3& outward) noexcept;
  /// The ray of a point of the picture meets bone there.
  void point_at(const Vec3& from, const Vec3& direction);
  void move(double right, double up);  // [m] over the bone as the picture shows it
  [[nodiscard]] bool held(Key key) const { return held_.has(key); }
  [[nodiscard]] bool turns() const { return held(Key::left_control) || held(Key::right_control); }
  [[nodiscard]] double scale() const { return held(Key::left_shift) || held(Key::right_shift) ? 0.2 : 1.0; }
  [[nodiscard]] Vec3 outward() const noexcept;  // from the target to the eye

  std::shared_ptr<const BoneModel> bone_;
  Vec3 target_{0.0}, at_{0.0};
  double azimuth_ = 0.0, elevation_ = 0.0, distance_ = 0.4, start_distance_ = 0.4;
  std::optional<DrillSite> site_;
  std::string problem_;
  HeldInput held_;
  double held_for_ = 0.0;                // [s] of an arrow
  std::optional<glm::dvec2> pointed_{};  // [pixels] not resolved yet
  double x_ = 0.0, y_ = 0.0;
  int width_ = 1, height_ = 1;
};

}  // namespace burrhole
