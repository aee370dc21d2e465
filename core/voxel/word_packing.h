/// core/voxel/word_packing.h: packs density and gradient of voxels into the words of contact_words.h, computed from the density.
///   Word    as in contact_words.h, with a leap of 1. Side: one bit for empty, below 0.5, 0.5 and above; 0 if the gradient is not zero.
///   Frame   index.   Errors  none.   Thread  any, on its own rows.
///   Source  [AcostaLiu07] section 2 (each voxel encodes density and gradient); the word is own.
#pragma once

#include <cstdint>
#include <span>

#include "core/voxel/contact_words.h"
#include "core/voxel/gradient.h"

namespace burrhole {

/// Sides, one bit each: the bitwise OR of neighbours shows whether their sides differ.
inline constexpr std::uint8_t kSideEmpty = 1, kSideThin = 2, kSideSolid = 4;

/// Computes words and sides of `target`, both dense over block.box. The gradient is that of update_gradient(), rounded to a step, without
/// an intermediate array: same bits as from stored floats, at every SIMD level. Requires target.grown(1) inside block.box.
void pack_words(const DensityBlock& block, const VoxelBox& target, float dead_zone, std::span<ContactWord> words,
                std::span<std::uint8_t> sides) noexcept;

}  // namespace burrhole
