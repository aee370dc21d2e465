/// core/contact/packed_plane.h: gradient_plane in vector arithmetic over the packed words of the contact window.
///   Frame  world for results.   Units  SI.   Thread  contact.
///   The law is that of gradient_plane.h, with this arithmetic:
///   Position  in the window, whole multiples of 1/16384 voxel, so that leaps and single steps visit exactly the same voxels. A step along
///             the tool vector or the gradient is rounded to the same grid, at most one voxel per axis.
///   Density   multiples of 1/255, gradient of 1/254 (contact_words.h); the 0.5 surface is where the trilinear density, in float, reaches
///             127.5.
///   Plane     normal and distance in float (relative error 1e-7); sums and results in double. Positions are those of the 1/16384 grid.
///   Sums      sixteen partial sums, the n-th touching point of the sorted shell in sum n % 16, added pairwise: same bits on all SIMD
///             levels.
///   List      contacts are listed only when requested; sums do not need them.
///   Source    [AcostaLiu07] section 2; leaps and lockstep are own derivations.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/penalty_model.h"

namespace burrhole {

struct GradientPlaneConfig;

/// Sorts points so that spatial neighbours are adjacent: sixteen points in lockstep then have marches of similar length.
/// @returns the point numbers in order of interleaved bits of three 10-bit cells of the bounding cube; the caller's order where equal.
[[nodiscard]] std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& positions);

class PackedPlane {
 public:
  explicit PackedPlane(const PointShell& shell);
  /// `bone` must have words. Listed contacts are in the order of the sorted shell, with the caller's point numbers.
  void evaluate(const GradientPlaneConfig& config, const ContactView& bone, const Pose& world_from_tool,
                ContactResult& out) const noexcept BH_REALTIME;

 private:
  std::size_t count_;
  std::vector<std::uint32_t> point_;             // caller's number
  std::array<std::vector<double>, 3> position_;  // [m] tool frame, sorted, padded to whole vectors
  std::array<std::vector<float>, 3> inward_;
};

}  // namespace burrhole
