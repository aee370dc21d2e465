/// core/contact/worst_hit.h: finds the hit of a surface probe that is deepest below the surface after a small motion.
///   Frame  normals and motion in the axes of the bone frame, positions in the tool frame.   Units  voxel edges, positions [m].
///   Source own derivation: interval arithmetic on the ranges of positions and normals bounds the distances in a block of hits, and blocks
///   that cannot contain the answer are skipped. The result equals that of a plain scan bit for bit, on every SIMD level and for any
///   blocks.
#pragma once

#include <limits>
#include <optional>

#include "core/contact/surface_probe.h"

namespace burrhole {

/// Effect of a small rigid motion on points: p moves by linear * p_tool + offset [voxel edges], bone frame.
struct PointMotion {
  Mat3 linear{0.0};  ///< [voxels/m] in voxel edges
  Vec3 offset{0.0};  ///< [voxels] in voxel edges
};

/// A scan of at most this number of hits is as fast as bounding them, so it does not use blocks.
inline constexpr std::size_t kScannedHits = 8 * kHitBlock;

struct WorstHit {
  std::size_t hit = 0;
  float distance = 0.0f;  ///< [voxels] after the linearised motion, in voxel edges
};

/// The hit in [first, last) with the least distance after `motion`; the first one of equals. Empty when none is below `limit` or when the
/// motion is NaN. Callers may increase the distance of a hit after the probe (to hide it), but not decrease it.
[[nodiscard]] std::optional<WorstHit> find_worst(const ProbeHits& hits, std::size_t first, std::size_t last, const PointMotion& motion,
                                                 float limit = std::numeric_limits<float>::infinity()) noexcept;

}  // namespace burrhole
