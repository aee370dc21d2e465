// The model `surface` in the outer table of a real head's CT: where it shows a spike of force, a plain twin shows it too.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/engine/contact_step.h"
#include "tests/app/engine/surface_twin.h"
#include "tests/support/drill_scene.h"
#include "tests/support/real_data.h"

namespace burrhole::test {
namespace {

constexpr double kOuterTable = 2.4e-3;  ///< [m] median thickness of the outer table
constexpr int kEvery = 50;              ///< ticks between two that the twin looks at in any case

struct Look {
  int tick = 0;
  double force = 0.0, twin = 0.0;  ///< [N]
};

struct Drilled {
  std::vector<double> forces;  ///< [N] of each tick, from first contact on
  std::vector<Look> looks;     ///< of ticks that might be spikes, and every so many
  double depth = 0.0;          ///< [m]
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

/// Spikes above twice the median that the twin does not show.
int lone_spikes(const Drilled& drilled) {
  const double level = 2.0 * median(drilled.forces);
  int count = 0;
  for (const Look& look : drilled.looks) count += look.force > level && look.twin < 0.9 * look.force ? 1 : 0;
  return count;
}

/// Vector sum over the planes that are cut, over K_cut: the engagement, bone frame.
Vec3 engaged_of(const ConstrainedTool& tool, const ConstrainedToolConfig& config) {
  Vec3 sum(0.0);
  for (const HoldPlane& plane : tool.planes())
    if (plane.cutting) sum += plane.normal * plane.force;
  return sum * ((1.0 - 0.05) / config.cutting_stiffness);
}

/// Hand, contact and bone in lockstep as a run has them, until the tip is `deep` under the outer surface.
Drilled drill(LoadedScene& loaded, double deep, double longest) {
  const Scene& scene = loaded.scene;
  const auto approach = make_approach(*loaded.bone, scene.approach);
  REQUIRE(approach);
  const Pose world_from_approach = scene.volume.world_from_bone * approach->bone_from_approach;
  const double period = 1.0 / scene.servo_hz;
  auto hand = SimulatedHand::create(scene.hand, world_from_approach, period);
  REQUIRE(hand);
  const Pose start{world_from_approach.rotation, world_from_approach * Vec3(0.0, 0.0, scene.hand.standoff)};
  auto made = Voxmap::create(loaded.bone, {});
  REQUIRE(made);
  Voxmap voxmap = std::move(*made);
  auto bone = BoneStep::create(scene, loaded.tool, voxmap, start);
  REQUIRE(bone);
  auto tool = ConstrainedTool::create(scene.contact->surface, loaded.tool.shell, loaded.bone->bone_from_index().mean_edge());
  REQUIRE(tool);
  tool->place(start);

  Drilled out;
  const int bone_every = scene.servo_hz / scene.erosion->rate_hz;
  Vec3 felt(0.0);
  Quat hand_before = start.rotation;
  for (int tick = 0; tick < static_cast<int>(longest / period) && out.depth < deep; ++tick) {
    const HandState& now = hand->step(felt);
    const HandMotion motion{now.world_from_hand, now.velocity, true};
    const ContactBone window{&bone->publisher().exchange(), nullptr, loaded.bone->bone_from_index(), scene.volume.world_from_bone};
    const SurfaceView view = *window.view().surface;
    const TwinStart before{view.world_from_bone.inverse() * tool->state().world_from_tool, engaged_of(*tool, scene.contact->surface),
                           hand_before};
    const ConstrainedToolState& state = tool->step(view, motion, period);
    hand_before = motion.world_from_hand.rotation;
    felt = state.on_hand.force;
    const double force = glm::length(felt);
    if (!out.forces.empty() || force > 1.0) out.forces.push_back(force);
    // The push is the script's: what exceeds one and a half of it may turn out to be a spike.
    if (force > 1.0 && (force > 1.5 * scene.hand.push || tick % kEvery == 0))
      out.looks.push_back(
          {tick, force, glm::length(feel_plainly(scene.contact->surface, loaded.tool.shell, view, before, motion, period).force)});
    if (tick % bone_every == bone_every - 1) (*bone)(state.world_from_tool, state.cutting_force, bone_every * period);
    out.depth = -(world_from_approach.inverse() * state.world_from_tool.translation).z;
  }
  return out;
}

TEST_CASE("surface on a real head: no spike of force in the outer table that a plain twin does not show") {
  (void)real_data("head_ct_dicom_phantom_1mm");
  auto document = TomlDocument::load(BH_SOURCE_DIR "/app/scenes/head_phantom.toml");
  REQUIRE(document);
  Issues issues;
  auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  Drilled drilled = drill(*loaded, kOuterTable, 20.0);
  REQUIRE(drilled.depth >= kOuterTable);
  REQUIRE(drilled.forces.size() > 500);
  const double level = median(drilled.forces);
  const double most = *std::max_element(drilled.forces.begin(), drilled.forces.end());
  std::vector<double> apart;
  for (const Look& look : drilled.looks) apart.push_back(std::abs(look.force - look.twin) / level);
  std::printf(
      "outer table of the head: %zu ticks, force median %.2f N, largest %.2f N; twin at %zu ticks, apart by %.3f of the median force "
      "(median), %.3f (largest)\n",
      drilled.forces.size(), level, most, drilled.looks.size(), median(apart), *std::max_element(apart.begin(), apart.end()));
  CHECK(drilled.looks.size() > 20);
  CHECK(lone_spikes(drilled) == 0);
  // Each solves to its own tolerance, 0.05 and 0.01 voxel of a last move; 5 N/mm and 10 N/mm of damping make 0.2 N of that, 0.7 % of 28 N.
  CHECK(*std::max_element(apart.begin(), apart.end()) < 0.01);
  // Sabotage: a spike that is only the product's is told.
  drilled.looks[drilled.looks.size() / 2].force = 2.5 * level;
  CHECK(lone_spikes(drilled) == 1);
}

}  // namespace
}  // namespace burrhole::test
