/// app/stage/zone_state.h: how near the tip is to the zones of [zones].
///   Frame  world.   Units  SI.
#pragma once

#include "app/stage/step_graph.h"
#include "core/base/geometry.h"

namespace burrhole {

/// How near: also values of the column "zone_near" on the contact clock.
inline constexpr double kZoneClear = 0.0, kZoneNear = 1.0, kZoneInside = 2.0;

struct ZoneState {
  double distance = 0.0;  ///< [m] of the tip from the nearest zone, negative inside; at most the scene's reach
  Vec3 away{0.0};         ///< [-] unit, away from that zone; 0: not known, or beyond the reach
  double nearness = 0.0;  ///< [-] 0: no warning; above 0 at the distance of the warning, 1 at the zone and inside
  double level = 0.0;     ///< [-] kZoneClear, kZoneNear or kZoneInside
  double tone = 0.0;      ///< [-] amplitude of the warning's tone
};

inline constexpr const char* kZoneDistanceColumn = "zone_distance";
inline constexpr const char* kZoneLevelColumn = "zone_near";

namespace slots {
inline const SlotKey<ZoneState> kZone{"zone"};  ///< contact clock; owned by [zones]
}  // namespace slots

}  // namespace burrhole
