/// haptics/hand/mass_spring_damper.h: m x'' + b x' + k x = u, integrated exactly over a tick with u held (zero-order hold).
#pragma once

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct MassSpringDamperConfig {
  double mass = 0.6;        ///< [kg] > 0
  double damping = 10.0;    ///< [N s/m] >= 0
  double stiffness = 1000;  ///< [N/m] >= 0
};

/// The same dynamics on three independent axes. The discretisation is exact: two half ticks equal one tick for any period.
class MassSpringDamper {
 public:
  /// Errors: out_of_range when a value is not finite or outside its range, or when period [s] is not above 0.
  [[nodiscard]] static Result<MassSpringDamper> create(const MassSpringDamperConfig& config, double period);
  /// `input` [N] is the sum of all forces except those of the spring and the damper. A rest position enters as stiffness * rest.
  /// @tparam V Vec3, or double for a single axis; both give the same bits.
  template <class V>
  void step(V& position, V& velocity, const V& input) const noexcept BH_REALTIME {
    const V x = position;
    position = a_xx_ * x + a_xv_ * velocity + b_x_ * input;
    velocity = a_vx_ * x + a_vv_ * velocity + b_v_ * input;
  }

 private:
  double a_xx_ = 1.0, a_xv_ = 0.0, a_vx_ = 0.0, a_vv_ = 1.0, b_x_ = 0.0, b_v_ = 0.0;
};

}  // namespace burrhole
