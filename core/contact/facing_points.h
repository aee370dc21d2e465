/// core/contact/facing_points.h: selects the points of a tool whose faces point along a direction, so that only these are probed.
///   Frame  tool.   Units  SI.   Thread  built once, used by contact. Never allocates after construction.
///   Source own derivation. Single precision; the same bits on every SIMD level.
#pragma once

#include <array>

#include "core/contact/contact_shell.h"

namespace burrhole {

class FacingPoints {
 public:
  /// `part` gives the points of `shell` and their order.
  FacingPoints(const PointShell& shell, const ContactShellPart& part);
  /// @param part the one passed to the constructor; its positions may have changed. @param push unit.
  /// @returns the points of `part`, in its order, whose inward normals have a component of at least `least` along `push`. Some points with
  /// up to 1e-5 less are included.
  [[nodiscard]] const ContactShellPart& pick(const ContactShellPart& part, const Vec3& push, double least) noexcept;

 private:
  std::array<LineVector<float>, 3> inward_;  // padded like the part
  LineVector<std::uint32_t> point_;          // padded like the part
  ContactShellPart facing_;
};

}  // namespace burrhole
