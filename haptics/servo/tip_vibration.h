/// haptics/servo/tip_vibration.h: the vibration of a turning bit: a force of fixed size that turns with the bit, as that of a rotating
///   imbalance.
///   Frame  that of the axis.   Units  SI.   Errors  out_of_range from create().   Thread  servo; fixed memory.
///   Source [TellesONeill10] section 4.3.3 adds "a slight vibration in the tool tip" to the filtered force and prints no equation. The form
///          is our own: F = A (cos p u + sin p v), dp/dt = 2 pi n s, with u, v across the axis, s the spin [rev/s], n cycles per revolution.
#pragma once

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct TipVibrationConfig {
  double amplitude = 0.1;  ///< [N] >= 0
  double cycles = 1.0;     ///< [1/rev] > 0
};

class TipVibration {
 public:
  /// A frequency above this share of the rate of the ticks is reduced to it: the ticks could not represent it.
  static constexpr double kHighest = 0.4;

  [[nodiscard]] static Result<TipVibration> create(const TipVibrationConfig& config);
  /// @param spin [rev/s] >= 0; at 0 the force is zero. @param axis unit, of the bit. @returns the force [N] of this tick of `dt` [s].
  [[nodiscard]] Vec3 operator()(double spin, const Vec3& axis, double dt) noexcept BH_REALTIME;
  void clear() noexcept { phase_ = 0.0; }

 private:
  explicit TipVibration(const TipVibrationConfig& config) : config_(config) {}
  TipVibrationConfig config_;
  double phase_ = 0.0;  // [-] in [0, 1)
};

}  // namespace burrhole
