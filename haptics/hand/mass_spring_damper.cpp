#include "haptics/hand/mass_spring_damper.h"

#include <cmath>

namespace burrhole {

Result<MassSpringDamper> MassSpringDamper::create(const MassSpringDamperConfig& c, double period) {
  const bool sound = std::isfinite(c.mass) && c.mass > 0.0 && std::isfinite(c.damping) && c.damping >= 0.0 && std::isfinite(c.stiffness) &&
                     c.stiffness >= 0.0 && std::isfinite(period) && period > 0.0;
  if (!sound) return Error{ErrorCode::out_of_range, "mass must be above 0, damping and stiffness at least 0, the period above 0", {}};

  // Computes exp([[0, 1, 0], [-k/m, -b/m, 1/m], [0, 0, 0]] * period) by scaling and squaring; the last column is the response to a held
  // input.
  // Uses basic arithmetic only, for the same bits on every machine. glm is column-major: m[column][row].
  Mat3 rate(0.0);
  rate[1][0] = 1.0;
  rate[0][1] = -c.stiffness / c.mass;
  rate[1][1] = -c.damping / c.mass;
  rate[2][1] = 1.0 / c.mass;
  double scale = period;
  int squarings = 0;
  const double norm = std::max(1.0, (c.stiffness + c.damping + 1.0) / c.mass);
  while (scale * norm > 0.0625 && squarings < 200) {
    scale *= 0.5;
    ++squarings;
  }
  const Mat3 x = rate * scale;
  Mat3 power(1.0), sum(1.0);
  for (int n = 1; n <= 12; ++n) {
    power = power * x * (1.0 / n);
    sum += power;
  }
  for (int n = 0; n < squarings; ++n) sum = sum * sum;

  MassSpringDamper out;
  out.a_xx_ = sum[0][0];
  out.a_xv_ = sum[1][0];
  out.b_x_ = sum[2][0];
  out.a_vx_ = sum[0][1];
  out.a_vv_ = sum[1][1];
  out.b_v_ = sum[2][1];
  return out;
}

}  // namespace burrhole
