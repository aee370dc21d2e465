/// haptics/hand/bone_drive.h: moves a bone by keyframes, by switches of the hand (keys, buttons), and by the hand itself.
///   All three are functions of the hand's readings, which a session records, so a replay moves the bone alike, bit for bit.
///   Frame  world.   Units  SI.   Errors  none.   Thread  contact; never waits, never allocates.
#pragma once

#include <cstdint>

#include "core/base/pose_path.h"
#include "core/contact/bone_motion.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

/// Bits of HandState::switches that move the bone. Bit kFirst + 2 n moves it along the positive axis n of the bone, the next bit along the
/// negative one; n = 3..5 turn it about axis n - 3.
struct BoneSwitch {
  static constexpr int kFirst = 4;
  static constexpr int kDirections = 12;
  static constexpr std::uint32_t kGrasp = 1u << 3;  ///< the bone follows the hand: both move as one rigid body
  [[nodiscard]] static constexpr std::uint32_t bit(int direction) noexcept { return 1u << (kFirst + direction); }
};

struct BoneDriveConfig {
  Vec3 pivot{0.0};                ///< [m] point of the bone at rest about which it turns
  Quat axes{1.0, 0.0, 0.0, 0.0};  ///< world from the bone's axes at rest
  double speed = 0.02;            ///< [m/s] by switches
  double turn_rate = 0.785;       ///< [rad/s] by switches
  double period = 1e-3;           ///< [s] of the hand's ticks
};

class BoneDrive {
 public:
  /// @param path displacement of the pivot and rotation about it, world frame.
  BoneDrive(const BoneDriveConfig& config, PosePath path) : config_(config), path_(std::move(path)) {}
  /// @returns the bone's motion at the time of `hand`, whose ticks do not decrease.
  [[nodiscard]] BoneMotion move(const HandState& hand) noexcept BH_REALTIME;
  /// @returns the bone's pose before the first move().
  [[nodiscard]] Pose start() const noexcept;

 private:
  [[nodiscard]] BoneMotion by_switches(const Displacement& scripted, std::uint32_t switches, double dt) noexcept;
  [[nodiscard]] BoneMotion by_hand(const Displacement& scripted, const HandState& hand, double dt) noexcept;
  [[nodiscard]] Pose pose_of(const Displacement& total) const noexcept;

  BoneDriveConfig config_;
  PosePath path_;
  // What switches and hand add to the path.
  Vec3 added_translation_{0.0};
  Quat added_rotation_{1.0, 0.0, 0.0, 0.0};
  Pose now_;             // world from rest
  Pose hand_from_rest_;  // while the hand grasps the bone
  Quat hand_before_{1.0, 0.0, 0.0, 0.0};
  bool grasped_ = false, started_ = false;
  std::uint64_t tick_ = 0;
};

}  // namespace burrhole
