/// core/contact/facing_points.h: of the points of a tool, those whose faces meet a direction: only they need be asked how bone holds them.
///   Frame  tool.   Units  SI.   Thread  built once; contact picks. Never allocates after construction.
///   Source own derivation. Single precision, the same bits on every SIMD level.
#pragma once

#include <array>

#include "core/contact/contact_shell.h"

namespace burrhole {

class FacingPoints {
 public:
  /// `part` says which points of `shell` and in which order.
  FacingPoints(const PointShell& shell, const ContactShellPart& part);
  /// @param part the one that this was made of, wherever its points are now. @param push unit.
  /// @returns its points, in its order, whose inward normals have `least` and more along `push`; some that have up to 1e-5 less are among
  /// them.
  [[nodiscard]] const ContactShellPart& pick(const ContactShellPart& part, const Vec3& push, double least) noexcept;

 private:
  std::array<LineVector<float>, 3> inward_;  // padded like the part
  LineVector<std::uint32_t> point_;          // likewise
  ContactShellPart facing_;
};

}  // namespace burrhole
