/// tests/support/scene_hand.h: the script's hand of a scene, as a run makes it, for tests that change what it knows or look at it.
#pragma once

#include <functional>

#include "app/scene/load.h"
#include "haptics/hand/simulated_hand.h"

namespace burrhole::test {

/// A hand that cannot be made fails the test. @param change is applied to what the hand knows.
[[nodiscard]] SimulatedHand scene_hand(const LoadedScene& loaded, const std::function<void(HandConfig&)>& change = {});

}  // namespace burrhole::test
