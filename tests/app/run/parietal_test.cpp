// The shipped scene from end to end, drilled once and replayed once: what the trainee would be told, against what is known of bone and bit.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/session/recorded_hand.h"
#include "core/contact/constrained_tool.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"
#include "volumes/phantom/truth.h"

namespace burrhole::test {
namespace {

constexpr double kVoxel = 0.25e-3;  // [m] of the shipped scene

/// Diameter [m] of the circle with the area that is gone from bone on a plane across the axis at `depth` [m].
double diameter_at(Simulation& simulation, double depth) {
  constexpr double kStep = 0.1e-3, kReach = 9e-3;
  Voxmap& voxmap = simulation.voxmap();
  const VoxelBox bounds = voxmap.bone().bounds();
  std::vector<float> left(bounds.count());
  voxmap.read_density(bounds, left);
  std::vector<float> loaded(bounds.count());
  voxmap.bone().read_occupancy(bounds, loaded);
  const Affine index_from_approach =
      voxmap.bone().bone_from_index().inverse() * Affine::from_pose(simulation.approach().bone_from_approach);
  int gone = 0;
  for (double y = -kReach; y < kReach; y += kStep)
    for (double x = -kReach; x < kReach; x += kStep) {
      const Vec3i v = voxel_of(index_from_approach * Vec3(x, y, -depth));
      if (!bounds.contains(v)) continue;
      const std::size_t at = bounds.offset_of(v);
      if (loaded[at] >= kSurfaceLevel && left[at] < kSurfaceLevel) ++gone;
    }
  return 2.0 * std::sqrt(gone * kStep * kStep / std::numbers::pi);
}

void check_breakthrough(DrillRun& run) {
  const DrillProgress& p = run.simulation().progress();
  REQUIRE(p.breakthrough_time.has_value());
  const Vec3 entry = run.loaded().scene.approach.entry, axis = run.loaded().scene.approach.axis;
  const double thickness = Truth(*run.loaded().scene.volume.phantom).thickness_along(entry - axis * 5e-3, axis);
  const double advance = p.deepest - *p.breakthrough_depth;
  MESSAGE("breakthrough after " << *p.breakthrough_time << " s at " << *p.breakthrough_depth * 1e3 << " mm of " << thickness * 1e3
                                << " mm by closed form, " << p.removed_at_passing << " of the axis removed; advance " << advance * 1e3
                                << " mm; furthest ahead of front and engagement " << p.largest_ahead / run.voxel() << " voxels; peak force "
                                << p.peak_force << " N");
  CHECK(std::abs(run.simulation().approach().thickness - thickness) < 0.02e-3);
  // The last engaged layer, 28 N over 140 kN/m = 0.2 mm, is inside the bit when the tip leaves; with a voxel of rounding 0.45 mm.
  CHECK(std::abs(*p.breakthrough_depth - thickness) < 0.45e-3);
  CHECK(p.removed_at_passing >= 1.0 - (0.2e-3 + 0.5 * run.voxel()) / thickness);
  CHECK(p.largest_ahead <= run.voxel());
  // A hand of 150 ms reaction goes on a little; the shoulder of the outer drill, 3 mm up, ends it.
  CHECK(advance > 0.3e-3);
  CHECK(advance < 3.0e-3);
  // Nearly all of that is cut at full thrust.
  REQUIRE(p.loss.has_value());
  CHECK(p.loss->time > *p.breakthrough_time + 1.0);
  CHECK(p.loss->plunge < 0.1e-3);
  // The thrust is what the bone must carry; a shoulder that lands on the ledge may add a quarter.
  CHECK(p.peak_force > 28.0 * 0.95);
  CHECK(p.peak_force < 28.0 * 1.25);
}

void check_hole(DrillRun& run) {
  Simulation& simulation = run.simulation();
  const HoleMeasure hole = measure_hole(simulation.voxmap(), simulation.approach());
  REQUIRE(hole.outer_diameter.has_value());
  REQUIRE(hole.inner_diameter.has_value());
  // Two voxels: each wall may lie a voxel off, by rounding of the bit's edge and by tremor.
  CHECK(std::abs(*hole.outer_diameter - 14e-3) < 0.5e-3);
  CHECK(std::abs(*hole.inner_diameter - 11e-3) < 0.5e-3);
  // The ledge lies where the shoulder of the outer drill stood at the deepest, 3 mm above the tip.
  const double ledge = simulation.progress().deepest - 3e-3;
  const double above = diameter_at(simulation, ledge - 0.75e-3), below = diameter_at(simulation, ledge + 0.75e-3);
  MESSAGE("hole " << *hole.outer_diameter * 1e3 << " mm outside, " << *hole.inner_diameter * 1e3 << " mm inside; ledge at " << ledge * 1e3
                  << " mm: " << above * 1e3 << " mm wide above, " << below * 1e3 << " mm below; removed " << hole.removed * 1e9
                  << " mm3 of volume, " << simulation.bone_step().removed_mass() * 1e9 << " mm3 of mass");
  CHECK(std::abs(above - 14e-3) < 0.5e-3);
  CHECK(std::abs(below - 11e-3) < 0.5e-3);
  // 14 mm down to the ledge and 11 mm below it: 3 % for walls half a voxel off and the sag of 0.3 mm of the outer surface at the rim.
  const double expected = std::numbers::pi * (49e-6 * ledge + 30.25e-6 * (simulation.approach().thickness - ledge));
  CHECK(std::abs(hole.removed / expected - 1.0) < 0.03);
}

struct Sway {
  double touching_down = 0.0, in_bore = 0.0;  ///< [m] farthest off the axis, until a millimetre in and after it
};

Sway sway_of(const std::string& session) {
  Sway out;
  const std::vector<double> x = session_column(session, "tool_x"), y = session_column(session, "tool_y"),
                            z = session_column(session, "tool_z");
  std::size_t n = 0;
  for (; n < x.size() && z[n] > -1e-3; ++n) out.touching_down = std::max(out.touching_down, std::hypot(x[n], y[n]));
  const auto deepest = static_cast<std::size_t>(std::ranges::min_element(z) - z.begin());
  for (; n < deepest; ++n) out.in_bore = std::max(out.in_bore, std::hypot(x[n], y[n]));
  return out;
}

/// [m] The most that the bit may sway until it is a millimetre in. Bone is felt in steps of a voxel, so the floor of the first dent may lie a voxel
/// higher on one side of the flat end (diameter D) and a voxel lower on the other: the thrust F leans aside by F 2 s / D. Against it stand
/// the engaged flanks, K_cut d / D at d = F / K_cut (flank_friction.h, R = D / 2), and the arm through the coupling. The tremor moves the rest of
/// the arm's spring k: the mass answers by k a / |k + k_bone - m w^2 + i b w|.
double most_sway(const Scene& scene) {
  constexpr double kInnerDrill = 11e-3;  // [m]
  const ConstrainedToolConfig& contact = *scene.find<ConstrainedToolConfig>();
  const MassSpringDamperConfig& arm = scene.hand.dynamics;
  const double thrust = scene.hand.push, engaged = thrust / contact.cutting_stiffness;
  const double flanks = contact.cutting_stiffness * engaged / kInnerDrill;
  const double hand = arm.stiffness * contact.coupling_stiffness / (arm.stiffness + contact.coupling_stiffness);
  const double w = 2.0 * std::numbers::pi * scene.hand.tremor_frequency;
  const double swing = arm.stiffness * scene.hand.tremor_amplitude / std::hypot(arm.stiffness + flanks - arm.mass * w * w, arm.damping * w);
  return thrust * 2.0 * kVoxel / kInnerDrill / (flanks + hand) + swing;
}

// Once its flanks stand in the bore the wall is what lets it sway, and that is true to a voxel.
constexpr double kMostInBore = kVoxel;

void check_sway(const std::string& session, double most) {
  const Sway sway = sway_of(session);
  MESSAGE("bit at most " << sway.touching_down * 1e3 << " mm off the axis before it is a millimetre in, " << sway.in_bore * 1e3
                         << " mm after; " << most * 1e3 << " allowed before");
  CHECK(sway.touching_down < most);
  CHECK(sway.in_bore < kMostInBore);
}

TEST_CASE("parietal: the shipped scene breaks through, leaves a ledged 14/11 mm hole and replays to the bit") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  DrillRun run(load_parietal({}));
  run_recorded(run, path);
  CHECK(run.simulation().end() == RunEnd::done);
  CHECK(figure(run.simulation(), "erosion", "points_outside") == 0.0);
  check_breakthrough(run);
  check_hole(run);
  check_sway(path, most_sway(run.loaded().scene));

  const auto session = SessionReader::open(path);
  REQUIRE(session);
  auto hand = RecordedHand::create(*session);
  REQUIRE(hand);
  SimulationOptions options;
  options.hand = &*hand;
  LoadedScene loaded = load_parietal({});
  loaded.scene.duration = static_cast<double>(hand->ticks()) / loaded.scene.servo_hz;
  DrillRun again(std::move(loaded), options);
  again.run();
  CHECK(again.voxel_hash() == run.voxel_hash());
  CHECK(again.simulation().force_hash() == run.simulation().force_hash());
}

TEST_CASE("parietal: with the contact of the mesh too, the shipped scene breaks through and leaves a ledged 14/11 mm hole") {
  DrillRun run(load_parietal({"contact.model=mesh"}));
  run.run();
  CHECK(run.simulation().end() == RunEnd::done);
  CHECK(run.simulation().contact_flags() == 0);
  CHECK(figure(run.simulation(), "erosion", "points_outside") == 0.0);
  check_breakthrough(run);
  check_hole(run);
}

TEST_CASE("parietal: the perforator at rest under 40 N does not pass an inner table of 1.7 mm") {
  LoadedScene loaded = load_text(scene_text({.volume = kInnerTableKeys}), {"tool.name=perforator_14_11", "volume.extent_mm=[20,20,6]",
                                                                           "tool.spin_rpm=0", "hand.push_N=40", "duration_s=3"});
  DrillRun run(std::move(loaded));
  const std::uint64_t untouched = run.voxel_hash();
  const DrillProgress& p = run.run().simulation().progress();
  MESSAGE("tip at most " << p.deepest / run.voxel() << " voxels past the surface");
  CHECK(p.deepest / run.voxel() < 0.1);
  CHECK(run.voxel_hash() == untouched);
}

}  // namespace
}  // namespace burrhole::test
