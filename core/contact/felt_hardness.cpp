#include "core/contact/felt_hardness.h"

#include <algorithm>

namespace burrhole {

void FeltHardness::update(const Load& load, double dt) noexcept {
  if (load.hardness < 0.0) {
    if (load.force <= kUnloaded) factor_ = 1.0;
    return;
  }
  const double wanted = 1.0 - share_ * (1.0 - std::clamp(load.hardness, 0.0, 1.0));
  const double change = (wanted - factor_) * std::min(1.0, dt / kTime);
  const double stretch = load.force / (factor_ * load.stiffness);
  if (load.force <= kUnloaded)
    factor_ = wanted;
  else if (change <= 0.0)
    factor_ += change;
  else
    factor_ += std::min(change, 2.0 * load.force * std::max(load.advance, 0.0) / (stretch * stretch * load.stiffness));
}

}  // namespace burrhole
