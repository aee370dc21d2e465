#include "core/heat/thermal_dose.h"

#include <algorithm>
#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {

double thermal_dose(double celsius, double seconds) noexcept {
  constexpr double kReference = 43.0;  // [C]
  const double above = std::min(celsius, kHottestOfDose) - kReference;
  const double halvings = above > 0.0 ? above : 2.0 * above;  // 0.25 = 0.5^2
  return seconds / 60.0 * portable_exp(halvings * std::numbers::ln2);
}

}  // namespace burrhole
