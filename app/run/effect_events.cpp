#include "app/run/effect_events.h"

#include <algorithm>
#include <array>

#include "app/run/live_rows.h"
#include "app/stage/bleeding_state.h"
#include "app/stage/dura_state.h"
#include "app/stage/zone_state.h"

namespace burrhole {
namespace {

constexpr std::array<const char*, 3> kZoneTexts{"clear", "near", "inside"}, kDuraTexts{"clear", "pressed", "torn"},
    kBleedingTexts{"stopped", "started", "stopped by wax"};
constexpr std::array<const char*, 2> kFloorTexts{"seen", "hidden by blood"};

struct Known {
  const char *column, *kind;
  std::span<const char* const> texts;
};
constexpr Known kKnown[] = {{kZoneLevelColumn, "zone", kZoneTexts},
                            {kDuraLevelColumn, "dura", kDuraTexts},
                            {kBleedingColumn, "bleeding", kBleedingTexts},
                            {kFloorHiddenColumn, "floor", kFloorTexts}};

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
  for (const Known& known : kKnown)
    if (const auto column = contact_column(graph, known.column)) watched_.push_back({known.kind, known.texts, *column});
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
    const std::size_t value = raw > 0.0 ? std::min(static_cast<std::size_t>(raw), one.texts.size() - 1) : 0;
    if (value == one.value) continue;
    one.value = value;
    if (Status noted = log.record_event(time, one.kind, one.texts[value]); !noted) return noted;
  }
  return {};
}

}  // namespace burrhole
