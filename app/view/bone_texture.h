/// app/view/bone_texture.h: images that a mesh of bone is drawn with: a 2D one on its surface as loaded, a 3D one where bone was cut. No OpenGL.
///   Frame  texture: z along `axis` of the bone frame, x and y the two axes that follow it in the cycle x, y, z.   Units  m.
///   Errors none.   Source [TellesONeill10] section 3.3; the projections are our own.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "app/view/view.h"
#include "core/base/bounds.h"

namespace burrhole {

/// Textures that a scene names.
struct TextureConfig {
  std::string exterior;                 ///< name of a pattern (texture_pattern.h) or path of an image; empty: the voxels' colours
  std::string interior;                 ///< the same of a volume
  double exterior_edge = 0.020;         ///< [m] of one repeat; key exterior_mm
  std::optional<double> interior_edge;  ///< [m] of one repeat; absent: the volume spans the box of the bone as loaded; key interior_mm
  int axis = 2;                         ///< 0..2; key texture_axis
  [[nodiscard]] bool any() const noexcept { return !exterior.empty() || !interior.empty(); }
};

/// Voxels of a texture, i fastest.
struct VolumeImage {
  Vec3i dims{0};
  std::vector<Rgba8> pixels;
};

/// The same, read or made.
struct BoneTextures {
  Image exterior;                       ///< empty: none
  VolumeImage interior;                 ///< empty: none
  double exterior_edge = 0.020;         ///< [m]
  std::optional<double> interior_edge;  ///< [m]
  int axis = 2;
  bool exterior_tiles = false;  ///< opposite sides fit together; false: every second repeat is mirrored
  bool interior_tiles = false;
};

/// Rows of the maps from the bone frame [m] to repeats of the textures.
struct TextureMaps {
  glm::dvec4 exterior[3], interior[3];  ///< [1/m], the fourth [-]
};

/// @param box of the bone as loaded, bone frame.
[[nodiscard]] inline TextureMaps make_texture_maps(const BoneTextures& textures, const Bounds& box) noexcept {
  TextureMaps out;
  const Vec3 size = glm::max(box.hi - box.lo, Vec3(1e-6));
  for (int row = 0; row < 3; ++row) {
    const int axis = (textures.axis + 1 + row) % 3;
    out.exterior[row] = out.interior[row] = glm::dvec4(0.0);
    out.exterior[row][axis] = 1.0 / textures.exterior_edge;
    const double edge = textures.interior_edge.value_or(size[axis]);
    out.interior[row][axis] = 1.0 / edge;
    if (!textures.interior_edge) out.interior[row].w = -box.lo[axis] / edge;
  }
  return out;
}

}  // namespace burrhole
