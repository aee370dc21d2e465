#include "app/run/effect_events.h"

#include <algorithm>

#include "app/run/live_rows.h"
#include "app/stage/zone_state.h"

namespace burrhole {
namespace {

/// @returns the place of a column of the contact clock; nothing if there is none.
std::optional<std::size_t> contact_column(const StepGraph& graph, std::string_view name) {
  const std::vector<StepColumn>& columns = graph.columns(Clock::contact);
  const auto found = std::ranges::find(columns, name, &StepColumn::name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace

ZoneColumns::ZoneColumns(const StepGraph& graph)
    : distance_(contact_column(graph, kZoneDistanceColumn)), level_(contact_column(graph, kZoneLevelColumn)) {}

std::optional<ZoneReading> ZoneColumns::read(std::span<const double> values) const noexcept {
  if (!distance_ || !level_ || std::max(*distance_, *level_) >= values.size()) return std::nullopt;
  return ZoneReading{values[*distance_], values[*level_]};
}

EffectEvents::EffectEvents(const StepGraph& graph) {
  const std::vector<StepColumn>& columns = graph.columns(Clock::contact);
  for (std::size_t n = 0; n < columns.size(); ++n)
    if (columns[n].states.kind != nullptr) watched_.push_back({columns[n].states, n});
}

Status EffectEvents::look(const StepGraph& graph, double time, RunLog& log) {
  if (watched_.empty()) return {};
  const EffectValues now = effect_values(graph, Clock::contact);
  return record(std::span(now.values).first(now.count), time, log);
}

Status EffectEvents::record(std::span<const double> values, double time, RunLog& log) {
  for (Watched& one : watched_) {
    if (one.column >= values.size()) continue;
    const double raw = values[one.column];
    const std::size_t value = raw > 0.0 ? std::min(static_cast<std::size_t>(raw), one.states.texts.size() - 1) : 0;
    if (value == one.value) continue;
    one.value = value;
    if (Status noted = log.record_event(time, one.states.kind, one.states.texts[value]); !noted) return noted;
  }
  return {};
}

}  // namespace burrhole
