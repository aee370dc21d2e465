/// core/contact/contact_flag.h: conditions that a contact step reports with its result.
#pragma once

#include <cstdint>

namespace burrhole {

/// Bits of ContactState::flags, ContactResult::flags and the state of each contact model. The run continues; a warning is printed when it ends.
enum ContactFlag : std::uint32_t {
  kContactOutsideWindow =
      1u << 0,                  ///< bone that may be near has not been read: the tool is held where it was. A PenaltyModel sets it for any
                                ///< point outside the window; such a point has no force
  kContactNoSurface = 1u << 1,  ///< the search from a shell point reached its largest distance without a surface; no force
  kContactZeroGradient = 1u << 2,  ///< the density gradient is zero at the surface found; the point's inward normal was used instead
  kContactNotFinite = 1u << 3,     ///< the pose was not finite; the force is zero
  kContactUnsettled = 1u << 4,     ///< the solver of the constrained tool reached its limit of moves or planes before it converged
};

}  // namespace burrhole
