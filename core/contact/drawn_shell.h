/// core/contact/drawn_shell.h: the cutting points of a shell, moved inwards across the push of the tool by a clearance, for the surface
///   probe.
///   Frame  tool frame.   Units  SI.   Thread  built once, used by contact. Never allocates after construction.
///   Source own derivation. Double precision; gives the same bits as drawn_in() of each point on every SIMD level.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/geometry.h"
#include "core/contact/contact_shell.h"

namespace burrhole {

/// Faces within 23 degrees of the push are not moved, faces more than 51 degrees off it by the full clearance (limits on the squared
/// cosine).
inline constexpr double kDrawnBelow = 0.85, kDrawnRise = 2.2;

/// @returns the point moved along its inward normal without the component along `push` (unit), by up to `play` [m].
[[nodiscard]] inline Vec3 drawn_in(const Vec3& position, const Vec3& inward, const Vec3& push, double play) noexcept {
  const double along = glm::dot(inward, push), part = std::clamp((kDrawnBelow - along * along) * kDrawnRise, 0.0, 1.0);
  return position + (inward - push * along) * (play * part);
}

class DrawnShell {
 public:
  /// `part` gives the points of `shell` and their order; its positions are relative to `middle` [m].
  DrawnShell(const PointShell& shell, const ContactShellPart& part, const Vec3& middle);
  /// Writes the positions of `part`, with padding. `part` must be the one passed to the constructor.
  void draw(const Vec3& push, double play, ContactShellPart& part) const noexcept;

 private:
  std::array<LineVector<double>, 3> position_, inward_;  // padded like the part
  Vec3 middle_;
};

}  // namespace burrhole
