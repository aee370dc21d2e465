#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "app/lab/multirate.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

std::vector<CostRow> rows_of(std::vector<int> contact_ticks) {
  MultirateOptions options;
  options.contact_ticks = std::move(contact_ticks);
  options.limits = false;
  const auto rows = measure_multirate(options);
  REQUIRE_MESSAGE(rows.ok(), (rows ? "" : rows.error().text()));
  return *rows;
}

double figure(const std::vector<CostRow>& rows, const std::string& model, double rate, const std::string& name) {
  const auto found = std::ranges::find_if(rows, [&](const CostRow& row) {
    return row.subject == "sliding over a sphere" && row.model == model && row.setting == rate && row.error_name == name;
  });
  REQUIRE(found != rows.end());
  return found->error;
}

}  // namespace

TEST_CASE("multirate cost: a force is off by what the hand does in the time that it lacks") {
  const std::vector<CostRow> rows = rows_of({1, 10});
  CHECK(rows.size() == 2 * 4 * 2 * 2);
  // At 100 Hz a held force is of a hand 10 to 19 ticks ago, 1 to 10 more than the planes of the same look answer.
  // At an rms of 13 mm/s it moves 0.19 mm in 14.5 ticks, which turns the normal of a sphere of several millimetres by a few percent.
  const double held = figure(rows, "hold", 100.0, "force_rms_off");
  CHECK(held > 1.0);
  // At 1 kHz it is of a hand one tick ago, a fourteenth of that; where another point of the shell takes over the step is as high, only
  // shorter.
  CHECK(figure(rows, "hold", 1000.0, "force_rms_off") > 0.0);
  CHECK(figure(rows, "hold", 1000.0, "force_rms_off") < held / 4.0);
  // A hand that follows a sphere keeps its force and turns it, which a plane, flat, does not foresee either; extrapolation overshoots.
  CHECK(figure(rows, "linear", 100.0, "force_rms_off") > held);
  CHECK(figure(rows, "planes", 100.0, "force_rms_off") < figure(rows, "linear", 100.0, "force_rms_off"));
  CHECK(figure(rows, "hold", 100.0, "force_worst_off") > held);
}

TEST_CASE("multirate: with a store the errors are those without, and again from the store with its times") {
  const TemporaryFolder folder;
  MultirateOptions options;
  options.contact_ticks = {1, 10};
  options.limits = false;
  std::vector<std::vector<CostRow>> rows;
  for (int n = 0; n < 3; ++n) {
    Study study({.partial = folder.file("partial.txt")}, count_of_trials(options));
    options.study = n > 0 ? &study : nullptr;
    const auto measured = measure_multirate(options);
    REQUIRE(measured.ok());
    if (n > 0) CHECK(study.done() == count_of_trials(options));
    rows.push_back(*measured);
  }
  for (const std::size_t n : {std::size_t{1}, std::size_t{2}}) {
    REQUIRE(rows[n].size() == rows[0].size());
    for (std::size_t row = 0; row < rows[n].size(); ++row) {
      CHECK(rows[n][row].error == rows[0][row].error);
      if (n == 2) CHECK(rows[2][row].median_us == rows[1][row].median_us);
    }
  }
}

TEST_CASE("multirate cost: a list of rates that does not begin with the servo's own is refused") {
  MultirateOptions options;
  options.contact_ticks = {10, 1};
  CHECK(!measure_multirate(options));
}
