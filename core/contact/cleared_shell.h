/// core/contact/cleared_shell.h: the cutting points of a shell, moved inwards across the push of the tool by a clearance, for the surface
///   probe.
///   Frame  tool frame.   Units  SI.   Thread  built once, used by contact. Never allocates after construction.
///   Source own derivation. Double precision; gives the same bits as cleared() of each point on every SIMD level.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/geometry.h"
#include "core/contact/contact_shell.h"

namespace burrhole {

/// Faces within 23 degrees of the push are not moved, faces more than 51 degrees off it by the full clearance (limits on the squared
/// cosine).
inline constexpr double kClearedBelow = 0.85, kClearedRise = 2.2;

/// @returns the point moved along its inward normal without the component along `push` (unit), by up to `clearance` [m].
[[nodiscard]] inline Vec3 cleared(const Vec3& position, const Vec3& inward, const Vec3& push, double clearance) noexcept {
  const double along = glm::dot(inward, push), part = std::clamp((kClearedBelow - along * along) * kClearedRise, 0.0, 1.0);
  return position + (inward - push * along) * (clearance * part);
}

class ClearedShell {
 public:
  /// `part` gives the points of `shell` and their order; its positions are relative to `middle` [m].
  ClearedShell(const PointShell& shell, const ContactShellPart& part, const Vec3& middle);
  /// Writes the positions of `part`, with padding. `part` must be the one passed to the constructor.
  void draw(const Vec3& push, double clearance, ContactShellPart& part) const noexcept;

 private:
  std::array<LineVector<double>, 3> position_, inward_;  // padded like the part
  Vec3 middle_;
};

}  // namespace burrhole
