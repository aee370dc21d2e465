// [heat] in a scene: what is released and where it goes, against a one-dimensional twin; undo; what is absent.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/drill/energy.h"
#include "core/drill/erosion.h"
#include "tests/support/ablation_twin.h"
#include "tests/support/drilled_post.h"

namespace burrhole::test {
namespace {

constexpr double kFeed = kPostFeed;

LoadedScene post(const std::string& heat, const std::vector<std::string>& sets = {}) { return drilled_post(heat, sets); }

struct Shown {
  double area = 0.0;                    // [m^2]
  double lowest = 1.0, highest = -1.0;  // [m] z of the vertices
};

Shown shown_of(DrillRun& run) {
  const AddedMesh mesh = mesh_of(run);
  Shown out{.area = area_of(mesh)};
  for (const glm::vec3& p : mesh.vertices) {
    out.lowest = std::min(out.lowest, static_cast<double>(p.z));
    out.highest = std::max(out.highest, static_cast<double>(p.z));
  }
  return out;
}

}  // namespace

TEST_CASE(
    "heat: the heat in bone of a drilled post in cells up to 0.5 mm is within 3 % of a twin; the temperature of its inner face within 3 % "
    "and the lag of bone that is a part of a cell") {
  // The bit starts 0.01 mm above the post, and the run ends after 20 s.
  const double share = 0.5, depth = 20.0 * kFeed - 0.01e-3, seconds = depth / kFeed;
  struct Case {
    int cell;
    double voxel;  // [mm]
    int rate;      // [Hz]
  };
  for (const auto& [cell, voxel, rate] :
       {Case{4, 0.25, 50}, Case{2, 0.25, 50}, Case{1, 0.25, 50}, Case{2, 0.2, 50}, Case{2, 0.25, 20}, Case{2, 0.25, 100}}) {
    DrillRun run(post("[heat]\ncell_voxels = " + std::to_string(cell) + "\n",
                      {"volume.spacing_mm=" + std::to_string(voxel), "erosion.rate_hz=" + std::to_string(rate)}));
    run.run();
    const Simulation& simulation = run.simulation();
    CHECK(figure(simulation, "heat", "released_J") == doctest::Approx(share * figure(simulation, "heat", "work_J")).epsilon(1e-9));
    const double removed = figure(simulation, "erosion", "removed_mass_mm3") * 1e-9;
    CHECK(figure(simulation, "heat", "work_J") == doctest::Approx(EnergyConfig{}.specific_energy * removed).epsilon(1e-6));
    CHECK(figure(simulation, "heat", "balance_error") < 1e-4);
    // The voxels round the edges off, so the post is not exactly 2 x 2 x 4 mm: its section is what a depth removes, its length what it holds.
    const double area = removed / depth, length = depth + bone_left(run) / area;
    const double flow = share * EnergyConfig{}.specific_energy * kFeed;
    const AblationTwin twin = ablate(flow, kFeed, length, seconds);
    const double error = figure(simulation, "heat", "in_bone_J") / (twin.in_bone * area) - 1.0;
    const double kelvin = std::log2(figure(simulation, "heat", "dose_inner_face_min") / twin.inner_dose);
    const double edge = cell * run.voxel(), derived = heat_error(twin, flow, kFeed, edge, 1.0 / rate);
    const double lag = std::log2(ablate(flow, kFeed, length, seconds - lag_of_face(edge, 0.0)).inner_dose / twin.inner_dose);
    MESSAGE("cells of " << cell << " voxels of " << voxel << " mm, " << rate << " Hz, " << length * 1e3 << " mm, " << area * 1e6
                        << " mm2: " << error * 100.0 << " %, derived " << derived * 100.0 << " %; inner face " << kelvin << " K of "
                        << twin.inner_rise << ", lag " << lag << " K");
    // Removed and left bone agree with the post of the scene, so errors of removal do not cancel: rounded edges hold at most a quarter of a voxel at
    // either end, an assumption.
    CHECK(std::abs(std::sqrt(area) - 2e-3) < 0.5 * run.voxel());
    CHECK(std::abs(length - 4e-3) < 0.5 * run.voxel());
    // docs/accuracy.md for cells up to the default; of 1 mm the error that is derived.
    CHECK(std::abs(error) < (cell <= 2 ? 0.03 : derived));
    if (cell > 2) continue;  // the cut is one such cell from the face: not all bone between warms alike
    CHECK(kelvin < 0.03 * twin.inner_rise);
    CHECK(kelvin > (cell == 1 ? 0.0 : lag) - 0.03 * twin.inner_rise);
  }
}

TEST_CASE("heat: above 43 C the dose of the inner face doubles with each degree of the body; thresholds of bone and brain") {
  const auto run = [](const std::string& keys) {
    auto out = std::make_unique<DrillRun>(post("[heat]\n" + keys));
    out->run();
    return out;
  };
  const auto dose = [](DrillRun& drilled) { return figure(drilled.simulation(), "heat", "dose_inner_face_min"); };
  const auto warns = [](DrillRun& drilled) {
    std::vector<std::string> out;
    for (const Stage::MadeEffect& made : drilled.simulation().stage().effects()) made.effect->warn(out);
    return std::ranges::any_of(out, [](const std::string& text) { return text.find("blood-brain barrier") != std::string::npos; });
  };
  // The rise does not depend on the body's temperature, so CEM43 has the exact factor 2^4 from 44 to 48 C; floats are summed over 100 steps.
  const auto low = run("share = 0.1\nbody_C = 44\n"), high = run("share = 0.1\nbody_C = 48\n"), cool = run("share = 0.1\n");
  CHECK(dose(*high) == doctest::Approx(16.0 * dose(*low)).epsilon(1e-5));
  // The face is at most as hot as the hottest bone, for at most 20 s.
  CHECK(dose(*low) > 0.0);
  CHECK(dose(*low) < 20.0 / 60.0 * std::exp2(figure(low->simulation(), "heat", "bone_at_most_C") - 43.0));
  CHECK(dose(*high) > 1.3);
  CHECK(warns(*high));
  CHECK(dose(*cool) < 1.3);
  CHECK_FALSE(warns(*cool));
  const auto dead = [](const std::string& keys, const char* name) {
    DrillRun drilled(post("[heat]\n" + keys));
    drilled.run();
    return figure(drilled.simulation(), "heat", name);
  };
  CHECK(dead("damage_dose_min = 64\n", "dead_bone_mm3") == dead("", "dead_bone_64_mm3"));
}

TEST_CASE("heat: the balance of energy is a share of its largest term, so it holds when saline takes far more than is released") {
  DrillRun run(post("[heat]\nshare = 0.001\n[irrigation]\nalways = true\n", {"tool.spin_rpm=1"}));
  run.run();
  const double released = figure(run.simulation(), "heat", "released_J"), coolant = figure(run.simulation(), "heat", "coolant_J");
  MESSAGE("released " << released << " J, taken by saline " << coolant << " J");
  REQUIRE(coolant > 100.0 * released);
  CHECK(figure(run.simulation(), "heat", "balance_error") < 1e-4);
}

TEST_CASE("heat: it depends little on the rate of the bone steps, from 10 ms to 200 ms") {
  std::vector<double> in_bone;
  for (const char* const rate : {"erosion.rate_hz=5", "erosion.rate_hz=20", "erosion.rate_hz=100"}) {
    DrillRun run(post("[heat]\n", {rate}));
    run.run();
    CHECK(figure(run.simulation(), "heat", "balance_error") < 1e-4);
    in_bone.push_back(figure(run.simulation(), "heat", "in_bone_J"));
  }
  // A step of 0.2 s is 0.03 mm of feed, of cells of 0.5 mm: 6 % of a cell is at most in another state.
  CHECK(std::abs(in_bone[0] / in_bone[2] - 1.0) < 0.06);
  CHECK(std::abs(in_bone[1] / in_bone[2] - 1.0) < 0.015);
}

TEST_CASE("heat: share, specific_energy_J_per_mm3 and body_C change what is released and the hottest temperature in proportion") {
  const auto run = [](const std::string& keys, const char* name) {
    DrillRun drilled(post("[heat]\n" + keys, {"duration_s=6.0"}));
    drilled.run();
    return figure(drilled.simulation(), "heat", name);
  };
  const double released = run("", "released_J"), hottest = run("", "hottest_C");
  CHECK(run("share = 0.25\n", "released_J") == doctest::Approx(0.5 * released).epsilon(1e-6));
  CHECK(run("specific_energy_J_per_mm3 = 0.3\n", "released_J") == doctest::Approx(3.0 * released).epsilon(1e-6));
  CHECK(run("body_C = 20\n", "hottest_C") == doctest::Approx(hottest - 17.0).epsilon(1e-6));
}

TEST_CASE("heat: bone in which heat spreads too fast for the steps is refused at the table, and at once") {
  for (const char* const key :
       {"density_kg_per_m3 = 1e-9", "capacity_J_per_kg_K = 5e-324", "fourier = 5e-324", "conductivity_W_per_m_K = 1e9"}) {
    CAPTURE(key);
    const auto document = TomlDocument::parse(scene_text({}) + "[heat]\n" + key + "\n", "small.toml");
    REQUIRE(document);
    Issues issues;
    const auto loaded = load_scene(*document, test_context(), issues);
    if (loaded && issues.empty()) CHECK(Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues) == nullptr);
    REQUIRE(issues.size() == 1);
    CHECK((issues.front().code == ErrorCode::bad_input || issues.front().code == ErrorCode::out_of_range));
    CHECK(issues.front().text().starts_with("small.toml:"));
  }
  const auto runs = [](const std::string& keys) {
    Issues issues;
    const LoadedScene loaded = load_text(scene_text({}) + "[heat]\n" + keys, {});
    return Simulation::create(loaded.scene, loaded.bone, loaded.tool, {}, issues) != nullptr;
  };
  // A step of bone is 20 ms. Of conduction it is fourier h^2 / alpha: 0.25 s by default, so by a factor of 1000 less is 80 steps, and of 2000 160.
  CHECK(runs("density_kg_per_m3 = 1.81\n"));
  CHECK_FALSE(runs("density_kg_per_m3 = 0.905\n"));
}

TEST_CASE("heat: bone that an undo brings back is cold, and the energy stays balanced") {
  DrillRun run(post("[heat]\n", {"duration_s=6.0"}), {.history = true});
  run.run();
  Simulation& simulation = run.simulation();
  const double before = figure(simulation, "heat", "in_bone_J");
  REQUIRE(before > 0.0);
  REQUIRE(simulation.stage().reset());
  CHECK(figure(simulation, "heat", "in_bone_J") == doctest::Approx(before).epsilon(1e-5));
  CHECK(figure(simulation, "heat", "balance_error") < 1e-4);
}

TEST_CASE("heat: cold bone that a reset puts back does not change the dose of the inner face below it") {
  // A quarter of a millimetre is left: of the cells of 1 mm only those of the face.
  DrillRun run(post("[heat]\ncell_voxels = 4\n", {"duration_s=25.2", "hand.stop_mm=3.75"}), {.history = true});
  run.run();
  Simulation& simulation = run.simulation();
  const double before = figure(simulation, "heat", "dose_inner_face_min");
  REQUIRE(before > 1.3);
  REQUIRE(simulation.stage().reset());
  CHECK(figure(simulation, "heat", "dose_inner_face_min") == before);
}

TEST_CASE(
    "irrigation: the saline that arrives is flow x time of turning; it cools no more than its warming allows, and the energy is balanced") {
  const std::string heat = "[heat]\n";
  DrillRun dry(post(heat)), wet(post(heat + "[irrigation]\nflow_ml_per_min = 30\n")),
      drops(post(heat + "[irrigation]\nflow_ml_per_min = 0.02\n"));
  for (DrillRun* run : {&dry, &wet, &drops}) run->run();
  const auto of = [](DrillRun& run, const char* table, const char* name) { return figure(run.simulation(), table, name); };
  const double on = of(wet, "irrigation", "on_s");
  CHECK(on == doctest::Approx(20.0).epsilon(0.05));  // [s] the bit turns from the entry to the stop
  CHECK(of(wet, "irrigation", "delivered_ml") == doctest::Approx(30.0 / 60.0 * on).epsilon(1e-9));
  CHECK(of(dry, "heat", "coolant_J") == 0.0);
  CHECK(of(wet, "heat", "coolant_J") > 0.1 * of(wet, "heat", "released_J"));
  // Saline of 20 C that leaves at most at the temperature of the hottest bone.
  const double warming = of(drops, "heat", "hottest_C") - 20.0;
  CHECK(of(drops, "heat", "coolant_J") <= 0.02e-6 / 60.0 * of(drops, "irrigation", "on_s") * 995.7 * 4180.0 * warming * (1.0 + 1e-6));
  CHECK(of(wet, "heat", "hottest_C") < of(drops, "heat", "hottest_C"));
  CHECK(of(drops, "heat", "hottest_C") < of(dry, "heat", "hottest_C") + 1e-6);
  for (DrillRun* run : {&dry, &wet, &drops}) CHECK(of(*run, "heat", "balance_error") < 1e-4);
}

TEST_CASE("irrigation: with always = true it flows for the whole run") {
  DrillRun drilled(post("[heat]\n[irrigation]\nalways = true\n", {"duration_s=8.0"}));
  CHECK(figure(drilled.run().simulation(), "irrigation", "on_s") == doctest::Approx(8.0).epsilon(1e-9));
}

TEST_CASE("irrigation picture: only if it is asked for, with the same bits; bone is wet within reach of the tip while saline flows") {
  const auto run = [](const std::string& keys, const char* seconds) {
    auto out = std::make_unique<DrillRun>(post("[irrigation]\n" + keys, {seconds}));
    out->run();
    return out;
  };
  const auto without = run("", "duration_s=9.0");
  CHECK(picture_of(*without) == nullptr);
  const auto wet = run("drawn = true\n", "duration_s=9.0");
  CHECK(wet->voxel_hash() == without->voxel_hash());
  const Shown all = shown_of(*wet), near = shown_of(*run("drawn = true\nreach_mm = 1\n", "duration_s=9.0"));
  // The face of the post, 4 mm^2, lies at the tip; its sides lie below, wet down to a voxel, 2 mm^2.
  CHECK(all.area > 3.5e-6);
  CHECK(all.area < 8e-6);
  CHECK(near.area < 0.9 * all.area);
  CHECK(all.highest < -kFeed * 8.0 + 0.5e-3);
  CHECK(all.lowest > -kFeed * 9.0 - 0.5e-3);
  // After the stop the drill is withdrawn and stands: dry, unless it always flows within reach.
  CHECK(shown_of(*run("drawn = true\n", "duration_s=60.0")).area == 0.0);
}

TEST_CASE("heat: without the table there is no step, no column and no figure of it") {
  DrillRun without(post(""));
  DrillRun with(post("[heat]\n"));
  const auto columns = [](DrillRun& run) {
    std::size_t count = 0;
    for (const StepColumn& column : run.simulation().stage().graph.columns(Clock::simulation)) count += column.name == "hottest" ? 1 : 0;
    return count;
  };
  CHECK(columns(without) == 0);
  CHECK(columns(with) == 1);
  CHECK_FALSE(without.simulation().stage().figure("heat", "hottest_C").has_value());
}

TEST_CASE("heat picture: without its table nothing is drawn; with it the bone has the same bits") {
  const auto run = [](const std::string& keys) {
    auto out = std::make_unique<DrillRun>(post("[heat]\n" + keys, {"duration_s=9.0"}));
    out->run();
    return out;
  };
  const auto without = run("");
  CHECK(picture_of(*without) == nullptr);
  const auto with = run("[heat.picture]\n");
  CHECK(with->voxel_hash() == without->voxel_hash());
  CHECK(figure(with->simulation(), "heat", "hottest_C") == figure(without->simulation(), "heat", "hottest_C"));
  const Shown shown = shown_of(*with);
  // 1.3 mm of the post of 4 mm^2 have been drilled: its face is warm, and nothing is drawn where it was.
  CHECK(shown.area > 4e-6);
  CHECK(shown.highest < -kFeed * 8.0 + 0.5e-3);
  // Cold at first, and again far above the hottest.
  DrillRun fresh(post("[heat]\n[heat.picture]\n"));
  CHECK(shown_of(fresh).area == 0.0);
  CHECK(shown_of(*run("[heat.picture]\nlowest_C = 900\nhighest_C = 1000\n")).area == 0.0);
}

TEST_CASE("heat: the section for the report has the hole, and values between body and hottest bone") {
  DrillRun run(post("[heat]\n"));
  run.run();
  std::vector<ValueMap> maps;
  for (const Stage::MadeEffect& made : run.simulation().stage().effects())
    for (ValueMap& map : made.effect->maps()) maps.push_back(std::move(map));
  REQUIRE(maps.size() == 1);
  const ValueMap& map = maps.front();
  REQUIRE(map.values.size() == map.columns * map.rows);
  const double most = figure(run.simulation(), "heat", "bone_at_most_C");
  std::size_t empty = 0;
  double largest = 0.0;
  for (std::size_t row = 0; row < map.rows; ++row)
    for (std::size_t column = 0; column < map.columns; ++column) {
      const float value = map.values[row * map.columns + column];
      if (std::isnan(value)) {
        ++empty;
        continue;
      }
      CHECK(map.y + static_cast<double>(row) * map.pitch > 2.4);  // only the last millimetre of the post is left
      CHECK(value >= 37.0f);
      largest = std::max(largest, static_cast<double>(value));
    }
  CHECK(empty > map.values.size() / 2);
  // The section does not pass every cell, and leaves out those that are less than half full.
  CHECK(largest <= most + 1e-4);
  CHECK(largest - 37.0 > 0.5 * (most - 37.0));
}

}  // namespace burrhole::test
