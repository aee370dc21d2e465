#include "app/effect/passive_keys.h"

#include "core/config/rules.h"

namespace burrhole {

void read_passive_limit(TableReader& table, const std::string& what, PassiveForceConfig& out) {
  constexpr double kMillijoule = 1e-3;
  out.allowance = table.number("allowance_mJ", above_zero(out.allowance / kMillijoule, kMillijoule, 1e3),
                               "energy that " + what + " may give to the hand at most, over any motion (an assumption)");
  out.acceleration = table.number("acceleration_m_per_s2", above_zero(out.acceleration, 1.0, 1e5),
                                  "largest acceleration of the hand for which that holds (an assumption)");
}

}  // namespace burrhole
