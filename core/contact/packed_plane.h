/// core/contact/packed_plane.h: gradient_plane by vectors over the packed words of the contact window.
///   The law is that of gradient_plane.h with these figures of its own:
///   Place     in the window, 1/16384 voxel as whole numbers, so that leaping and stepping meet the same voxels exactly. A step along the
///             tool vector or the gradient is rounded to the same, at most one voxel on each axis.
///   Density   of 1/255, gradient of 1/254 (contact_words.h); the 0.5 surface is where the trilinear density, in float, meets 127.5.
///   Plane     normal and way to it in float (1e-7 of its length); sums and what goes out in double. Positions are those on the 1/16384
///   grid. Sums      sixteen, the n-th touching point of the sorted shell in sum n % 16, added by halves at the end: the same bits on all
///   SIMD levels. List      contacts are listed only when asked for; sums do not need them.
///   Source    [AcostaLiu07] section 2; leaps and lockstep are our own derivation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/contact_model.h"

namespace burrhole {

struct GradientPlaneConfig;

/// Points of a shell near each other in space follow each other: sixteen in lockstep then take ways of about the same length.
/// @returns their numbers. Order: bits of three 10-bit cells of the bounding cube interleaved; the caller's where equal.
[[nodiscard]] std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& positions);

class PackedPlane {
 public:
  explicit PackedPlane(const PointShell& shell);
  /// `bone` must hold words. Contacts, if listed, come in the order of the sorted shell and carry the caller's point numbers.
  void evaluate(const GradientPlaneConfig& config, const ContactView& bone, const Pose& world_from_tool,
                ContactResult& out) const noexcept BH_REALTIME;

 private:
  std::size_t count_;
  std::vector<std::uint32_t> point_;             // caller's number
  std::array<std::vector<double>, 3> position_;  // [m] tool frame, sorted, padded to whole vectors
  std::array<std::vector<float>, 3> inward_;
};

}  // namespace burrhole
