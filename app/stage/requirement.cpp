#include "app/stage/requirement.h"

#include <fmt/format.h>

#include <algorithm>

namespace burrhole {

std::string UnmetRequirement::text() const {
  const std::string& keys = requirement.keys;
  const bool is_key = keys.find('=') != std::string::npos;  // otherwise a table below the table
  const std::string instead = is_key ? "change that key" : fmt::format("remove [{}{}{}]", table, keys.empty() ? "" : ".", keys);
  return fmt::format("[{}]{} has no effect without [{}]: {}; add [{}], or {}", table, keys.empty() ? "" : " " + keys, requirement.table,
                     requirement.without, requirement.table, instead);
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
