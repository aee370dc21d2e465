/// core/contact/drawn_shell.h: the cutting points of a shell, drawn in across the push of the tool, as the surface probe wants them.
///   Frame  tool frame.   Units  SI.   Thread  built once; contact draws. Never allocates after construction.
///   Source own derivation. Double precision, the same bits on every SIMD level as drawn_in() of each point.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/geometry.h"
#include "core/contact/contact_shell.h"

namespace burrhole {

/// Faces within 23 degrees of the push (by the square of the cosine) are not drawn in, those over 51 degrees off it wholly.
inline constexpr double kDrawnBelow = 0.85, kDrawnRise = 2.2;

/// Where a point is drawn to: along its inward normal, but not along `push` (unit), by up to `play` [m].
[[nodiscard]] inline Vec3 drawn_in(const Vec3& position, const Vec3& inward, const Vec3& push, double play) noexcept {
  const double along = glm::dot(inward, push), part = std::clamp((kDrawnBelow - along * along) * kDrawnRise, 0.0, 1.0);
  return position + (inward - push * along) * (play * part);
}

class DrawnShell {
 public:
  /// `part` says which points of `shell` and in which order; its places are about `middle` [m].
  DrawnShell(const PointShell& shell, const ContactShellPart& part, const Vec3& middle);
  /// Writes the places of `part`, padding too: the part that this was made of.
  void draw(const Vec3& push, double play, ContactShellPart& part) const noexcept;

 private:
  std::array<LineVector<double>, 3> position_, inward_;  // padded like the part
  Vec3 middle_;
};

}  // namespace burrhole
