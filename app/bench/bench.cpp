#include "app/bench/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace burrhole {
namespace {

std::string number(std::optional<double> value) { return value ? fmt::format("{:.4g}", *value) : "-"; }

nlohmann::ordered_json json_of(std::optional<double> value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

bool Bench::agree(const std::string& name, std::span<const std::byte> baseline, std::span<const std::byte> value) {
  std::vector<std::byte> compared(value.begin(), value.end());
  if (sabotage_ && !compared.empty()) compared[compared.size() / 2] ^= std::byte{1};
  const bool same = !baseline.empty() && std::ranges::equal(baseline, compared);
  if (same) return true;
  const auto first = std::ranges::mismatch(baseline, compared).in1 - baseline.begin();
  return require(name, false,
                 fmt::format("the results differ, first at byte {} of {} (baseline) and {}", first, baseline.size(), value.size()));
}

bool Bench::require(const std::string& name, bool holds, const std::string& otherwise) {
  if (!holds) disagreements_.push_back(area_ + ": " + name + ": " + otherwise);
  return holds;
}

Medians Bench::time(const Side& baseline, const Side& value) const {
  return time_paired(quick_ ? StopwatchPlan{.pairs_least = 2, .budget = 0.0, .least_sample = 0.0} : StopwatchPlan{}, baseline, value);
}

void Bench::add_speed_up(const std::string& name, const std::string& unit, double per_unit, const Medians& medians, const Bars& bars) {
  rows_.push_back(
      {area_, name, unit, medians.value * per_unit, medians.baseline * per_unit, medians.baseline / medians.value, bars, false});
}

void Bench::add_cost(const std::string& name, const std::string& unit, double per_unit, const Medians& medians, const Bars& bars) {
  rows_.push_back({area_, name, unit, medians.value * per_unit, medians.baseline * per_unit, medians.value / medians.baseline, bars, true});
}

void Bench::add_absolute(const std::string& name, const std::string& unit, double value, bool lower_is_better, const Bars& bars) {
  rows_.push_back({area_, name, unit, value, 1.0, value, bars, lower_is_better});
}

std::string bench_json(const BenchMachine& machine, bool quick, std::span<const BenchRow> rows) {
  nlohmann::ordered_json out;
  out["machine"] = {{"cpu", machine.cpu},           {"cores", machine.cores},           {"simd", machine.simd},
                    {"compiler", machine.compiler}, {"build_type", machine.build_type}, {"revision", machine.revision},
                    {"date", machine.date}};
  out["quick"] = quick;
  auto& list = out["rows"] = nlohmann::ordered_json::array();
  for (const BenchRow& row : rows)
    list.push_back({{"area", row.area},
                    {"name", row.name},
                    {"value", row.value},
                    {"unit", row.unit},
                    {"baseline", row.baseline},
                    {"ratio", row.ratio},
                    {"ship", json_of(row.bars.ship)},
                    {"aim", json_of(row.bars.aim)},
                    {"lower_is_better", row.lower_is_better}});
  return out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";  // bytes of a caller's text that are not UTF-8
}

std::string bench_table(std::span<const BenchRow> rows) {
  constexpr std::size_t kColumns = 8;
  std::vector<std::array<std::string, kColumns>> cells{{"area", "name", "value", "baseline", "unit", "ratio", "ship", "aim"}};
  for (const BenchRow& row : rows)
    cells.push_back({row.area, row.name, number(row.value), number(row.baseline), row.unit,
                     number(row.ratio) + (row.lower_is_better ? " v" : "  "), number(row.bars.ship), number(row.bars.aim)});
  std::array<std::size_t, kColumns> width{};
  for (const auto& line : cells)
    for (std::size_t c = 0; c < kColumns; ++c) width[c] = std::max(width[c], line[c].size());
  std::string out;
  for (const auto& line : cells) {
    std::string text;
    for (std::size_t c = 0; c < kColumns; ++c) {
      const bool words = c == 0 || c == 1 || c == 4;
      text += words ? fmt::format("{:<{}}  ", line[c], width[c]) : fmt::format("{:>{}}  ", line[c], width[c]);
    }
    out += text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  }
  return out + "v: lower is better; ship and aim are in the unit of ratio\n";
}

}  // namespace burrhole
