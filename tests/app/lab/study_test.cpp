#include "app/lab/study.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "app/lab/surface_accuracy.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

constexpr std::size_t kTrials = 6;

StudyTrial trial_of(std::size_t n) {
  StudyTrial out{.key = {}, .name = "trial " + std::to_string(n), .figures = 2};
  out.key.add(static_cast<double>(n));
  return out;
}

/// Results of a study of which each trial takes `seconds`.
struct Fake {
  double clock = 0.0, seconds = 0.5;  // [s]
  std::size_t measured = 0;
  std::vector<std::string> said{};
  std::vector<double> shares{};

  StudyRuns runs(const std::string& partial) {
    return {.partial = partial,
            .progress = [this](double share, const std::string&) { shares.push_back(share); },
            .say = [this](const std::string& line) { said.push_back(line); },
            .now = [this] { return clock; }};
  }
  /// Runs the first `count` trials. @returns all figures.
  std::vector<double> run(const std::string& partial, std::size_t count) {
    Study study(runs(partial), kTrials);
    std::vector<double> out;
    for (std::size_t n = 0; n < count; ++n) {
      const auto figures = study.run(trial_of(n), [&]() -> Result<Study::Figures> {
        clock += seconds;
        ++measured;
        return Study::Figures{1.0 / (3.0 + static_cast<double>(n)), static_cast<double>(n)};
      });
      REQUIRE(figures.ok());
      out.insert(out.end(), figures->begin(), figures->end());
    }
    CHECK(study.done() == count);
    return out;
  }
};

}  // namespace

TEST_CASE("study: one that was interrupted after any trial goes on and has the same figures") {
  Fake whole;
  const std::vector<double> figures = whole.run("", kTrials);
  CHECK(whole.measured == kTrials);
  for (std::size_t count = 0; count <= kTrials; ++count) {
    const TemporaryFolder folder;
    Fake first, second;
    first.run(folder.file("partial.txt"), count);
    CHECK(second.run(folder.file("partial.txt"), kTrials) == figures);
    CHECK(second.measured == kTrials - count);
    if (second.measured > 0) CHECK(second.shares.back() == 1.0);
    if (count == 3) CHECK(second.shares.front() == doctest::Approx(1.0 / 3.0));  // of what is left
  }
}

TEST_CASE("study: the estimate is the measured time of the first trial times what is left, said once") {
  Fake fake;
  fake.seconds = 100.0;
  fake.run("", kTrials);
  REQUIRE(fake.said.size() == 1);
  CHECK(fake.said[0] == "5 of 6 trials left: about 8 min, if all take as long as the first (100 s)");
  Fake twice;
  twice.seconds = 200.0;
  twice.run("", kTrials);
  CHECK(twice.said[0].find("about 17 min") != std::string::npos);
  Fake quick;
  quick.run("", kTrials);
  REQUIRE(quick.said.size() == 1);
  CHECK(quick.said[0] == "5 of 6 trials left: under a minute, if all take as long as the first (0.5 s)");
}

TEST_CASE("study: the estimate of one that goes on is that of the rest") {
  const TemporaryFolder folder;
  Fake first, second;
  first.run(folder.file("partial.txt"), 2);
  second.seconds = 100.0;
  second.run(folder.file("partial.txt"), kTrials);
  REQUIRE(second.said.size() == 1);
  CHECK(second.said[0] ==
        "3 of 6 trials left: about 5 min, if all take as long as the first (100 s); 2 were measured by an earlier call (--fresh "
        "measures all again)");
}

TEST_CASE("study: the error of a trial is returned, and nothing of it is kept") {
  const TemporaryFolder folder;
  Study study({.partial = folder.file("partial.txt")}, 1);
  CHECK(!study.run(trial_of(0), []() -> Result<Study::Figures> { return bad_input("no"); }));
  Fake again;
  again.run(folder.file("partial.txt"), 1);
  CHECK(again.measured == 1);
}

TEST_CASE("study: a real one that is run again from its results has the same rows, times included") {
  const TemporaryFolder folder;
  SurfaceAccuracyOptions options{.pitches = {0.5e-3}, .points = 100, .repeats = 2};
  std::vector<CostRow> rows[2];
  for (std::vector<CostRow>& each : rows) {
    Study study({.partial = folder.file("partial.txt")}, count_of_trials(options));
    options.study = &study;
    const auto measured = measure_surface_accuracy(options);
    REQUIRE(measured.ok());
    CHECK(study.done() == count_of_trials(options));
    each = *measured;
  }
  REQUIRE(rows[0].size() == rows[1].size());
  for (std::size_t n = 0; n < rows[0].size(); ++n) {
    CHECK(rows[0][n].error == rows[1][n].error);
    CHECK(rows[0][n].median_us == rows[1][n].median_us);  // a measurement would differ
    CHECK(rows[0][n].p99_us == rows[1][n].p99_us);
  }
}

TEST_CASE("study: durations") {
  CHECK(duration_text(3.0) == "under a minute");
  CHECK(duration_text(61.0) == "about 1 min");
  CHECK(duration_text(59.6 * 60.0) == "about 1 h 0 min");
  CHECK(duration_text(80.0 * 60.0) == "about 1 h 20 min");
}
