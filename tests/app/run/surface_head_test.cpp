// The model `surface` in the outer table of a real head's CT: where it shows a spike of force, a plain twin shows it too.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/stage/stage.h"
#include "core/contact/constrained_tool.h"
#include "tests/app/run/surface_twin.h"
#include "tests/support/drill_scene.h"
#include "tests/support/real_data.h"
#include "tests/support/source_folder.h"

namespace burrhole::test {
namespace {

constexpr double kOuterTable = 2.4e-3;  ///< [m] median thickness of the outer table
constexpr double kLame = 0.3e-3;        ///< [m] by which a hand is too deep (sabotage): 1.5 N of the coupling
constexpr int kEvery = 50;              ///< ticks between two that the twin looks at in any case

constexpr int kStretch = 50;  ///< ticks that a twin goes on its own
constexpr int kStretchEvery =
    700;  ///< ticks from one such stretch to the next: another part of the servo's and the bone's periods each time

struct Look {
  int tick = 0;
  double force = 0.0, twin = 0.0;  ///< [N]
};

/// A twin that starts as the product is and then keeps its own pose and engagement: given only the bone and the hand.
struct FreeTwin {
  Vec3 hand_off{0.0};  ///< [m] world: by which its hand is wrong (sabotage)
  TwinStart state;
  int left = 0;                                  ///< ticks to go
  int ticks = 0;                                 ///< gone, all stretches
  double force_apart = 0.0;                      ///< [N] largest difference of the forces' lengths
  double along_apart = 0.0, across_apart = 0.0;  ///< [m] of the tool origins, along the product's force and across it

  void step(const ConstrainedToolConfig& config, const PointShell& shell, const SurfaceView& bone, HandMotion hand, double dt,
            const ConstrainedToolState& product) {
    if (left == 0) return;
    hand.world_from_hand.translation += hand_off;
    const TwinForce felt = feel_plainly(config, shell, bone, state, hand, dt, true);
    state = felt.after;
    const Vec3 place = bone.world_from_bone * state.bone_from_tool.translation;
    force_apart = std::max(force_apart, std::abs(glm::length(felt.force) - glm::length(product.on_hand.force)));
    const Vec3 apart = place - product.world_from_tool.translation, push = glm::normalize(product.on_hand.force);
    along_apart = std::max(along_apart, std::abs(glm::dot(apart, push)));
    across_apart = std::max(across_apart, glm::length(apart - push * glm::dot(apart, push)));
    --left;
    ++ticks;
  }
};

struct Drilled {
  std::vector<double> forces;  ///< [N] of each tick, from first contact on
  std::vector<Look> looks;     ///< of ticks that might be spikes, and every so many
  FreeTwin free, lame;
  double depth = 0.0;  ///< [m]
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

/// [m] bone frame: as long as published, along the sum of the planes that are cut.
Vec3 engaged_of(const ConstrainedTool& tool) {
  Vec3 sum(0.0);
  for (const HoldPlane& plane : tool.planes())
    if (plane.cutting) sum += plane.normal * plane.force;
  const double length = glm::length(sum);
  return length > 0.0 ? sum * (tool.state().engagement / length) : sum;
}

/// Hand, contact and bone in lockstep as a run has them, until the tip is `deep` under the outer surface.
Drilled drill(LoadedScene& loaded, double deep, double longest) {
  const Scene& scene = loaded.scene;
  const auto approach = make_approach(*loaded.bone, scene.approach);
  REQUIRE(approach);
  const Pose world_from_approach = scene.volume.world_from_bone * approach->bone_from_approach;
  const double period = 1.0 / scene.servo_hz;
  auto hand = SimulatedHand::create(hand_config(scene, scene.effects.needs(scene), loaded.tool, loaded.bone->bone_from_index().mean_edge()),
                                    world_from_approach, period);
  REQUIRE(hand);
  const Pose start{world_from_approach.rotation, world_from_approach * Vec3(0.0, 0.0, scene.hand.standoff)};
  auto stage = Stage::make(scene, scene.effects, loaded.bone, loaded.tool, {});
  REQUIRE(stage);
  BoneStep& bone = *(*stage)->bone;
  ContactState found;
  auto tool = ConstrainedTool::create(*scene.find<ConstrainedToolConfig>(), loaded.tool.shell, loaded.bone->bone_from_index().mean_edge());
  REQUIRE(tool);
  tool->place(start);

  Drilled out;
  out.lame.hand_off = world_from_approach.rotate(Vec3(0.0, 0.0, -kLame));
  const int bone_every = scene.servo_hz / scene.effects.needs(scene).simulation_hz;
  Vec3 felt(0.0);
  Quat hand_before = start.rotation;
  for (int tick = 0; tick < static_cast<int>(longest / period) && out.depth < deep; ++tick) {
    hand->apply({felt, Vec3(0.0)});
    const HandState& now = hand->read();
    const HandMotion& motion = now;
    const ContactBone window{&bone.publisher()->exchange(), nullptr, nullptr, loaded.bone->bone_from_index(), scene.volume.world_from_bone};
    const SurfaceView view = *window.view().surface;
    const TwinStart before{view.world_from_bone.inverse() * tool->state().world_from_tool, engaged_of(*tool),
                           view.world_from_bone.inverse().rotate(tool->state().aside), hand_before};
    const ConstrainedToolState& state = tool->step(view, motion, period, {.spinning = true});
    hand_before = motion.world_from_hand.rotation;
    felt = state.on_hand.force;
    const double force = glm::length(felt);
    if (!out.forces.empty() || force > 1.0) out.forces.push_back(force);
    // The push is the script's: what exceeds one and a half of it may turn out to be a spike.
    if (force > 1.0 && (force > 1.5 * scene.hand.push || tick % kEvery == 0))
      out.looks.push_back(
          {tick, force,
           glm::length(feel_plainly(*scene.find<ConstrainedToolConfig>(), loaded.tool.shell, view, before, motion, period, true).force)});
    for (FreeTwin* twin : {&out.free, &out.lame}) {
      if (twin->left == 0 && force > 1.0 && tick % kStretchEvery == 0) {
        twin->state = before;
        twin->left = twin == &out.free || twin->ticks == 0 ? kStretch : 0;  // one lame stretch is enough
      }
      twin->step(*scene.find<ConstrainedToolConfig>(), loaded.tool.shell, view, motion, period, state);
    }
    // All that a bone step reads: with the hand it foresees where the window must be.
    found.world_from_tool = state.world_from_tool;
    found.on_hand = state.on_hand;
    found.world_from_hand = motion.world_from_hand;
    found.hand_velocity = motion.velocity;
    if (tick % bone_every == bone_every - 1) bone(found, state.cutting_force, bone_every * period);
    out.depth = -(world_from_approach.inverse() * state.world_from_tool.translation).z;
  }
  return out;
}

TEST_CASE("surface on a real head: no spike of force in the outer table that a plain twin does not show") {
  (void)real_data("head_ct_dicom_phantom_1mm");
  auto document = TomlDocument::load(test::in_source("app/scenes/head_phantom.toml"));
  REQUIRE(document);
  // Tool and twin know no cutting field here and have the clearance of whole voxels, which needs an engaged depth above a voxel.
  REQUIRE(document->set("contact.cutting_N_per_m=70e3"));
  REQUIRE(document->set("tool.erosion_scale=0.5"));
  Issues issues;
  auto loaded = load_scene(*document, test_context(), issues);
  REQUIRE_MESSAGE(loaded.has_value(), (issues.empty() ? "" : issues.front().text()));
  Drilled drilled = drill(*loaded, kOuterTable, 20.0);
  REQUIRE(drilled.depth >= kOuterTable);
  REQUIRE(drilled.forces.size() > 500);
  const double level = median(drilled.forces);
  REQUIRE(1.5 * loaded->scene.hand.push <= 2.0 * level);  // so the twin looked at each tick that lone_spikes() may count
  const double most = *std::max_element(drilled.forces.begin(), drilled.forces.end());
  std::vector<double> apart;
  for (const Look& look : drilled.looks) apart.push_back(std::abs(look.force - look.twin) / level);
  std::printf(
      "outer table of the head: %zu ticks, force median %.2f N, largest %.2f N; twin at %zu ticks, apart by %.3f of the median force "
      "(median), %.3f (largest)\n",
      drilled.forces.size(), level, most, drilled.looks.size(), median(apart), *std::max_element(apart.begin(), apart.end()));
  CHECK(drilled.looks.size() > 20);
  CHECK(lone_spikes(drilled) == 0);
  // Each solves to its own tolerance, 0.05 and 0.003 voxel of a last move; 5 N/mm and 10 N/mm of damping make 0.2 N of that, 0.7 % of 28 N.
  // Nothing is left for the constants, of which each has its own: where they matter this fails.
  CHECK(*std::max_element(apart.begin(), apart.end()) < 0.01);
  // On its own for a stretch, the twin's differences do not add up: of where the tool was, a period remembers the damper's share, two
  // thirds, so what one look may be off by (above; 0.05 and 0.003 voxel) sums to three times that however long the stretch is. Across the
  // push bone that is cut pushes nothing back, so there the coupling alone holds the tool, to what a hundredth of the force moves it by.
  const ConstrainedToolConfig& config = *loaded->scene.find<ConstrainedToolConfig>();
  const double damper = config.coupling_damping * loaded->scene.servo_hz,
               forgets = config.coupling_stiffness / (config.coupling_stiffness + damper);
  const double edge = loaded->bone->bone_from_index().mean_edge();
  std::printf(
      "on its own for %d ticks: forces apart by %.3f of the median force, places by %.3f voxel along it, %.3f across; hand 0.3 mm too "
      "deep: "
      "%.3f, %.3f, %.3f\n",
      drilled.free.ticks, drilled.free.force_apart / level, drilled.free.along_apart / edge, drilled.free.across_apart / edge,
      drilled.lame.force_apart / level, drilled.lame.along_apart / edge, drilled.lame.across_apart / edge);
  CHECK(drilled.free.ticks >= 3 * kStretch);
  const auto follows = [&](const FreeTwin& twin) {
    return twin.force_apart < 0.01 / forgets * level && twin.along_apart < (0.05 + 0.003) / forgets * edge &&
           twin.across_apart < 0.01 * level / config.coupling_stiffness + (0.05 + 0.003) * edge;
  };
  CHECK(follows(drilled.free));
  CHECK(drilled.lame.ticks == kStretch);
  CHECK_FALSE(follows(drilled.lame));
  // Sabotage: a spike that is only the product's is told.
  drilled.looks[drilled.looks.size() / 2].force = 2.5 * level;
  CHECK(lone_spikes(drilled) == 1);
}

}  // namespace
}  // namespace burrhole::test
