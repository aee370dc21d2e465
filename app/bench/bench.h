/// app/bench/bench.h: what the areas share: rows with a baseline of the same run, and results compared before a time counts.
///   Units  seconds inside; each row says its own.   Thread one.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/bench/machine.h"
#include "app/bench/stopwatch.h"
#include "core/base/result.h"

namespace burrhole {

/// What is asked of a ratio now and in the end; nothing where no bar is set.
struct Bars {
  std::optional<double> ship, aim;
};

/// One row of bench.json. `ratio` is baseline/value for a speed-up, value/baseline where less is better.
struct BenchRow {
  std::string area, name, unit;
  double value = 0.0, baseline = 1.0, ratio = 0.0;
  Bars bars;
  bool lower_is_better = false;
};

/// Bytes of a run of plain values without padding.
template <class Range>
[[nodiscard]] std::span<const std::byte> bytes_of(const Range& values) {
  return std::as_bytes(std::span(values));
}

class Bench {
 public:
  /// `quick`: few iterations, for the test of the program. `sabotage`: flips one bit of every result before it is compared.
  Bench(bool quick, bool sabotage) : quick_(quick), sabotage_(sabotage) {}

  void start_area(std::string area) { area_ = std::move(area); }
  [[nodiscard]] bool quick() const noexcept { return quick_; }

  /// @returns whether both hold the same bytes, and something at all; otherwise the row `name` is noted as disagreeing.
  bool agree(const std::string& name, std::span<const std::byte> baseline, std::span<const std::byte> value);
  /// Notes a disagreement when `holds` is false: what a comparison of results rests on, such as that bone was touched at all.
  bool require(const std::string& name, bool holds, const std::string& otherwise);

  /// Medians of runs by turns [s of CPU time].
  [[nodiscard]] Medians time(const Side& baseline, const Side& value) const;

  /// `per_unit` turns seconds of a run into the row's unit.
  void add_speed_up(const std::string& name, const std::string& unit, double per_unit, const Medians& medians, const Bars& bars = {});
  void add_cost(const std::string& name, const std::string& unit, double per_unit, const Medians& medians, const Bars& bars = {});
  void add_absolute(const std::string& name, const std::string& unit, double value, bool lower_is_better, const Bars& bars = {});

  [[nodiscard]] const std::vector<BenchRow>& rows() const noexcept { return rows_; }
  /// One line each, "area: row: why".
  [[nodiscard]] const std::vector<std::string>& disagreements() const noexcept { return disagreements_; }

 private:
  bool quick_, sabotage_;
  std::string area_;
  std::vector<BenchRow> rows_;
  std::vector<std::string> disagreements_;
};

/// bench.json, an object: `machine` (the members of BenchMachine), `quick`, and `rows`, an array of objects: area, name, value, unit, baseline,
/// ratio, ship, aim (null where no bar is set), lower_is_better.
[[nodiscard]] std::string bench_json(const BenchMachine& machine, bool quick, std::span<const BenchRow> rows);
[[nodiscard]] std::string bench_table(std::span<const BenchRow> rows);

}  // namespace burrhole
