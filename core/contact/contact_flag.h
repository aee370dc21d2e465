/// core/contact/contact_flag.h: conditions that a contact step reports with its result.
#pragma once

#include <cstdint>

namespace burrhole {

/// Bits of ContactState::flags, ContactResult::flags and the states of the models. The run continues; the caller prints a warning at its
/// end.
enum ContactFlag : std::uint32_t {
  kContactOutsideWindow = 1u << 0,  ///< a shell point was outside the known part of the window
  kContactNoSurface = 1u << 1,      ///< a march reached its bound without finding a surface; the point has no force
  kContactZeroGradient = 1u << 2,   ///< a surface voxel has no gradient; the tool vector replaced it
  kContactNotFinite = 1u << 3,      ///< the pose was not finite; the result is zero
  kContactUnsettled = 1u << 4,      ///< the constrained tool reached its bound on moves or planes before it converged
};

}  // namespace burrhole
