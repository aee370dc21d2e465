/// tests/haptics/device/plant_twin.h: slow plain twin of one axis of Plant: Runge-Kutta in long double, with what it dissipated.
#pragma once

#include <cmath>

namespace burrhole::test {

struct PlantTwin {
  using Real = long double;
  Real mass = 0.1L, damping = 0.5L, stiffness = 0.0L, friction = 0.0L;
  Real x = 0.0L, v = 0.0L;            ///< [m], [m/s]
  Real dissipated = 0.0L;             ///< [J] by damping and friction
  static constexpr int kSteps = 100;  ///< a tick

  [[nodiscard]] Real pull(Real force, Real rest) const { return force - stiffness * (x - rest); }

  /// One tick under a held force; an axis stops at most once in it.
  void step(Real force, Real rest, Real period) {
    Real left = period;
    const Real h = period / kSteps;
    while (left > 0.0L) {
      if (v == 0.0L && std::abs(pull(force, rest)) <= friction) return;
      const Real sign = v != 0.0L ? (v > 0.0L ? 1.0L : -1.0L) : (pull(force, rest) > 0.0L ? 1.0L : -1.0L);
      const PlantTwin before = *this;
      Real part = std::min(h, left);
      advance(force, rest, sign, part);
      if (sign * v < 0.0L) part = stop_within(before, force, rest, sign, part);
      left -= part;
    }
  }

 private:
  struct Rate {
    Real x, v, d;
  };
  [[nodiscard]] Rate rate(Real force, Real rest, Real sign, const Rate& y) const {
    return {y.v, (force - stiffness * (y.x - rest) - damping * y.v - sign * friction) / mass, damping * y.v * y.v + sign * friction * y.v};
  }
  void advance(Real force, Real rest, Real sign, Real h) {
    const auto along = [&](const Rate& k, Real share) { return Rate{x + share * k.x, v + share * k.v, dissipated + share * k.d}; };
    const Rate k1 = rate(force, rest, sign, {x, v, dissipated}), k2 = rate(force, rest, sign, along(k1, h / 2));
    const Rate k3 = rate(force, rest, sign, along(k2, h / 2)), k4 = rate(force, rest, sign, along(k3, h));
    x += h / 6 * (k1.x + 2 * k2.x + 2 * k3.x + k4.x);
    v += h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
    dissipated += h / 6 * (k1.d + 2 * k2.d + 2 * k3.d + k4.d);
  }
  /// Bisects the length of the step at whose end the velocity is zero, and leaves the twin there.
  Real stop_within(const PlantTwin& before, Real force, Real rest, Real sign, Real part) {
    Real low = 0.0L, high = part;
    for (int n = 0; n < 64; ++n) {
      const Real middle = 0.5L * (low + high);
      *this = before;
      advance(force, rest, sign, middle);
      (sign * v > 0.0L ? low : high) = middle;
    }
    v = 0.0L;
    return high;
  }
};

}  // namespace burrhole::test
