/// tests/core/contact/voxmap_twin.h: the original voxmap point-shell as [AcostaLiu07] section 2 tells it, slow and plain; shares no code
/// with core.   Frame  world.   Units  SI.
#pragma once

#include "paper_twin.h"

namespace burrhole::contact_test {

enum class TwinStack { added, tenth_limited, mean, petersik };

struct VoxmapTwinLaw {
  double stiffness = 2000.0;
  TwinStack stack = TwinStack::added;
  bool walk_to_surface = false;       ///< plane in the last filled voxel along the tool vector, not in the point's own
  bool any_density_collides = false;  ///< otherwise at least 0.5
  int longest_march = 64;
  double plane_offset = 0.0;  ///< [voxel] sabotage: plane this far out of the voxel's centre along the tool vector
};

struct VoxmapTwinAnswer {
  Triple force{}, torque{};
  std::vector<double> depths;  ///< of the colliding points that found a plane, in order
  int lost = 0;                ///< points whose walk met the limit
};

/// Torque about `origin`.
VoxmapTwinAnswer voxmap_twin_force(const TwinBone& bone, const VoxmapTwinLaw& law, const std::vector<TwinPoint>& points,
                                   const Triple& origin);

}  // namespace burrhole::contact_test
