/// core/base/physics_version.h: raised with every change of the simulation that changes voxels or forces of a run.
#pragma once

#include <cstdint>

namespace burrhole {

/// Sessions name it: equal versions give equal hashes of the same inputs.
inline constexpr std::int64_t kPhysicsVersion = 12;

}  // namespace burrhole
