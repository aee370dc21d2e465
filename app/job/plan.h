/// app/job/plan.h: lists the steps that a scene will run with their order, rate and memory, and the effects that it does not have.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/scene/load.h"
#include "app/scene/memory_plan.h"

namespace burrhole {

struct Plan {
  std::vector<PlanRow> rows;           ///< volume and hand, then the effects in the order of the registry
  std::vector<std::string> not_built;  ///< effects without a table in the scene, and those of later versions
  std::vector<std::string> warnings;
  MemoryPlan memory;  ///< of the whole process
};

/// Needs no display and no device. @param registry the known effects.
[[nodiscard]] Plan make_plan(const LoadedScene& loaded, const EffectRegistry& registry = shipped_effects());

}  // namespace burrhole
