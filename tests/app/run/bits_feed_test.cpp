// The feed of every shipped bit in a homogeneous plate of hardness 1, under a fixed thrust of 20 and 40 N on a bench, beside the prediction
// that `burrhole tools` prints: within 10 %, or unknown for a reason.

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/drill/removal_rate.h"
#include "tests/support/drill_scene.h"
#include "tests/support/source_folder.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// Why a feed is not known.
enum class Unknown {
  never,
  coarse_rim,  ///< the 316 points of the paper
  by_lag       ///< engaged by less than a voxel at a point, over half of the width or the point, or deeper than the skin
};

struct FeedCase {
  std::string name;
  double across_mm, thickness_mm, spacing_mm;  ///< of the plate
  double from_mm, to_mm;                       ///< depths between which the feed is measured: engaged with the whole end
  Unknown unknown = Unknown::never;
  double least_lag = 0.0, most_lag = 1.0;  ///< [m] engaged depths between which the feed is known
};

// The saw is in voxels of a quarter of its kerf, as its file asks for.
const FeedCase kCases[] = {{"acorn_burr_7_5mm", 11, 8, 0.25, 3.0, 3.4},
                           {"acosta_liu_perforator", 17, 5, 0.25, 0.8, 2.0, Unknown::coarse_rim},
                           {"acosta_liu_round", 8, 6, 0.25, 1.6, 3.0},
                           {"matchstick_burr_3mm", 7, 5, 0.25, 0.6, 1.0, Unknown::by_lag, 0.0, 0.4e-3},
                           {"perforator_14_11", 17, 7, 0.25, 3.6, 4.0},
                           {"round_burr_2mm", 6, 5, 0.25, 0.8, 1.2},
                           {"round_burr_3mm", 7, 5, 0.25, 1.2, 1.6},
                           {"round_burr_4mm", 8, 5, 0.25, 1.5, 1.9},
                           {"round_burr_5mm", 9, 6, 0.25, 2.0, 2.4},
                           {"round_burr_6mm", 10, 6, 0.25, 2.4, 2.8},
                           {"sagittal_saw_12mm", 15, 5, 0.15, 0.5, 1.0, Unknown::by_lag, 0.0, 0.3e-3},
                           {"trephine_12mm", 15, 5, 0.25, 1.0, 2.0},
                           {"twist_drill_2_5mm", 6, 7, 0.25, 1.5, 3.5, Unknown::by_lag, 0.25e-3, 0.37e-3}};

const FeedCase& case_of(const std::string& name) {
  for (const FeedCase& one : kCases)
    if (one.name == name) return one;
  FAIL(name);
  return kCases[0];
}

/// @param more [erosion] keys.
LoadedScene bench(const FeedCase& c, double push, const std::string& entry, const std::string& more = "") {
  const std::string across = std::to_string(c.across_mm);
  return load_text(
      "title = \"Feed\"\nduration_s = 100\n[volume]\nsource = \"phantom:plate\"\nspacing_mm = " + std::to_string(c.spacing_mm) +
          "\nextent_mm = [" + across + ", " + across + ", " + std::to_string(c.thickness_mm + 3.0) +
          "]\nabove_mm = 1.5\nthickness_mm = " + std::to_string(c.thickness_mm) + "\nhardness = 1\n[tool]\nname = \"" + c.name +
          "\"\nspin_rpm = 1000\n[approach]\nentry_mm = " + entry + "\n[hand]\nkind = \"feed\"\npush_N = " + std::to_string(push) +
          "\nramp_s = 0.1\nfeed_mm_per_s = 5\nstandoff_mm = 0.5\nstop_mm = " + std::to_string(c.to_mm + 0.1) + "\n[contact]\n[erosion]\n" +
          more,
      {});
}

struct Feed {
  double simulated = 0.0;  ///< [m/s]
  FeedPrediction predicted;
};

Feed feed_of(const FeedCase& c, double push, const std::string& entry = "[0, 0, 0]", const std::string& more = "") {
  std::atomic<bool> stop{false};
  SimulationOptions options;
  options.stop = &stop;
  options.progress = [&](double, const DrillProgress& p) { stop = p.depth > (c.to_mm + 0.02) * 1e-3; };
  DrillRun run(bench(c, push, entry, more), options);
  run.run();
  const Simulation& simulation = run.simulation();
  Feed out;
  out.simulated = (c.to_mm - c.from_mm) * 1e-3 / (time_at_depth(simulation, c.to_mm * 1e-3) - time_at_depth(simulation, c.from_mm * 1e-3));
  out.predicted = predict_feed(run.loaded().tool, FeedDirection::plunge, {.thrust = push, .voxel_edge = run.voxel()});
  MESSAGE(c.name << " at " << push << " N, entry " << entry << ": simulated " << out.simulated * 1e3 << " mm/s, predicted "
                 << out.predicted.speed * 1e3 << " (" << out.predicted.least * 1e3 << " to " << out.predicted.most * 1e3 << "), ratio "
                 << out.simulated / out.predicted.speed << std::string(out.predicted.unknown.empty() ? "" : ", unknown: ")
                 << out.predicted.unknown);
  return out;
}

void check(const std::string& name) {
  const FeedCase& c = case_of(name);
  for (const double push : {20.0, 40.0}) {
    const Feed feed = feed_of(c, push);
    // A pointed end is known where it is engaged by a voxel or more.
    const double lag = feed.predicted.engaged;
    const bool known = c.unknown == Unknown::never || (c.unknown == Unknown::by_lag && lag >= c.least_lag && lag <= c.most_lag);
    CHECK(feed.predicted.unknown.empty() == known);
    if (known) CHECK(std::abs(feed.simulated / feed.predicted.speed - 1.0) < 0.1);
  }
}

TEST_CASE("feeds: every shipped bit has its case, but the craniotome, whose foot does not cut") {
  std::set<std::string> cases{"craniotome_2_3mm"}, files;
  for (const FeedCase& one : kCases) cases.insert(one.name);
  for (const auto& entry : std::filesystem::directory_iterator(in_source("app/tools"))) files.insert(entry.path().stem().string());
  CHECK(cases == files);
  const LoadedScene loaded = bench({"craniotome_2_3mm", 8, 5, 0.25, 0, 0}, 20.0, "[0, 0, 0]");
  const FeedPrediction none = predict_feed(loaded.tool, FeedDirection::plunge, {});
  CHECK(none.speed == 0.0);
  CHECK(none.unknown.empty());
}

TEST_CASE("feeds: the acorn burr") { check("acorn_burr_7_5mm"); }
TEST_CASE("feeds: the bits of Acosta and Liu") {
  check("acosta_liu_perforator");
  check("acosta_liu_round");
}
TEST_CASE("feeds: the matchstick burr") { check("matchstick_burr_3mm"); }
TEST_CASE("feeds: the perforator") { check("perforator_14_11"); }
TEST_CASE("feeds: round burrs of 2 and 3 mm") {
  check("round_burr_2mm");
  check("round_burr_3mm");
}
TEST_CASE("feeds: the round burr of 4 mm") { check("round_burr_4mm"); }
TEST_CASE("feeds: the round burr of 5 mm") { check("round_burr_5mm"); }
TEST_CASE("feeds: the round burr of 6 mm") { check("round_burr_6mm"); }
TEST_CASE("feeds: the saw, the trephine and the twist drill") {
  check("sagittal_saw_12mm");
  check("trephine_12mm");
  check("twist_drill_2_5mm");
}

TEST_CASE("feeds: a round burr feeds alike in voxels of 0.15 to 0.3125 mm, wherever its axis lies between them") {
  FeedCase burr = case_of("round_burr_2mm");
  // The face on the axis recedes at the law's speed; its shape between voxels is worth a percent or two.
  for (const double spacing : {0.15, 0.25, 0.3125}) {
    burr.spacing_mm = spacing;
    const std::string half = std::to_string(0.5 * spacing);
    for (const std::string& entry : {std::string("[0, 0, 0]"), "[" + half + ", " + half + ", 0]"}) {
      const Feed feed = feed_of(burr, 28.0, entry);
      CHECK(feed.predicted.unknown.empty());
      CHECK(std::abs(feed.simulated / feed.predicted.speed - 1.0) < 0.05);
    }
  }
}

TEST_CASE("feeds: a bit feeds alike at 20 to 500 erosion steps a second") {
  FeedCase crown = case_of("trephine_12mm");
  crown.thickness_mm = 8.0;
  crown.to_mm = 6.0;
  const auto at_rate = [&](int rate) { return feed_of(crown, 20.0, "[0, 0, 0]", "rate_hz = " + std::to_string(rate) + "\n"); };
  const Feed fine = at_rate(500);
  const double time = (crown.to_mm - crown.from_mm) * 1e-3 / fine.simulated;
  for (const int rate : {20, 50}) {
    // Of second order in x, the share of the overlap that a step removes; depths are reached within a step.
    const double dt = 1.0 / rate, x = fine.predicted.speed / fine.predicted.engaged * dt, bound = x * x / 12.0 + dt / time + 1e-3;
    CHECK(std::abs(at_rate(rate).simulated / fine.simulated - 1.0) < bound);
    CHECK(0.5 * x > 2.0 * bound);  // with the pose at the end of each step the feed would be lower by x / 2
  }
}

TEST_CASE("feeds: a weak axis without a core is felt by where it lies between voxels, within the range that is predicted") {
  const TemporaryFolder folder;
  std::ostringstream file;
  file << std::ifstream(in_source("app/tools/round_burr_4mm.toml")).rdbuf();
  const std::string shipped = file.str();
  const std::string key = "axis_factor = 0.25\n";
  REQUIRE(shipped.find(key) != std::string::npos);
  std::ofstream(folder.file("burr.toml")) << std::string(shipped).replace(shipped.find(key), key.size(), key + "axis_core_mm = 0\n");
  FeedCase burr = case_of("round_burr_4mm");
  burr.name = folder.file("burr.toml");
  const Feed between = feed_of(burr, 40.0), on_node = feed_of(burr, 40.0, "[0.125, 0.125, 0]");
  CHECK_FALSE(between.predicted.unknown.empty());
  CHECK(between.simulated > 1.1 * on_node.simulated);
  CHECK(on_node.simulated > 0.9 * on_node.predicted.least);
  CHECK(between.simulated < 1.1 * between.predicted.most);
}

}  // namespace
}  // namespace burrhole::test
