#include "tests/support/scene_hand.h"

#include <doctest/doctest.h>

#include "app/stage/stage.h"
#include "core/measure/approach.h"

namespace burrhole::test {

SimulatedHand scene_hand(const LoadedScene& loaded, const std::function<void(HandConfig&)>& change) {
  const Scene& scene = loaded.scene;
  const auto approach = make_approach(*loaded.bone, scene.approach);
  REQUIRE(approach);
  HandConfig config = hand_config(scene, scene.effects.needs(scene), loaded.tool, loaded.bone->bone_from_index().mean_edge());
  if (change) change(config);
  auto hand = SimulatedHand::create(config, scene.volume.world_from_bone * approach->bone_from_approach, 1.0 / scene.servo_hz);
  REQUIRE(hand);
  return std::move(*hand);
}

}  // namespace burrhole::test
