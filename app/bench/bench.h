/// app/bench/bench.h: collects the rows of all areas. A row compares a value with a baseline timed in the same run; both must compute equal
/// results before their times are recorded.
///   Units  seconds inside; each row has its own unit.   Thread one.
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

/// Targets of a row's ratio; nothing where none is set.
struct Bars {
  std::optional<double> ship;  ///< [-] required now
  std::optional<double> aim;   ///< [-] intended in the long run
};

/// One row of bench.json.
struct BenchRow {
  std::string area, name, unit;
  double value = 0.0, baseline = 1.0;  ///< [unit of the row]
  double ratio = 0.0;                  ///< [-] baseline/value for a speed-up, value/baseline where lower is better
  Bars bars;
  bool lower_is_better = false;
};

/// @returns the bytes of a contiguous range of values without padding.
template <class Range>
[[nodiscard]] std::span<const std::byte> bytes_of(const Range& values) {
  return std::as_bytes(std::span(values));
}

class Bench {
 public:
  /// @param quick few iterations, for the test of the program. @param sabotage flips one bit of every result before it is compared.
  /// @param folder of bench.json, and of the pictures of the areas.
  Bench(bool quick, bool sabotage, std::string folder) : quick_(quick), sabotage_(sabotage), folder_(std::move(folder)) {}

  void start_area(std::string area) { area_ = std::move(area); }
  [[nodiscard]] bool quick() const noexcept { return quick_; }
  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }

  /// @returns whether both are equal and not empty; otherwise records a disagreement of row `name`.
  bool agree(const std::string& name, std::span<const std::byte> baseline, std::span<const std::byte> value);
  /// Records a disagreement of row `name` if `holds` is false. For preconditions of a comparison, such as that the tool touches bone.
  /// @returns `holds`. @param otherwise the reason.
  bool require(const std::string& name, bool holds, const std::string& otherwise);

  /// @returns medians of paired runs [s of CPU time].
  [[nodiscard]] Medians time(const Side& baseline, const Side& value) const;

  /// Adds a row. @param per_unit converts the seconds of a run into the row's unit.
  void add_speed_up(const std::string& name, const std::string& unit, double per_unit, const Medians& medians, const Bars& bars = {});
  void add_cost(const std::string& name, const std::string& unit, double per_unit, const Medians& medians, const Bars& bars = {});
  void add_absolute(const std::string& name, const std::string& unit, double value, bool lower_is_better, const Bars& bars = {});

  [[nodiscard]] const std::vector<BenchRow>& rows() const noexcept { return rows_; }
  /// @returns one line each, "area: row: reason".
  [[nodiscard]] const std::vector<std::string>& disagreements() const noexcept { return disagreements_; }

 private:
  bool quick_, sabotage_;
  std::string folder_, area_;
  std::vector<BenchRow> rows_;
  std::vector<std::string> disagreements_;
};

/// bench.json, an object: `machine` (the members of BenchMachine), `quick`, and `rows`, an array of objects: area, name, value, unit, baseline,
/// ratio, ship, aim (null where no bar is set), lower_is_better.
[[nodiscard]] std::string bench_json(const BenchMachine& machine, bool quick, std::span<const BenchRow> rows);
[[nodiscard]] std::string bench_table(std::span<const BenchRow> rows);

}  // namespace burrhole
