/// tests/support/ablation_twin.h: a layer of bone that is cut at a steady feed, in one dimension, for tests of heat. The heat of cutting enters the
/// cut face, bone leaves at the temperature of that face, the other face is insulated. Volumes between nodes that move with the cut face, so
/// that the face is always a node; backward Euler. 400 nodes and steps of 2 ms are within 0.01 % of 800 nodes and 1 ms.
///   Units  SI, of bone as HeatConfig has it; a square metre; rises [K]; dose [min].
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/heat/heat_field.h"
#include "core/heat/thermal_dose.h"

namespace burrhole::test {

struct AblationTwin {
  double in_bone = 0.0, chips = 0.0;          ///< [J/m^2]
  double inner_rise = 0.0, inner_dose = 0.0;  ///< of the insulated face
};

/// @param flow [W/m^2] into the cut face. @param feed [m/s]. @param length [m] of the layer, more than feed x seconds.
inline AblationTwin ablate(double flow, double feed, double length, double seconds) {
  constexpr std::size_t kLast = 400;
  const HeatConfig bone{};
  const double alpha = bone.diffusivity(), heat = bone.density * bone.capacity, dt = 2e-3;
  std::vector<double> node(kLast + 1), rise(kLast + 1), lower(kLast + 1), middle(kLast + 1), upper(kLast + 1), right(kLast + 1);
  for (std::size_t n = 0; n <= kLast; ++n) node[n] = std::pow(static_cast<double>(n) / kLast, 1.5);  // 0: the cut face, 1: the inner one
  const auto edge = [&](std::size_t n) { return n == 0 ? 0.0 : n > kLast ? 1.0 : 0.5 * (node[n - 1] + node[n]); };  // above node n
  AblationTwin out;
  double depth = 0.0;
  for (double t = 0.0; t < seconds - 0.5 * dt; t += dt) {
    const double before = length - depth, after = before - feed * dt;
    for (std::size_t n = 0; n <= kLast; ++n) {
      const double width = edge(n + 1) - edge(n);
      lower[n] = upper[n] = 0.0;
      middle[n] = width * after / dt;
      right[n] = width * before / dt * rise[n];
      if (n == 0) {
        middle[n] += feed;
        right[n] += flow / heat;
      } else {
        const double conducts = alpha / ((node[n] - node[n - 1]) * after), carries = 0.5 * feed * (1.0 - edge(n));
        middle[n] += conducts + carries;
        lower[n] = -conducts + carries;
      }
      if (n < kLast) {
        const double conducts = alpha / ((node[n + 1] - node[n]) * after), carries = 0.5 * feed * (1.0 - edge(n + 1));
        middle[n] += conducts - carries;
        upper[n] = -conducts - carries;
      }
    }
    for (std::size_t n = 1; n <= kLast; ++n) {
      const double factor = lower[n] / middle[n - 1];
      middle[n] -= factor * upper[n - 1];
      right[n] -= factor * right[n - 1];
    }
    rise[kLast] = right[kLast] / middle[kLast];
    for (std::size_t n = kLast; n-- > 0;) rise[n] = (right[n] - upper[n] * rise[n + 1]) / middle[n];
    out.chips += heat * feed * rise[0] * dt;
    out.inner_dose += thermal_dose(bone.body + rise[kLast], dt);
    depth += feed * dt;
  }
  for (std::size_t n = 0; n <= kLast; ++n) out.in_bone += heat * (edge(n + 1) - edge(n)) * (length - depth) * rise[n];
  out.inner_rise = rise[kLast];
  return out;
}

/// @returns the error of the heat in bone in a field that is derived [-]. A steady cut warms bone by exp(-x v / alpha) of its rise at the depth x. Between the
/// means of a cut cell of the thickness d and of a whole one of h, the field takes the rise for a line; of the parabola the cut cell is colder by
/// (h^2 - d^2) / 6 (v / alpha)^2 of its rise. So bone leaves too warm by at most (h v / alpha)^2 / 6. What bone has too little is what chips have too
/// much. Half a tick of heat comes too early or too late.
/// @param flow, feed as above. @param edge [m] of a cell. @param tick [s].
inline double heat_error(const AblationTwin& exact, double flow, double feed, double edge, double tick) {
  return exact.chips / exact.in_bone * std::pow(edge * feed / HeatConfig{}.diffusivity(), 2.0) / 6.0 + 0.5 * tick * flow / exact.in_bone;
}

/// @returns the time [s] by which the dose of the inner face in a field lags if its last cell holds a share s of bone as loaded. While all warm by
/// r [K/s], that bone lags the mean of the next cell by (1 + s) / 2 r h^2 / alpha, since it conducts with k s and not over its thickness s h.
/// Of a parabola the lag is (1 + 2 s) (1 + s) / 6 r h^2 / alpha. The difference, (1 - s^2) / 3, is largest for s = 0, and 0 for s = 1.
inline double lag_of_face(double edge, double share) { return (1.0 - share * share) / 3.0 * edge * edge / HeatConfig{}.diffusivity(); }

}  // namespace burrhole::test
