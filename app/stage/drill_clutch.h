/// app/stage/drill_clutch.h: what [clutch] states of the drill: whether the drive turns it, and how fast its inner and outer drill turn.
///   Units  SI.   Without [clutch] nothing writes these slots, and a bit turns as its spindle does.
#pragma once

#include <cstdint>

#include "app/stage/step_graph.h"
#include "core/drill/region_spin.h"

namespace burrhole {

struct DrillClutch {
  DrillRegions regions{};         ///< of the tool
  bool has_regions = false;       ///< false: a tool without inner and outer drill; it turns with its drive
  bool turns = false;             ///< a drill turns while the drive does: cutting points cut
  bool engaged = false;           ///< the drive turns the drills
  double inner = 0.0;             ///< [-] mean speed of the inner drill in this step, over that of the drive
  double outer = 0.0;             ///< [-] the same of the outer drill
  double coupled = 0.0;           ///< [-] share of this step in which the drive turned the drills
  std::uint64_t engagements = 0;  ///< since the start
  std::uint64_t releases = 0;     ///< since the start
};

/// Name of the recorded column that is 1 while the clutch is engaged.
inline constexpr const char* kEngagedColumn = "clutch_engaged";

/// Sums over all contact evaluations so far; their differences give means.
struct DrillThrust {
  double sum = 0.0;          ///< [N] of the force of bone on the tool along its shaft, where it presses
  std::uint64_t number = 0;  ///< evaluations
};

namespace slots {
inline const SlotKey<DrillClutch> kClutch{"clutch"};             ///< simulation clock; owned by [clutch]
inline const SlotKey<double> kDrillSpin{"drill_spin"};           ///< [rev/s] simulation clock; owned by [clutch]: of the outer drill
inline const SlotKey<DrillThrust> kDrillThrust{"drill_thrust"};  ///< contact clock; owned by [clutch]
}  // namespace slots

}  // namespace burrhole
