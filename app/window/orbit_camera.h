/// app/window/orbit_camera.h: the camera that a person moves: round the hole, along the shaft, or as a microscope over the tip.
///   Frame  angles and target in the approach frame; camera() world.   Units  SI.   Errors  none: every value is kept in its range.
#pragma once

#include "app/view/view.h"

namespace burrhole {

enum class CameraMode {
  orbit,      ///< round a target that the person moves
  surgeon,    ///< along the shaft, from above; follows the tip
  microscope  ///< narrow field, follows the tip
};
[[nodiscard]] const char* name_of(CameraMode mode) noexcept;

class OrbitCamera {
 public:
  /// @param azimuth, elevation [rad] and distance [m] as DisplayConfig. @param deep [m] of the target below the entry.
  OrbitCamera(const Pose& world_from_approach, double azimuth, double elevation, double distance, double deep) noexcept;

  /// Turns round the target [rad].
  void turn(double azimuth, double elevation) noexcept;
  /// Moves the target [m] along the picture's right and up.
  void pan(double right, double up) noexcept;
  /// Divides the distance by `factor` > 0.
  void zoom(double factor) noexcept;
  void next_mode() noexcept;
  void set_mode(CameraMode mode) noexcept { mode_ = mode; }
  /// Sees the hole as at the start.
  void frame() noexcept;
  /// @param tip [m] approach frame. Smoothed, so that a trembling tip does not shake the picture. @param dt [s].
  void follow(const Vec3& tip, double dt) noexcept;

  [[nodiscard]] CameraMode mode() const noexcept { return mode_; }
  [[nodiscard]] CameraView camera() const noexcept;
  /// Directions of the picture's right and up in the plane across the approach axis, approach frame, length 1.
  [[nodiscard]] Vec3 right_across() const noexcept;
  [[nodiscard]] Vec3 up_across() const noexcept;
  /// @returns the length [m] at the target that a share of the picture's height covers.
  [[nodiscard]] double length_of(double share_of_height) const noexcept;

 private:
  [[nodiscard]] Vec3 outward() const noexcept;  // from the target to the eye, approach frame
  [[nodiscard]] double elevation() const noexcept;
  [[nodiscard]] double distance() const noexcept;
  [[nodiscard]] double field() const noexcept;
  [[nodiscard]] Vec3 target() const noexcept;

  Pose world_from_approach_;
  CameraMode mode_ = CameraMode::orbit;
  double azimuth_, elevation_, distance_;
  double start_azimuth_, start_elevation_, start_distance_;
  Vec3 start_target_, target_, tip_{0.0};
  bool follows_ = false;
  double zoom_ = 1.0;  // of surgeon and microscope
};

}  // namespace burrhole
