/// app/engine/plan.h: what a scene will run, in which order, at which rate, with how many bytes; and what it leaves out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/engine/load.h"

namespace burrhole {

/// The steps of a run, in their order within a tick.
enum class Clock { servo, contact, simulation, frame };

/// An effect as data: the table that calls for it and what it brings along.
struct EffectInfo {
  std::string table;  ///< "hand" and "volume" are always there; the others exist if and only if their table is there
  Clock clock;
  std::string step;          ///< what runs, in one line
  std::string needs, gives;  ///< grids and mailboxes
  bool optional = true;
};

/// All effects this version can simulate, in the order of their steps.
[[nodiscard]] const std::vector<EffectInfo>& known_effects();

struct PlanRow {
  EffectInfo effect;
  double rate_hz = 0.0;     ///< 0: at events
  std::uint64_t bytes = 0;  ///< of grids, windows and points that exist because of this row (estimated before the run)
  std::string detail;
};

struct Plan {
  std::vector<PlanRow> rows;
  std::vector<std::string> not_built;  ///< optional effects whose table is absent, and those of later versions
  std::vector<std::string> warnings;
};

/// Needs no display and no device.
[[nodiscard]] Plan make_plan(const LoadedScene& loaded);

[[nodiscard]] const char* name_of(Clock clock);

}  // namespace burrhole
