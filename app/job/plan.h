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
  std::vector<std::string> not_built;  ///< effects without a table in the scene
  std::vector<std::string> warnings;
  std::size_t scene_warnings = 0;  ///< number of warnings of the scene itself; those after them are of tools that inputs change to
  MemoryPlan memory;               ///< of the whole process
};

/// Needs no display and no device. @param registry the known effects. @param run what the run needs beyond lockstep without inputs.
[[nodiscard]] Plan make_plan(const LoadedScene& loaded, const EffectRegistry& registry = shipped_effects(), const MemoryRun& run = {});

/// The tools that inputs of a run change to.
struct InputTools {
  bool inputs = false;          ///< the run has inputs, of whatever kind
  std::vector<ToolText> texts;  ///< of its tool changes
};
/// make_plan() for a run with inputs, live or in lockstep: memory, and warnings of every tool. Pushes the issues of tools that cannot be
/// made.
[[nodiscard]] Plan make_run_plan(const LoadedScene& loaded, bool live, const InputTools& tools, Issues& issues);

}  // namespace burrhole
