#include "app/view/drape.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/view/site_window.h"
#include "app/view/tissue_texels.h"
#include "core/base/parallel.h"
#include "core/base/portable_math.h"
#include "core/base/trilinear.h"
#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

constexpr double kGap = 4e-3;          // [m] of the middle of the cloth above the body
constexpr double kHalfThick = 1.7e-3;  // [m]; thinner cloth would be lost between coarse voxels
constexpr double kHem = 1.1e-3;        // [m] more at the edge of the window
constexpr double kLining = 6e-3;       // [m] more on the inner side, away from the window
constexpr int kStride = 2;             // [coarse voxels] of the lattice on which the body is evaluated

/// The cloth's middle as a field on a lattice: the body, and below each of its points what hangs down from there.
struct Hanging {
  Vec3i size{0};
  std::vector<double> field;  // [m] i fastest

  [[nodiscard]] double at(const Vec3& lattice) const {
    const Vec3i base = glm::clamp(floor_int(lattice), Vec3i(0), size - 2);
    const std::ptrdiff_t row = size.x, slab = row * size.y;
    const double* corner = field.data() + VoxelBox{Vec3i(0), size}.offset_of(base);
    return trilinear(lattice - Vec3(base), [&](unsigned c) { return corner[corner_offset(c, row, slab)]; });
  }
};

/// Folds: how much the cloth spreads per length that it hangs, by the direction from the axis.
double spread_at(const Vec3& approach) {
  const double angle = portable_atan2(approach.y, approach.x);
  return 0.03 + 0.022 * portable_sin(9.0 * angle + 1.0) + 0.013 * portable_sin(16.0 * angle + 2.0);
}

Hanging hang(const DrapeConfig& drape, const Affine& approach_from_index, const Affine& bone_from_index, const Vec3i& dims) {
  Hanging out;
  out.size = (dims + kStride - 1) / kStride + 1;
  const VoxelBox all{Vec3i(0), out.size};
  out.field.resize(all.count());
  const double pitch = bone_from_index.mean_edge();
  constexpr double kMargin = 2.5;  // [lattice edges]
  const double fall = kStride * glm::length(bone_from_index.linear[2]);
  for_each_number(out.size.y, [&](int j) {
    for (int i = 0; i < out.size.x; ++i) {
      const double spread = spread_at(approach_from_index * Vec3(kStride * i, kStride * j, 0.0));
      // Near the sides of the volume the cloth falls straight, and does not leave it.
      const Vec3i side = glm::min(Vec3i(i, j, 0), out.size - 1 - Vec3i(i, j, 0));
      const double room = kStride * pitch * (kMargin - std::min(side.x, side.y));
      double above = 1.0;
      for (int k = out.size.z - 1; k >= 0; --k) {
        const Vec3i v(i, j, k);
        above = std::max(std::min(drape.body(bone_from_index * (static_cast<double>(kStride) * Vec3(v))), above - spread * fall), room);
        out.field[all.offset_of(v)] = above;
      }
    }
  });
  return out;
}

}  // namespace

void add_drape(const DrapeConfig& drape, const Pose& bone_from_approach, const VoxelBox& region, int factor, double bottom,
               VolumeView& whole) {
  const Affine& bone_from_index = whole.bone_from_index;
  const Affine approach_from_index = Affine::from_pose(bone_from_approach.inverse()) * bone_from_index;
  const SiteWindow window{drape.window, drape.round};
  const Hanging hanging = hang(drape, approach_from_index, bone_from_index, whole.dims);
  const double pitch = bone_from_index.mean_edge();
  const VoxelBox all{Vec3i(0), whole.dims}, keep{region.lo / factor - 1, (region.hi - 1) / factor + 2};
  const auto cloth = [&](const Vec3i& v) {
    const Vec3 p = approach_from_index * Vec3(v);
    const double beyond = p.z > -0.5 * drape.window ? window.beyond(p) : 1.0;
    const double hem = beyond / 2.2e-3;
    const double half = kHalfThick + (std::abs(hem) < 6.0 ? kHem * portable_exp(-hem * hem) : 0.0);
    // Away from the window the inner side is deeper, where it is not seen: a thin sheet is too thin for coarse voxels.
    const double inner = kHalfThick + kLining * std::clamp((beyond - 4e-3) / 10e-3, 0.0, 1.0);
    const double above = hanging.at(Vec3(v) / static_cast<double>(kStride)) - kGap;
    return std::max({above - half, -above - inner, -beyond, bottom - p.z});
  };
  const Mat3 normal_map = glm::transpose(glm::inverse(bone_from_index.linear));
  const Rgba8 color{to_byte(kClothColor.x), to_byte(kClothColor.y), to_byte(kClothColor.z), 0};
  for_each_number(whole.dims.z, [&](int k) {
    for_each_voxel({{0, 0, k}, {whole.dims.x, whole.dims.y, k + 1}}, [&](const Vec3i& v) {
      const double d = cloth(v);
      if (d > 3.0 * pitch || keep.contains({v, v + 1})) return;
      // Over a cell of the lattice on either side, or its cells would be seen.
      const auto slope = [&](const Vec3i& step) { return (cloth(v + kStride * step) - cloth(v - kStride * step)) / (2.0 * kStride); };
      const Vec3 gradient(slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1}));
      const double width = std::abs(gradient.x) + std::abs(gradient.y) + std::abs(gradient.z);
      const double share = std::clamp(0.5 - d / (2.0 * std::max(width, 0.2 * pitch)), 0.0, 1.0);
      const std::size_t n = all.offset_of(v);
      const auto field = static_cast<std::uint16_t>(std::lround(65535.0 * share));
      if (field < whole.field[n] || (share <= 0.0 && whole.field[n] > 0)) return;
      whole.color[n] = color;
      if (share <= 0.0) return;
      const Vec3 normal = normal_map * gradient;
      whole.field[n] = field;
      whole.normal_opacity[n] = encode_normal(normal / std::max(glm::length(normal), 1e-12), to_byte(share));
      if (!whole.tissue.empty()) whole.tissue[n] = {to_byte(share), 0};
    });
  });
}

}  // namespace burrhole
