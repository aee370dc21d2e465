/// core/measure/support_loss.h: loss of support of a bit beyond the bone, and the plunge: its greatest advance without support.
///   The steady thrust is the mean, exponentially weighted over 0.5 s, of the thrust that bone carries while it carries more than 1 N. The bit is
///   supported while bone carries at least half of the steady thrust and more than 1 N. A loss of support begins at the last supported tick, once
///   the tip is beyond the last bone on the axis, and ends when the bit has been supported for 0.1 s without a break: a bounce does not end it.
///   Its plunge is the advance of the tip from its beginning to its deepest point. A bit that leaves the bone cutting at full thrust has no plunge.
///   Frame  none, depths along the axis.   Units  SI.   Errors  none.   Thread  contact.
///   Source the level of one half is the mid-reference level, at which the instant of a transition between two states is taken (IEEE Std 181);
///          the times are our own: 0.1 s is that of the force rule of the hand (haptics/hand/hand_script.h).
#pragma once

#include <optional>

namespace burrhole {

inline constexpr double kSupportShare = 0.5;  ///< [-] of the steady thrust
inline constexpr double kSteadyTime = 0.5;    ///< [s]
inline constexpr double kRegainTime = 0.1;    ///< [s]
inline constexpr double kSupportForce = 1.0;  ///< [N]

struct SupportLoss {
  double time = 0.0;    ///< [s] at which it began
  double depth = 0.0;   ///< [m] of the tip then
  double plunge = 0.0;  ///< [m] greatest advance beyond that depth
};

class SupportMonitor {
 public:
  /// Processes one tick. @param thrust [N] that bone carries, along the axis and against the bit's advance. @param beyond the tip is, or was,
  /// beyond the last bone on the axis.
  void look(double time, double depth, double thrust, bool beyond) noexcept;
  /// Bone has grown: losses so far do not count, the steady thrust stays.
  void forget() noexcept;
  /// @returns the loss with the greatest plunge, the first of equal ones; nothing if there was none.
  [[nodiscard]] const std::optional<SupportLoss>& worst() const noexcept { return worst_; }

 private:
  double steady_ = 0.0;                  // [N]
  double last_time_ = 0.0;               // [s]
  double held_time_ = 0.0, held_ = 0.0;  // [s], [m] of the last supported tick
  bool ever_held_ = false;
  std::optional<double> regained_;  // [s] since when the bit is supported again within a loss
  std::optional<SupportLoss> now_, worst_;
};

}  // namespace burrhole
