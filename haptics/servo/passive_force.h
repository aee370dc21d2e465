/// haptics/servo/passive_force.h: limits a force on the hand so that it adds no energy: a passivity observer that allows for the next tick.
///   Frame  world.   Units  SI.   Errors  out_of_range from create().   Thread  servo; fixed memory.
///   Passivity  f_k acts from tick k to k + 1, so the hand has given E_k = - sum of f_j (x_(j+1) - x_j), j < k, exactly, whatever the force
///           was computed from, late or from another body than the hand. The hand moves in the next tick by at most
///           s = |x_k - x_(k-1)| + a T^2, a the largest change of its speed in a second. With |f_k| <= (E_k + A) / s, E_(k+1) >= E_k - |f_k| s >= -A:
///           the work done on the hand never exceeds the allowance A, over any motion, at any period T. The bound weakens a force where the
///           period is long: it cannot be rendered there. A hand that shakes with all its acceleration for long may use the allowance up;
///           then the force is off until the stage restarts it.
///   A motion beyond that bound is a jump. It may leave E < -A; the force is then off until none is wanted, and E starts from 0.
///   Source  passivity observer: Hannaford & Ryu 2002, with the pairing of force and motion that does not hide the leak of a held force
///           ([facts] stability); the limit by the next motion is our own derivation.
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct PassiveForceConfig {
  double allowance = 1e-3;      ///< [J] > 0: A (an assumption)
  double acceleration = 100.0;  ///< [m/s^2] > 0: a (an assumption: a hand that is pushed; 10 times that of gravity)
};

/// What the force did.
struct PassiveForceFigures {
  double taken = 0.0;         ///< [J] E: taken up from the hand; negative: work done on it
  double most_given = 0.0;    ///< [J] largest work done on the hand so far
  double peak = 0.0;          ///< [N] largest force
  std::uint64_t limited = 0;  ///< ticks in which (E + A) / s was the limit
  std::uint64_t jumps = 0;    ///< motions beyond the bound while the force was not 0
};

class PassiveForce {
 public:
  [[nodiscard]] static Result<PassiveForce> create(const PassiveForceConfig& config);
  /// @param hand [m] position that the force acts on. @param wanted [N]. @returns the force [N] on the hand until the next call, `dt` [s] later.
  /// An argument that is not finite gives no force.
  [[nodiscard]] Vec3 operator()(const Vec3& hand, const Vec3& wanted, double dt) noexcept BH_REALTIME;
  /// @returns the motion [m] of the hand since the last call; 0 before the first.
  [[nodiscard]] Vec3 moved(const Vec3& hand) const noexcept { return known_ ? hand - before_ : Vec3(0.0); }
  /// Forgets the last position, as after a change of the tool: the motion to the next position is no work. E starts from 0.
  void restart() noexcept;
  [[nodiscard]] const PassiveForceFigures& figures() const noexcept { return figures_; }

 private:
  explicit PassiveForce(const PassiveForceConfig& config) : config_(config) {}
  PassiveForceConfig config_;
  PassiveForceFigures figures_;
  Vec3 before_{0.0}, force_{0.0};
  double bound_ = 0.0;   // [m] of the motion in the present tick
  bool known_ = false;   // before_ is
  bool jumped_ = false;  // since no force was wanted
};

}  // namespace burrhole
