#include "app/lab/partial_results.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>

#include "app/lab/drilling_partial.h"
#include "app/report/file.h"
#include "tests/support/file_limit.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

/// Equal to the bit; NaN equals NaN.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

struct Kept {
  std::string key;
  std::vector<double> figures;
};

/// Three results with figures whose hexadecimal forms are long, short and negative in the exponent.
std::vector<Kept> some_results() {
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<Kept> out;
  out.push_back({TrialKey().add("first").text(), {1.0 / 3.0, 1e-300, none}});
  out.push_back({TrialKey().add("second").text(), {12345.678, -0.0, 0x1.8p+10}});
  out.push_back({TrialKey().add("third").text(), {0x1.8p+1, 1e300, 7.0}});
  return out;
}

void write(const std::string& path, const std::vector<Kept>& results) {
  PartialResults partial(path);
  for (const Kept& one : results) REQUIRE(partial.add(one.key, one.figures).ok());
}

/// A result as a run has it, with figures that are all different.
DrillingResult some_drilling(double from) {
  DrillingResult r;
  double* const figures[] = {&r.volume_mm3,   &r.drilled_s, &r.plunge_mm, &r.feed_mm_s, &r.ripple_percent,
                             &r.roughness_um, &r.cpu_s,     &r.wall_s,    &r.median_us, &r.p99_us};
  for (double* figure : figures) *figure = from += 0.1;
  r.summary.removed_mm3 = from + 0.1;
  r.summary.removed_mass_mm3 = from + 0.2;
  r.summary.spacing_mm = from + 0.3;
  r.summary.depth_mm = from + 0.4;
  r.summary.inner_diameter_mm = from + 0.5;  // and no outer diameter
  r.summary.predicted_bytes = (1ull << 52) + 1;
  return r;
}

}  // namespace

TEST_CASE("partial results: figures come back as the same bits, by key and count") {
  const TemporaryFolder folder;
  const std::string path = folder.file("partial.txt");
  write(path, some_results());
  const PartialResults again(path);
  for (const Kept& one : some_results()) {
    const auto found = again.find(one.key, one.figures.size());
    REQUIRE(found.has_value());
    CHECK(same(*found, one.figures));
    CHECK(!again.find(one.key, one.figures.size() - 1));
    CHECK(!again.find(one.key, one.figures.size() + 1));
  }
  CHECK(!again.find(TrialKey().add("fourth").text(), 3));
}

TEST_CASE("partial results: a file that was cut off at any byte has no wrong figure, and goes on") {
  const TemporaryFolder folder;
  const std::string path = folder.file("partial.txt");
  write(path, some_results());
  const auto whole = read_file(path);
  REQUIRE(whole.ok());
  for (std::size_t bytes = 0; bytes <= whole->size(); ++bytes) {
    CAPTURE(bytes);
    REQUIRE(write_file(path, whole->substr(0, bytes)).ok());
    std::size_t found = 0;
    {
      PartialResults partial(path);
      for (const Kept& one : some_results()) {
        const auto figures = partial.find(one.key, one.figures.size());
        if (figures) CHECK(same(*figures, one.figures));
        found += figures ? 1 : 0;
        if (!figures) REQUIRE(partial.add(one.key, one.figures).ok());
      }
    }
    const auto lines = static_cast<std::size_t>(std::count(whole->begin(), whole->begin() + static_cast<std::ptrdiff_t>(bytes), '\n'));
    CHECK(found >= lines);      // a line is lost only by a cut within it
    CHECK(found <= lines + 1);  // without its line break a line is whole
    const PartialResults again(path);
    for (const Kept& one : some_results()) {
      const auto figures = again.find(one.key, one.figures.size());
      REQUIRE(figures.has_value());
      CHECK(same(*figures, one.figures));
    }
  }
}

TEST_CASE("partial results: a changed byte is no wrong figure") {
  const TemporaryFolder folder;
  const std::string path = folder.file("partial.txt");
  write(path, some_results());
  const auto whole = read_file(path);
  REQUIRE(whole.ok());
  for (std::size_t at = 0; at < whole->size(); ++at)
    for (const char other : {'0', ' ', '\n', 'x'}) {
      std::string changed = *whole;
      changed[at] = other;
      REQUIRE(write_file(path, changed).ok());
      const PartialResults partial(path);
      for (const Kept& one : some_results())
        if (const auto figures = partial.find(one.key, one.figures.size())) CHECK(same(*figures, one.figures));
    }
}

TEST_CASE("partial results: words beyond the figures, or that are no numbers, are not read") {
  const TemporaryFolder folder;
  const std::string path = folder.file("partial.txt"), key = TrialKey().add("one").text();
  for (const char* line : {"", "\n", " ", "0123456789abcdef", "0123456789abcdef 0x1p+0", "0123456789abcdef 1 2 3 4\n"}) {
    REQUIRE(write_file(path, line).ok());
    CHECK(!PartialResults(path).find("0123456789abcdef", 1));
    CHECK(!PartialResults(path).find("0123456789abcdef", 4));
  }
  std::filesystem::remove(path);
  CHECK(!PartialResults(path).find(key, 1));
  PartialResults nothing("");
  CHECK(nothing.add(key, std::vector{1.0}).ok());
}

TEST_CASE("partial results: what cannot be written is an error that names the file") {
  const TemporaryFolder folder;
  PartialResults partial(folder.file("missing/partial.txt"));
  const Status added = partial.add(TrialKey().text(), std::vector{1.0});
  REQUIRE(!added.ok());
  CHECK(added.error().place == folder.file("missing/partial.txt"));
}

TEST_CASE("partial results: a line that does not fit on the disk leaves those of before") {
  const TemporaryFolder folder;
  const std::string path = folder.file("partial.txt"), first = TrialKey().add("first").text(), second = TrialKey().add("second").text();
  PartialResults partial(path);
  REQUIRE(partial.add(first, std::vector{0.1}).ok());
  const auto before = read_file(path);
  {
    const DiskLimit full(std::filesystem::file_size(path) + 5);
    const Status failed = partial.add(second, std::vector{0.2});
    REQUIRE(!failed.ok());
    CHECK(failed.error().place == path);
  }
  CHECK(*read_file(path) == *before);
  CHECK(!partial.find(second, 1));
  REQUIRE(partial.add(second, std::vector{0.2}).ok());
  CHECK(PartialResults(path).find(first, 1) == std::vector{0.1});
  CHECK(PartialResults(path).find(second, 1) == std::vector{0.2});
}

TEST_CASE("partial drillings: a result is that of its trial, of the text of its tool and of its assignments") {
  const TemporaryFolder folder;
  const std::string path = folder.file("partial.txt"), tools = folder.file("tools");
  std::filesystem::copy(test::in_source("app/tools"), tools);
  const DrillingTrial trial{.bit = "ball 6 mm", .sets = {"erosion.rate_hz=50"}};
  PartialDrillings partial(path, tools);
  REQUIRE(partial.add(trial, some_drilling(1.0)).ok());
  const auto figures = [](const DrillingResult& r) {
    const RunSummary& s = r.summary;
    return std::vector{r.volume_mm3,
                       r.drilled_s,
                       r.plunge_mm,
                       r.feed_mm_s,
                       r.ripple_percent,
                       r.roughness_um,
                       r.cpu_s,
                       r.wall_s,
                       r.median_us,
                       r.p99_us,
                       s.removed_mm3,
                       s.removed_mass_mm3,
                       s.spacing_mm,
                       s.depth_mm.value(),
                       s.inner_diameter_mm.value(),
                       static_cast<double>(s.predicted_bytes)};
  };
  const auto found = PartialDrillings(path, tools).find(trial);
  REQUIRE(found.has_value());
  CHECK(same(figures(*found), figures(some_drilling(1.0))));
  CHECK(!found->summary.hole_diameter_mm.has_value());

  DrillingTrial other = trial;
  other.sets = {"erosion.rate_hz=100"};
  CHECK(!PartialDrillings(path, tools).find(other));
  other = trial;
  std::swap(other.sets, other.tool_sets);
  CHECK(!PartialDrillings(path, tools).find(other));
  other = trial;
  other.hand = DrillingHand::bench;
  CHECK(!PartialDrillings(path, tools).find(other));
  other = trial;
  other.bit = "no such bit";
  CHECK(!PartialDrillings(path, tools).find(other));

  // The same name, another bit: the file's content counts.
  const std::string file = tools + "/round_burr_6mm.toml";
  auto text = read_file(file);
  REQUIRE(text.ok());
  const std::size_t at = text->find("erosion_factor = ");
  REQUIRE(at != std::string::npos);
  text->insert(at + std::string("erosion_factor = 0.").size(), "0");
  REQUIRE(write_file(file, *text).ok());
  CHECK(!PartialDrillings(path, tools).find(trial));
}
