#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "app/lab/drilling_cost.h"
#include "app/report/file.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

DrillingCostOptions options_for(const std::string& knob, unsigned threads) {
  DrillingCostOptions out;
  out.runs.tool_folder = test::in_source("app/tools");
  out.runs.threads = threads;
  out.bit = "flat 4 mm";
  out.only_knob = knob;
  out.quick = true;
  return out;
}

std::vector<DrillingPoint> points_of(const DrillingCostOptions& options) {
  const auto points = measure_drilling_cost(options);
  REQUIRE_MESSAGE(points.ok(), (points ? "" : points.error().text()));
  return *points;
}

}  // namespace

TEST_CASE("drilling cost: every setting has a default that is read from the scene or tool, and a scene that says it changes nothing") {
  const auto loaded = load_drilling({.bit = "flat 4 mm"}, test::in_source("app/tools"));
  REQUIRE(loaded.ok());
  for (const DrillingKnob& knob : drilling_knobs()) {
    CAPTURE(knob.name);
    const double shipped = knob.shipped(*loaded);
    REQUIRE(std::isfinite(shipped));
    CHECK(std::ranges::count(knob.multiples, 1.0) == 1);
    CHECK(std::ranges::count(knob.quick, 1.0) == 1);
    // Each value is a valid scene, and is the one that the knob then reads.
    for (const double multiple : knob.multiples) {
      DrillingTrial trial{.bit = "flat 4 mm"};
      knob.set(multiple * shipped, shipped, trial);
      const auto varied = load_drilling(trial, test::in_source("app/tools"));
      REQUIRE_MESSAGE(varied.ok(), (varied ? "" : varied.error().text()));
      CHECK(knob.shipped(*varied) == doctest::Approx(multiple * shipped).epsilon(1e-5));
    }
  }
}

TEST_CASE("drilling cost: a bit of one's own has the closed form that the study gives to its bits") {
  for (const DrillingBit& bit : drilling_bits()) {
    CAPTURE(bit.name);
    const auto text = drilling_bit_text(bit, test::in_source("app/tools"));
    REQUIRE(text.ok());
    const auto own = own_drilling_bit("my bit", *text);
    REQUIRE_MESSAGE(own.ok(), (own ? "" : own.error().text()));
    CHECK(own->swept.radius == doctest::Approx(bit.swept.radius));
    CHECK(own->swept.bore == doctest::Approx(bit.swept.bore));
    CHECK(own->widest_at == doctest::Approx(bit.widest_at));
    CHECK(own->finest_mm <= 0.125);
    // It drills the bone of the study's bit.
    const DrillingTrial trial{.bit = "my bit", .own = std::make_shared<DrillingBit>(*own)};
    const auto loaded = load_drilling(trial, "nowhere"), known = load_drilling({.bit = bit.name}, test::in_source("app/tools"));
    REQUIRE_MESSAGE(loaded.ok(), (loaded ? "" : loaded.error().text()));
    REQUIRE(known.ok());
    CHECK(loaded->bone->dims() == known->bone->dims());
    CHECK(loaded->tool.erosion.factors == known->tool.erosion.factors);
  }
}

TEST_CASE("drilling cost: a bit without a closed form is refused") {
  const auto refused = [](const std::string& text) {
    const auto own = own_drilling_bit("my bit", text);
    REQUIRE(!own.ok());
    return own.error().text();
  };
  const auto saw = read_file(test::in_source("app/tools/sagittal_saw_12mm.toml"));
  REQUIRE(saw.ok());
  CHECK(refused(*saw).find("does not revolve") != std::string::npos);
  CHECK(refused("[mesh]\nfile = \"burr.stl\"\n").find("a mesh has not") != std::string::npos);
  const std::string passive =
      "title = \"rod\"\n[shell]\npitch_mm = 0.5\n[[region]]\nname = \"rod\"\nshape = \"cylinder\"\nz_mm = 0\nheight_mm = 9\ndiameter_mm = "
      "2\nerosion_factor "
      "= 0\n";
  CHECK(refused(passive).find("does not cut") != std::string::npos);
}

TEST_CASE("drilling cost: records of 8 bits cost memory less and accuracy more, with any number of threads") {
  const auto points = points_of(options_for("contact.record_bits", 2)), again = points_of(options_for("contact.record_bits", 1));
  REQUIRE(points.size() == 2);
  const DrillingPoint &coarse = points[0], &shipped = points[1];
  CHECK(coarse.setting == 8.0);
  CHECK(shipped.setting == shipped.shipped);
  CHECK(coarse.bytes < shipped.bytes);
  CHECK(coarse.ripple_percent > shipped.ripple_percent);  // distances have steps of 1/32 voxel instead of 1/4096
  // The reference of this setting is the default itself.
  CHECK(shipped.time_percent == 0.0);
  CHECK(std::abs(shipped.volume_percent) < 3.0);
  CHECK(shipped.early_stops == 0.0);
  for (std::size_t n = 0; n < points.size(); ++n)
    for (const DrillingFigure& figure : drilling_figures()) {
      const double one = points[n].*figure.value, other = again[n].*figure.value;
      if (std::string(figure.reference != nullptr ? figure.reference : "") != "measured") CHECK((one == other || std::isnan(one)));
    }
}

TEST_CASE("drilling cost: a study that was interrupted within a line gives the points of an uninterrupted one") {
  const TemporaryFolder folder;
  DrillingCostOptions options = options_for("contact.record_bits", 1);
  options.runs.partial = folder.file("partial.txt");
  const auto points = points_of(options);
  const auto whole = read_file(options.runs.partial);
  REQUIRE(whole.ok());
  // Cut within the last line: its hole is drilled again, the others are not.
  REQUIRE(write_file(options.runs.partial, whole->substr(0, whole->size() - 40)).ok());
  std::size_t drilled = 0;
  std::string said;
  options.runs.progress = [&](double, const std::string&) { ++drilled; };
  options.runs.say = [&](const std::string& line) { said = line; };
  const auto again = points_of(options);
  CHECK(drilled == 1);
  CHECK(said.find("are not drilled again") != std::string::npos);
  REQUIRE(again.size() == points.size());
  for (std::size_t n = 0; n < points.size(); ++n)
    for (const DrillingFigure& figure : drilling_figures()) {
      CAPTURE(figure.name);
      const double one = points[n].*figure.value, other = again[n].*figure.value;
      if (std::string(figure.reference != nullptr ? figure.reference : "") != "measured")
        CHECK((one == other || (std::isnan(one) && std::isnan(other))));
    }
}

TEST_CASE("drilling cost: a row per point and figure, a sentence per setting, and a plot that marks the default") {
  std::vector<DrillingPoint> points;
  for (const double setting : {50.0, 100.0, 200.0})
    points.push_back({.knob = "erosion.rate_hz",
                      .unit = "Hz",
                      .reference = "finer",
                      .setting = setting,
                      .shipped = 100.0,
                      .volume_percent = 300.0 / setting,
                      .time_percent = -200.0 / setting,
                      .cpu_s = setting / 50.0,
                      .bytes = 2e6});
  const std::vector<CostRow> rows = drilling_cost_rows(points, "flat");
  const auto finer = std::ranges::count_if(drilling_figures(), [](const DrillingFigure& f) { return f.own != nullptr; });
  CHECK(finer == 4);
  CHECK(rows.size() == points.size() * (drilling_figures().size() + static_cast<std::size_t>(finer)));
  const std::vector<std::string> sentences = drilling_sentences(points);
  REQUIRE(sentences.size() == 1);
  CHECK(
      sentences[0] ==
      "`erosion.rate_hz`: the default, 100 Hz, has errors of +3.0 % of volume, -2.0 % of time and +0.00 mm of plunge; 50 Hz takes 0.50 of "
      "the CPU time and 1.00 of the memory, with +6.0 % of volume, -4.0 % of time and +0.00 mm of plunge; 200 Hz takes 2.00 of the CPU "
      "time and 1.00 of the memory, with +1.5 % of volume, -1.0 % of time and +0.00 mm of plunge (time and plunge against finer).");
  // With the reference's own error: 1 % lies below the 1.5 % of it, 2 and 4 % do not.
  for (DrillingPoint& point : points) point.own.time_percent = 1.5, point.own.plunge_mm = 0.25;
  const std::string known = drilling_sentences(points)[0];
  for (const char* part : {"-2.0 +- 1.5 % of time and plunge below the reference's own error of 0.25 mm", "-4.0 +- 1.5 % of time",
                           "time below the reference's own error of 1.5 %"})
    CHECK_MESSAGE(known.find(part) != std::string::npos, part);
  const TemporaryFolder folder;
  const Status written = write_drilling_cost(points, "flat", folder.path().string());
  if (!written && written.error().code == ErrorCode::unavailable) return;  // no gnuplot
  REQUIRE(written.ok());
  const auto table = read_file(folder.file("drilling.md"));
  REQUIRE(table.ok());
  for (const char* part : {"| -2.00 +- 1.50 | below 0.250 |", "| below 1.50 | below 0.250 |", "| -4.00 +- 1.50 |"})
    CHECK_MESSAGE(table->find(part) != std::string::npos, part);
  std::ifstream svg(folder.path() / "drilling.svg");
  std::ostringstream text;
  text << svg.rdbuf();
  CHECK(text.str().find("default") != std::string::npos);
  // Bounds are other marks than errors: one of time, three of plunge, three of the ripple, and the sample in the legend.
  const std::string drawn = text.str();
  std::size_t bounds = 0;
  for (std::size_t at = drawn.find("href='#gpPt9' transform"); at != std::string::npos; at = drawn.find("href='#gpPt9' transform", at + 1))
    ++bounds;
  CHECK(bounds == 8);
}

TEST_CASE("drilling cost: the reference's own error is its difference from a second run, half as fine, drilled by itself") {
  const DrillingCostOptions options = options_for("erosion.substep_voxels", 2);
  const auto points = points_of(options);
  REQUIRE(points.size() == 2);
  const auto loaded = load_drilling({.bit = options.bit}, options.runs.tool_folder);
  REQUIRE(loaded.ok());
  const auto drilled = [&](double value) {
    DrillingTrial trial{.bit = options.bit, .hand = DrillingHand::script, .sets = {fmt::format("erosion.substep_voxels={:g}", value)}};
    const auto run = run_drilling(trial, options.runs.tool_folder);
    REQUIRE(run.ok());
    return *run;
  };
  const DrillingResult fine = drilled(0.125), half = drilled(0.25);  // a quarter and a half of the default of 0.5
  for (const DrillingPoint& point : points) {
    CHECK(point.own.plunge_mm == doctest::Approx(std::abs(half.plunge_mm - fine.plunge_mm)).epsilon(1e-12));
    CHECK(point.own.time_percent == doctest::Approx(100.0 * std::abs(half.drilled_s / fine.drilled_s - 1.0)).epsilon(1e-9));
    CHECK(point.reference == "0.125 voxels; its own error from 0.25 voxels");
  }
  for (const DrillingKnob& knob : drilling_knobs()) {
    CAPTURE(knob.name);
    const double shipped = knob.shipped(*loaded);
    const auto second = second_value(knob, *find_drilling_bit(options.bit), false, shipped);
    const double finest = finest_value(knob, *find_drilling_bit(options.bit), false, shipped);
    CHECK(second.has_value() == (finest != 0.0 && finest != shipped));
    if (second) CHECK((*second / finest == 2.0 || *second / finest == 0.5));
    if (second) CHECK(std::abs(std::log(*second / shipped)) < std::abs(std::log(finest / shipped)));  // between reference and default
  }
}

TEST_CASE("drilling cost: an unknown bit or setting is refused") {
  DrillingCostOptions options = options_for("no.such_key", 1);
  CHECK(!measure_drilling_cost(options));
  options = options_for("erosion.rate_hz", 1);
  options.bit = "spoon";
  CHECK(!measure_drilling_cost(options));
}
