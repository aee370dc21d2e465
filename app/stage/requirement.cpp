#include "app/stage/requirement.h"

#include <fmt/format.h>

#include <algorithm>

namespace burrhole {

std::string UnmetRequirement::text() const {
  const std::string& keys = requirement.keys;
  return fmt::format("[{}]{} has no effect without [{}]: {}; add [{}], or {}", table, keys.empty() ? "" : " " + keys, requirement.table,
                     requirement.without, requirement.table, keys.empty() ? fmt::format("remove [{}]", table) : "change that key");
}

std::vector<UnmetRequirement> unmet_requirements(const EffectPlans& effects, const StageConfig& config) {
  const Needs needs = effects.needs(config);
  std::vector<UnmetRequirement> out;
  for (const EffectPlans::Item& item : effects.items()) {
    const auto* plan = dynamic_cast<const RequiringPlan*>(item.plan.get());
    if (plan == nullptr) continue;
    const std::vector<Requirement> all = plan->requirements(needs);
    if (const auto unmet = std::ranges::find(all, false, &Requirement::met); unmet != all.end()) out.push_back({item.table, *unmet});
  }
  return out;
}

std::vector<std::string> tables_that_require(std::string_view table, EffectPlans effects, const StageConfig& config) {
  std::vector<std::string> out;
  effects.remove(table);
  for (std::vector<UnmetRequirement> unmet = unmet_requirements(effects, config); !unmet.empty();
       unmet = unmet_requirements(effects, config))
    for (const UnmetRequirement& one : unmet) {
      effects.remove(one.table);
      out.push_back(one.table);
    }
  return out;
}

}  // namespace burrhole
