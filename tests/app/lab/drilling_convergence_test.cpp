// A hole does not depend on voxel edge and erosion rate: the short form of `burrhole cost drilling --convergence`. Bounds: 3 % of volume and
// mass, 5 % of time, 0.1 mm + 0.25 voxel of plunge.

#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "app/lab/drilling_convergence.h"
#include "tests/support/source_folder.h"

using namespace burrhole;

namespace {

ConvergenceOptions quick(std::vector<std::string> sabotage = {}) {
  ConvergenceOptions out;
  out.runs.tool_folder = test::in_source("app/tools");
  out.quick = true;
  out.sabotage = std::move(sabotage);
  return out;
}

std::vector<StabilityRow> rows_of(const ConvergenceOptions& options) {
  const auto rows = measure_convergence(options);
  REQUIRE_MESSAGE(rows.ok(), (rows ? "" : rows.error().text()));
  return *rows;
}

std::vector<DrillingSetting> settings_of(const ConvergenceOptions& options) {
  const auto settings = convergence_settings(options);
  REQUIRE(settings.ok());
  return *settings;
}

/// A flat bit leaves bone as a whole: its plunge, 50 mm here, is the free advance of the drill until the hand releases it, and follows the
/// moment of the last contact, which is known to a step of erosion only: 20 ms at 50 Hz, at 0.1 m/s. The bound is for bits that bone stops.
/// At 20 Hz the moment is known to 50 ms, so that nothing is asked of the plunge.
bool free_advance(const StabilityRow& row) {
  return row.measure == "plunge_off_mm" && (row.subject.ends_with("20 Hz") || row.value < 20e-3 * 0.1e3);
}

/// Measures that failed.
std::set<std::string> failures(const std::vector<StabilityRow>& rows) {
  std::set<std::string> out;
  for (const StabilityRow& row : rows) {
    MESSAGE(row.subject << ": " << row.measure << " " << row.value << ", bound " << row.bound);
    if (!row.pass) out.insert(row.measure);
  }
  return out;
}

}  // namespace

TEST_CASE("convergence: holes at the defaults, with coarser voxels and with a slower erosion are within their bounds") {
  const std::vector<StabilityRow> rows = rows_of(quick());
  CHECK(rows.size() == 5 * settings_of(quick()).size());
  std::vector<StabilityRow> judged;
  std::ranges::remove_copy_if(rows, std::back_inserter(judged), free_advance);
  CHECK(failures(judged).empty());
}

// The law of the paper removes a share per update: the finest run is five times as fast as one at the default rate, or the bit stops.
TEST_CASE("convergence, sabotage: a law that depends on the rate of updates fails the bound of time") {
  CHECK(failures(rows_of(quick({"erosion.law=per-update"}))).contains("time_off_percent"));
}

// Bone that is cleared by whole voxels: a hole is wider by up to a voxel.
TEST_CASE("convergence, sabotage: removal by whole voxels fails a bound") {
  CHECK(!failures(rows_of(quick({"erosion.subvoxel=false"}))).empty());
}

TEST_CASE("convergence: the study varies one factor at a time and has seeded corners, none of which is the reference itself") {
  ConvergenceOptions options = quick();
  options.quick = false;
  const std::vector<DrillingSetting> settings = settings_of(options);
  // The defaults; five more bits, two bones, a law, three voxel edges and four rates, which are not the defaults.
  CHECK(settings.size() == 1 + 5 + 2 + 1 + 3 + 4 + 12);
  CHECK(settings == settings_of(options));
  for (const DrillingSetting& setting : settings) CHECK(!(setting.spacing_mm == 0.15 && setting.erosion_hz == 500));
  options.seed = 2;
  CHECK(!(settings == settings_of(options)));
}
