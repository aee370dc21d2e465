/// haptics/servo/virtual_fixture.h: a force that keeps a hand from a forbidden region and adds no energy: a penalty with damping, limited by
///   a passivity observer.
///   Frame  world.   Units  SI.   Errors  out_of_range from create().   Thread  servo; fixed memory.
///   Force   along the unit vector n away from the region, at the depth p below the start of the fixture: f = K p + B max(0, -v n), at most
///           F_max, and at most (E + A) / s.
///   Passivity  f_k acts from tick k to k + 1, so the fixture has taken up E_k = - sum of f_j (x_(j+1) - x_j), j < k, exactly, whatever the
///           depth is computed from, late or from another body than the hand. The hand moves in the next tick by at most
///           s = |x_k - x_(k-1)| + a T^2, a the largest change of its speed in a second. So E_(k+1) >= E_k - f_k s >= -A: the work done on the
///           hand never exceeds the allowance A, over any motion, at any period T. The bound (E + A) / s weakens the fixture where the period
///           is long: it cannot be rendered there. A hand that shakes with all its acceleration for long may use the allowance up; then the fixture is off
///   until the stage restarts it.
///   A motion beyond that bound is a jump. It may leave E < -A; the fixture is then off until the hand has left it, and E starts from 0.
///   Source  passivity observer: Hannaford & Ryu 2002, with the pairing of force and motion that does not hide the leak of a held force
///           ([facts] stability); the limit by the next motion is our own derivation.
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct FixtureConfig {
  double start = 0.5e-3;        ///< [m] >= 0: distance from the region at which the force begins (an assumption)
  double stiffness = 2000.0;    ///< [N/m] > 0: K (an assumption)
  double damping = 5.0;         ///< [N s/m] >= 0: B (an assumption)
  double largest = 8.0;         ///< [N] > 0: F_max (an assumption: what a small device renders)
  double allowance = 1e-3;      ///< [J] > 0: A (an assumption)
  double acceleration = 100.0;  ///< [m/s^2] > 0: a (an assumption: a hand that is pushed; 10 times that of gravity)
};

/// What the fixture did.
struct FixtureFigures {
  double taken = 0.0;         ///< [J] E: taken up from the hand; negative: work done on it
  double most_given = 0.0;    ///< [J] largest work done on the hand so far
  double peak = 0.0;          ///< [N] largest force
  std::uint64_t limited = 0;  ///< ticks in which (E + A) / s was the limit
  std::uint64_t jumps = 0;    ///< motions beyond the bound while the force was not 0
};

class VirtualFixture {
 public:
  [[nodiscard]] static Result<VirtualFixture> create(const FixtureConfig& config);
  /// @param hand [m] position that the force acts on. @param distance [m] of what is guarded from the region, negative inside.
  /// @param away unit, or 0: no force. @returns the force [N] on the hand until the next call, `dt` [s] later. An argument that is not finite
  /// gives no force.
  [[nodiscard]] Vec3 operator()(const Vec3& hand, double distance, const Vec3& away, double dt) noexcept BH_REALTIME;
  /// Forgets the last position, as after a change of the tool: the motion to the next position is no work. E starts from 0.
  void restart() noexcept;
  [[nodiscard]] const FixtureFigures& figures() const noexcept { return figures_; }

 private:
  explicit VirtualFixture(const FixtureConfig& config) : config_(config) {}
  FixtureConfig config_;
  FixtureFigures figures_;
  Vec3 before_{0.0}, force_{0.0};
  double bound_ = 0.0;   // [m] of the motion in the present tick
  bool known_ = false;   // before_ is
  bool jumped_ = false;  // since the hand was last clear
};

}  // namespace burrhole
