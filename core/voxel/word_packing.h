/// core/voxel/word_packing.h: density and gradient of voxels, straight from the density, in the words of contact_words.h.
///   Units  word as there, its leap left at 1; sides one bit each: empty, below 0.5, 0.5 and above, 0 where there is a gradient.
///   Thread  any, on rows of its own.   Source  [AcostaLiu07] section 2 (each voxel encodes density and gradient); the word is own.
#pragma once

#include <cstdint>
#include <span>

#include "core/voxel/contact_words.h"
#include "core/voxel/gradient.h"

namespace burrhole {

/// Sides, one bit each, so that the bits of neighbours together say whether they differ.
inline constexpr std::uint8_t kSideEmpty = 1, kSideThin = 2, kSideSolid = 4;

/// Words and sides of `target`, both dense over block.box. The gradient is update_gradient()'s, rounded to a step, without ever having been
/// stored: same bits as from stored floats, at every SIMD level. Requires target.grown(1) inside block.box.
void pack_words(const DensityBlock& block, const VoxelBox& target, float dead_zone, std::span<ContactWord> words,
                std::span<std::uint8_t> sides) noexcept;

}  // namespace burrhole
