/// app/run/effect_events.h: events of effects: the changes of their columns that are states (ColumnStates).
///   Errors  those of RunLog.   Thread  that of the log.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "app/run/live_user.h"
#include "app/run/run_log.h"
#include "app/stage/step_graph.h"

namespace burrhole {

class EffectEvents {
 public:
  /// Finds the columns; a graph without any costs nothing afterwards. Columns keep their places when a tool is changed.
  explicit EffectEvents(const StepGraph& graph);
  /// Call with the values of each contact evaluation, in order. @param time [s] of it.
  [[nodiscard]] Status look(std::span<const double> values, double time, RunLog& log) {
    return watched_.empty() ? Status() : record(values, time, log);
  }
  /// The same with the graph's present values, in lockstep.
  [[nodiscard]] Status look(const StepGraph& graph, double time, RunLog& log);

 private:
  struct Watched {
    ColumnStates states;
    std::size_t column;
    std::size_t value = 0;
  };
  [[nodiscard]] Status record(std::span<const double> values, double time, RunLog& log);
  std::vector<Watched> watched_;
};

/// Finds the values of [zones] among those of a contact evaluation.
class ZoneColumns {
 public:
  explicit ZoneColumns(const StepGraph& graph);
  [[nodiscard]] std::optional<ZoneReading> read(std::span<const double> values) const noexcept;

 private:
  std::optional<std::size_t> distance_, level_;
};

}  // namespace burrhole
