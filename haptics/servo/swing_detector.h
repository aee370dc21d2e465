/// haptics/servo/swing_detector.h: detects a limit cycle of the force loop in the force that the servo applies.
///   Frame  any; the three axes are treated independently.   Units SI.   Thread servo, fixed memory.
///   A swing is a change of force from one turning point to the next by at least `force`, within at most `longest`. A limit cycle is a row of
///   kSwings swings that does not decay: the sum of the later half is at least kLasting of that of the earlier half. A stable loop that rings
///   after an impact decays; the force of drilling changes slowly or by single steps.
///   Source  own derivation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.h"
#include "core/base/geometry.h"

namespace burrhole {

struct SwingConfig {
  double force = 0.0;    ///< [N] >= 0: smallest change from one turning point to the next that counts; 0: no detector
  double longest = 0.1;  ///< [s] >= 0: longest time from one turning point to the next
};

/// A limit cycle as measured.
struct Swing {
  double force = 0.0;      ///< [N] mean change between turning points; 0: none was found
  double frequency = 0.0;  ///< [Hz]
  std::uint64_t tick = 0;  ///< tick of the first turning point of the first limit cycle
};

class SwingDetector {
 public:
  static constexpr std::size_t kSwings = 12;  // six periods
  static constexpr double kLasting = 0.9;     // [-]

  SwingDetector(const SwingConfig& config, double dt) noexcept;
  /// One tick. @param force [N] on the hand. @returns whether a limit cycle is in progress.
  bool operator()(const Vec3& force) noexcept BH_REALTIME;
  /// The largest limit cycle so far.
  [[nodiscard]] const Swing& largest() const noexcept { return largest_; }

 private:
  struct Axis {
    double extreme = 0.0, turned = 0.0;  // [N] since the last turning point, and there; before the first change largest and smallest
    double sign = 0.0;                   // of the present change; 0 before the first
    bool begun = false;                  // `turned` is a turning point: the first change starts anywhere
    std::uint64_t extreme_tick = 0, turned_tick = 0;
    std::array<double, kSwings> swing{};        // [N] ring
    std::array<std::uint64_t, kSwings> took{};  // [ticks] ring
    std::size_t next = 0, count = 0;
    bool lasts = false;
  };
  void follow(Axis& axis, double force) noexcept;
  void turn(Axis& axis, double force) noexcept;
  void judge(Axis& axis) noexcept;

  double least_, dt_;
  std::uint64_t longest_;  // [ticks]
  std::uint64_t tick_ = 0;
  std::array<Axis, 3> axes_;
  Swing largest_;
};

}  // namespace burrhole
