/// haptics/servo/tool_trail.h: the places of the servo's tool in the last ticks. A result of contact belongs to a tick of the past; compared
///   with the place of that tick it says by how much the servo's tool has drifted from the tool of contact.
///   Friction has more than one equilibrium, so two tools that follow the same hand part for good unless one follows the other. The tool of
///   contact sees all of bone, the servo's tool only the listed planes.
///   Frame  world.   Units SI.   Thread servo; resize() allocates.
///   Source  own work: an observer whose correction is the whole error at the tick of the measurement.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/assert.h"
#include "core/base/rotation.h"
#include "core/contact/contact_state.h"
#include "core/contact/tangential_law.h"

namespace burrhole {

class ToolTrail {
 public:
  /// Remembers the last `ticks` >= 1 places, and forgets those so far. Not in a tick: allocates.
  void resize(std::size_t ticks) { places_.assign(ticks, {}); }
  void clear() noexcept BH_REALTIME { std::ranges::fill(places_, Place{}); }
  void add(std::uint64_t tick, const Pose& world_from_tool) noexcept BH_REALTIME {
    places_[tick % places_.size()] = {tick, true, world_from_tool};
  }
  /// @returns the move from the place of the tick `state.tick` to the tool of the state; nothing if that tick is not remembered.
  [[nodiscard]] std::optional<SmallMove> drift(const ContactState& state) const noexcept BH_REALTIME {
    const Place& then = places_[state.tick % places_.size()];
    if (!then.known || then.tick != state.tick) return std::nullopt;
    return SmallMove{state.world_from_tool.translation - then.world_from_tool.translation,
                     rotation_vector(state.world_from_tool.rotation * glm::conjugate(then.world_from_tool.rotation))};
  }
  /// Moves the places from the tick `since` on.
  void shift(std::uint64_t since, const SmallMove& by) noexcept BH_REALTIME {
    for (Place& place : places_)
      if (place.known && place.tick >= since) place.world_from_tool = moved(place.world_from_tool, by);
  }
  [[nodiscard]] static Pose moved(const Pose& pose, const SmallMove& by) noexcept {
    return {glm::normalize(rotation_of(by.turn) * pose.rotation), pose.translation + by.translation};
  }

 private:
  struct Place {
    std::uint64_t tick = 0;
    bool known = false;
    Pose world_from_tool;
  };
  std::vector<Place> places_{1};
};

}  // namespace burrhole
