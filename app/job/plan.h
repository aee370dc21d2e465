/// app/job/plan.h: what a scene will run, in which order, at which rate, with how many bytes; and what it leaves out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/scene/load.h"

namespace burrhole {

struct Plan {
  std::vector<PlanRow> rows;           ///< volume and hand, then the effects in the order of the registry
  std::vector<std::string> not_built;  ///< effects whose table is absent, and those of later versions
  std::vector<std::string> warnings;
};

/// Needs no display and no device. @param registry the effects that are known.
[[nodiscard]] Plan make_plan(const LoadedScene& loaded, const EffectRegistry& registry = shipped_effects());

}  // namespace burrhole
