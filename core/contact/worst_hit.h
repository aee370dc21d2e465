/// core/contact/worst_hit.h: of the hits of a surface probe, the one that a small motion would bring deepest under the surface.
///   Frame  normals and motion in the axes of the bone frame, places in the tool frame.   Units  voxel edges, places [m].
///   Source own derivation: what a block of hits can come to at most is bounded by the ranges of its places and normals (interval
///          arithmetic), and blocks that cannot hold the answer are passed by. The answer is that of a plain scan, bit for bit: on every
///          SIMD level, whatever the blocks.
#pragma once

#include <limits>
#include <optional>

#include "core/contact/surface_probe.h"

namespace burrhole {

/// A rigid motion's small step and what it does to points: p moves by linear * p_tool + offset [voxel edges], bone frame.
struct PointMotion {
  Mat3 linear{0.0};
  Vec3 offset{0.0};
};

/// So few hits are scanned as fast as they are bounded: blocks of no more are not used.
inline constexpr std::size_t kScannedHits = 8 * kHitBlock;

struct WorstHit {
  std::size_t hit = 0;
  float distance = 0.0f;  ///< [voxel edges] after the motion, linearised
};

/// The hit in [first, last) with the least distance after `motion`; ties go to the first. Nothing when none comes below `limit` or when the
/// motion is not a number. The distance of a hit may be raised after the probe (to hide it), not lowered.
[[nodiscard]] std::optional<WorstHit> find_worst(const ProbeHits& hits, std::size_t first, std::size_t last, const PointMotion& motion,
                                                 float limit = std::numeric_limits<float>::infinity()) noexcept;

}  // namespace burrhole
