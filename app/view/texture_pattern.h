/// app/view/texture_pattern.h: the patterns that a scene may name as textures. They are computed, so no file of an image is shipped.
///   Frame  texture: z along the axis of the body (bone_texture.h).   Units  texels.   Errors  none.   Thread  any: no state.
///   Source own; noise by hashing of lattice points, the same on every machine up to the rounding of one level.
#pragma once

#include <string>
#include <vector>

#include "app/view/bone_texture.h"

namespace burrhole {

/// Scale that suits a pattern.
struct PatternScale {
  double exterior_edge = 0.020;         ///< [m] of one repeat
  std::optional<double> interior_edge;  ///< [m]; absent: the volume spans the body
};

/// @returns the names: "bone", "apple", "cucumber".
[[nodiscard]] const std::vector<std::string>& pattern_names();
[[nodiscard]] bool is_pattern(const std::string& name);
/// @pre is_pattern(name), for all of these.
[[nodiscard]] PatternScale pattern_scale(const std::string& name);
/// @returns the surface, which tiles.
[[nodiscard]] Image make_exterior_pattern(const std::string& name);
/// @returns the inside. A volume with an edge tiles.
[[nodiscard]] VolumeImage make_interior_pattern(const std::string& name);

inline constexpr int kPatternImageSide = 256, kPatternVolumeSide = 96;  ///< [texels]

}  // namespace burrhole
