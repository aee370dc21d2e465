// How fast a post narrower than the tool is drilled, against the closed form: without walls the front moves in one dimension.
//   Sub-voxel the face lags the tip by F / K_cut and recedes at lambda times its lag: v = (F / K_cut) lambda with lambda = e s / h.
//   By whole voxels a layer at depth x behind the tip has been eroded for x / v, so its density is exp(-lambda x / v); the front, where it
//   is 0.5, lies F / K_cut behind the tip, and so v = (F / K_cut) lambda / ln 2. Voxels let the tip see the exponential as chords between
//   layers: the front is seen late and the drill is slower, by a share that is checked here to halve with the voxel.
//   Of the punch's shell one point alone, on the axis, meets the post: all load is on one plane, so its own give counts in full and the
//   engaged depth is F / K_cut; and no point rests on an edge, whose slanted normal would push the tool off a post that has no walls.

#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "tests/support/drill_scene.h"

namespace burrhole::test {
namespace {

constexpr double kFactor = 0.1, kSpin = 1000.0 / 60.0;  // of the punch [1/rev], [rev/s]

/// Steady drilling between two depths of the tip, once the start is forgotten and before the far side is near.
struct Steady {
  double speed = 0.0;       ///< [m/s]
  double force = 0.0;       ///< [N] mean
  double engagement = 0.0;  ///< [m] mean, as published
  double lag = 0.0;         ///< [m] mean of tip depth minus the first bone on the axis
  double voxel = 0.0;       ///< [m]
  double time = 0.0;        ///< [s] between the two depths

  [[nodiscard]] double theory(double cutting_stiffness, double scale, double hardness, bool subvoxel) const {
    return force / cutting_stiffness * (kFactor * scale * kSpin / hardness) / (subvoxel ? 1.0 : std::numbers::ln2);
  }
};

constexpr double kFrom = 1.2e-3, kTo = 2.2e-3;  // [m] of the tip; the post is 4 mm long

SmallScene post(std::vector<std::string> sets) {
  SmallScene scene{.volume = kPostKeys, .sets = std::move(sets)};
  // Twice the factor, so that a run is short; the hand cannot take the motion for a breakthrough.
  scene.sets.insert(scene.sets.begin(),
                    {"tool.name=punch", "tool.erosion_scale=2", "hand.detects=false", "erosion.rate_hz=250", "duration_s=9"});
  return scene;
}

/// Depth [m] of the 0.5 level on the middle column of voxels, seen from outside; the post is even across.
double front_on_axis(Voxmap& voxmap) {
  const Vec3i dims = voxmap.bone().dims();
  const Vec3i first(dims.x / 2, dims.y / 2, 0);
  std::vector<float> density(static_cast<std::size_t>(dims.z));
  voxmap.read_density({first, first + Vec3i(1, 1, dims.z)}, density);
  for (std::size_t k = density.size() - 1; k-- > 0;) {
    if (density[k] < kSurfaceLevel) continue;
    const double inside = static_cast<double>(density[k]), outside = static_cast<double>(density[k + 1]);
    const double height = static_cast<double>(k) + (inside - 0.5) / (inside - outside);
    return -(voxmap.bone().bone_from_index() * Vec3(first.x, first.y, height)).z;
  }
  return 1e9;
}

Steady drill_post(std::vector<std::string> sets) {
  LoadedScene loaded = load_small(post(std::move(sets)));
  Steady out;
  int looks = 0;
  Simulation* simulation = nullptr;
  std::atomic<bool> stop{false};
  WatchedHand hand(loaded, [&] {
    const double depth = simulation->progress().depth;
    stop = depth > kTo;
    if (depth < kFrom || depth > kTo) return;
    out.lag += depth - front_on_axis(simulation->voxmap());
    out.engagement += simulation->contact_state().engagement;
    out.force += simulation->servo_output().force.z;
    ++looks;
  });
  SimulationOptions options;
  options.hand = &hand;
  options.stop = &stop;
  DrillRun run(std::move(loaded), options);
  simulation = &run.simulation();
  run.run();
  const double from = time_at_depth(*simulation, kFrom), to = time_at_depth(*simulation, kTo);
  REQUIRE(from > 0.0);
  REQUIRE(to > from);
  out.force /= looks;
  out.engagement /= looks;
  out.lag /= looks;
  out.time = to - from;
  out.speed = (kTo - kFrom) / out.time;
  out.voxel = run.voxel();
  return out;
}

std::string figures(const Steady& s) {
  return "v " + std::to_string(s.speed * 1e3) + " mm/s, F " + std::to_string(s.force) + " N, engaged " +
         std::to_string(s.engagement * 1e3) + " mm, tip past front " + std::to_string(s.lag * 1e3) + " mm";
}

struct SpeedCase {
  std::string what;
  std::vector<std::string> sets;
  double cutting_stiffness, scale, hardness;
  bool deep;  ///< engaged by two voxels; else by one
};
const SpeedCase kSpeedCases[] = {{"20 N, 40 kN/m", {}, 40e3, 2.0, 0.8, true},
                                 {"10 N, 20 kN/m", {"hand.push_N=10", "contact.cutting_N_per_m=20e3"}, 20e3, 2.0, 0.8, true},
                                 {"30 N, 40 kN/m", {"hand.push_N=30"}, 40e3, 2.0, 0.8, true},
                                 {"soft bone", {"volume.hardness=0.4", "tool.erosion_scale=0.7"}, 40e3, 0.7, 0.4, true},
                                 {"10 N, 40 kN/m", {"hand.push_N=10"}, 40e3, 2.0, 0.8, false},
                                 {"20 N, 80 kN/m", {"contact.cutting_N_per_m=80e3"}, 80e3, 2.0, 0.8, false}};

double over_theory(const SpeedCase& c, const std::string& subvoxel) {
  CAPTURE(c.what);
  std::vector<std::string> sets = c.sets;
  sets.push_back("erosion.subvoxel=" + subvoxel);
  const Steady s = drill_post(sets);
  const double ratio = s.speed / s.theory(c.cutting_stiffness, c.scale, c.hardness, subvoxel == "true");
  MESSAGE(c.what << ": " << figures(s) << ", over theory " << ratio);
  return ratio;
}

// What keeps a run from the closed form: chords between voxel layers take 1.6 % at two voxels of engaged depth and 7 % at one; bone is cut
// a bone step after the tool came, v dt over the engaged depth, 2.3 % at 250 Hz and 3 mm/s.
TEST_CASE("speed, whole voxels: v = (F / K_cut) lambda / ln 2 within 5 % at two voxels of engaged depth, 12 % at one") {
  for (const SpeedCase& c : kSpeedCases) CHECK(std::abs(over_theory(c, "false") - 1.0) < (c.deep ? 0.05 : 0.12));
}

// Sub-voxel a step takes 1 - exp(-lambda dt) of the overlap, lambda dt / 2 less than lambda dt: 0.8 % at 250 Hz and 4.2 / s. A plane
// presses with its own give, 2 % of F / K_cut, which the face sees as overlap.
TEST_CASE("speed, sub-voxel: v = (F / K_cut) lambda within 4 %, at one voxel of engaged depth as at two") {
  for (const SpeedCase& c : kSpeedCases) CHECK(std::abs(over_theory(c, "true") - 1.0) < 0.04);
}

TEST_CASE("speed, whole voxels: half the voxel comes at least twice as near to the closed form") {
  const Steady coarse = drill_post({"erosion.subvoxel=false"});
  const Steady fine = drill_post({"erosion.subvoxel=false", "volume.spacing_mm=0.125", "volume.extent_mm=[4.5,4.5,6.0]"});
  const double coarse_error = std::abs(coarse.speed / coarse.theory(40e3, 2.0, 0.8, false) - 1.0);
  const double fine_error = std::abs(fine.speed / fine.theory(40e3, 2.0, 0.8, false) - 1.0);
  MESSAGE("off by " << coarse_error << " at 0.25 mm, by " << fine_error << " at 0.125 mm");
  CHECK(fine_error < 0.5 * coarse_error);
}

TEST_CASE("speed, sub-voxel: half the voxel and a quarter drill at the same speed within 1 %") {
  const double coarse = drill_post({}).speed;
  for (const std::string spacing : {"0.125", "0.0625"})
    CHECK(drill_post({"volume.spacing_mm=" + spacing, "volume.extent_mm=[4.5,4.5,6.0]"}).speed == doctest::Approx(coarse).epsilon(0.01));
}

TEST_CASE("engaged depth: F / K_cut in steady drilling, as published and as measured on the bone") {
  for (const std::string push : {"10", "20"})
    for (const double cutting_stiffness : {25e3, 40e3}) {
      const Steady s = drill_post({"hand.push_N=" + push, "contact.cutting_N_per_m=" + std::to_string(cutting_stiffness)});
      const double expected = s.force / cutting_stiffness;
      MESSAGE(push << " N, " << cutting_stiffness << " N/m: " << figures(s) << ", F / K_cut " << expected * 1e3 << " mm");
      // Force and state are looked at a tick apart, in which the tip moves into bone that is cut at the next bone step.
      CHECK(std::abs(s.engagement - expected) < s.speed * 1e-3);
      // The front is found on the ramp of density, exact to 0.02 voxel; it moves by a bone step's way; one plane gives by a fiftieth.
      CHECK(std::abs(s.lag - expected) < 0.02 * s.voxel + s.speed / 250.0 + 0.02 * expected);
    }
}

/// From the first force to the end of the bone on the axis [s]; full thrust is there within 0.05 s, the drill takes several seconds.
double time_in_bone(std::vector<std::string> sets) {
  sets.insert(sets.begin(), {"hand.ramp_s=0.05", "hand.follow_s=0.02"});
  std::atomic<bool> stop{false};
  SimulationOptions options;
  options.stop = &stop;
  options.progress = [&](double, const DrillProgress& p) { stop = p.breakthrough_time.has_value(); };
  DrillRun run(post(std::move(sets)), options);
  const Simulation& simulation = run.run().simulation();
  REQUIRE(simulation.progress().breakthrough_time.has_value());
  return *simulation.progress().breakthrough_time - first_contact(simulation);
}

TEST_CASE("time in bone: doubling e s halves it, doubling the hardness doubles it") {
  const double plain = time_in_bone({"tool.erosion_scale=0.8"});
  const double twice_factor = time_in_bone({"tool.erosion_scale=1.6"});
  MESSAGE(plain << " s; " << twice_factor << " s at twice the factor");
  // 10 %: touching down and building up thrust (0.1 s) take as long whatever the bone; nothing is subtracted for them.
  CHECK(std::abs(plain / twice_factor - 2.0) < 0.2);
  // e s / h enters as one number: powers of two give the same bits, so that speed and hardness need no tolerance of their own.
  const double factor = drill_post({"tool.erosion_scale=2"}).time;
  CHECK(drill_post({"tool.erosion_scale=1", "tool.spin_rpm=2000"}).time == factor);
  CHECK(drill_post({"tool.erosion_scale=1", "volume.hardness=0.4"}).time == doctest::Approx(factor).epsilon(1e-4));
}

TEST_CASE("time between two depths in steady drilling: halves within 3 % when the thrust that was felt is allowed for") {
  const Steady plain = drill_post({"tool.erosion_scale=1"});
  const Steady twice = drill_post({"tool.erosion_scale=2"});
  // The arm follows a faster drill at a distance, which its spring takes from the thrust: work with the force that was there.
  const double ratio = plain.time * plain.force / (twice.time * twice.force);
  MESSAGE(plain.time << " s and " << twice.time << " s for a millimetre; ratio at equal thrust " << ratio);
  // 3 %: bone steps delay the faster drill by another 1.2 %.
  CHECK(std::abs(ratio - 2.0) < 0.06);
  CHECK(std::abs(plain.time / twice.time - 2.0) < 0.2);
}

}  // namespace
}  // namespace burrhole::test
