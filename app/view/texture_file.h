/// app/view/texture_file.h: files of textures: what their header says, checked before anything is read into memory. No OpenGL, no libpng.
///   Frame  none.   Units  texels.   Errors  bad_input with what to do.   Thread  any: no state.
///   Format a PNG. A volume is a column of square slices, the first at the top: width n, height n times the number of slices.
#pragma once

#include <cstdint>
#include <string>

#include "app/view/bone_texture.h"
#include "core/base/result.h"

namespace burrhole {

enum class TextureKind { exterior, interior };
inline constexpr int kLongestImage = 4096, kLongestVolume = 256;  ///< [texels] of an edge: 64 MB each

/// Reads the header of a file. @returns its texels; for TextureKind::exterior z is 1. bad_input: no such file, not a PNG, larger than the
/// limits, or for TextureKind::interior no column of square slices.
[[nodiscard]] Result<Vec3i> read_texture_header(const std::string& path, TextureKind kind);

/// @returns the memory [bytes] of the textures that a scene names, with their coarser levels and the copy that a driver in memory holds. A
/// file that cannot be read counts nothing.
[[nodiscard]] std::uint64_t texture_bytes(const TextureConfig& config);

}  // namespace burrhole
