#include "app/view/detail.h"

#include <span>

#include "app/view/texels.h"
#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

glm::dvec4 numbers_of(const Rgba8& t) { return {t.r, t.g, t.b, t.a}; }
glm::dvec2 numbers_of(const TissueTexel& t) { return {t.r, t.g}; }
double numbers_of(std::uint16_t t) { return t; }

std::uint8_t rounded(double number) { return static_cast<std::uint8_t>(number + 0.5); }
void store(const glm::dvec4& n, Rgba8& t) { t = {rounded(n.x), rounded(n.y), rounded(n.z), rounded(n.w)}; }
void store(const glm::dvec2& n, TissueTexel& t) { t = {rounded(n.x), rounded(n.y)}; }
void store(double n, std::uint16_t& t) { t = static_cast<std::uint16_t>(n + 0.5); }

/// One row of voxels along x. @param own texels of the row.
template <class Texel>
void blend_row(const DetailGrid& grid, const VoxelBox& coarse_box, std::span<const Texel> coarse, const Vec3i& first,
               std::span<Texel> own) {
  const Vec3i size = coarse_box.size();
  const std::ptrdiff_t row = size.x, slab = row * size.y;
  for (std::size_t n = 0; n < own.size(); ++n) {
    const Vec3i v = first + Vec3i(static_cast<int>(n), 0, 0);
    const double share = grid.own_share(v);
    if (share >= 1.0) continue;
    const Vec3 place = Vec3(v) / static_cast<double>(grid.factor);
    const Vec3i base = glm::clamp(floor_int(place), coarse_box.lo, coarse_box.hi - 2);
    const Texel* corner = coarse.data() + coarse_box.offset_of(base);
    const auto mean = trilinear(place - Vec3(base), [&](unsigned c) { return numbers_of(corner[corner_offset(c, row, slab)]); });
    store(mean + (numbers_of(own[n]) - mean) * share, own[n]);
  }
}

template <class Texel>
void blend_box(const DetailGrid& grid, const VoxelBox& coarse_box, const std::vector<Texel>& coarse, const VoxelBox& box,
               std::vector<Texel>& own) {
  if (own.empty()) return;
  const Vec3i size = box.size();
  const auto width = static_cast<std::size_t>(size.x);
  for_each_number(size.y * size.z, own.size() / 50'000 + 1, [&](int n) {
    const Vec3i first(box.lo.x, box.lo.y + n % size.y, box.lo.z + n / size.y);
    blend_row<Texel>(grid, coarse_box, coarse, first, std::span(own).subspan(static_cast<std::size_t>(n) * width, width));
  });
}

}  // namespace

int coarse_factor(const Vec3i& dims, std::size_t most) noexcept {
  int factor = 1;
  while (VoxelBox{Vec3i(0), factor == 1 ? dims : CoarseBone::dims_of(dims, factor)}.count() > most) ++factor;
  return factor;
}

Vec3 detail_edge(const DisplayConfig& display, const Affine& bone_from_index) noexcept {
  const Mat3& cell = bone_from_index.linear;
  return display.detail / Vec3(glm::length(cell[0]), glm::length(cell[1]), glm::length(cell[2]));
}

DetailGrid place_detail(const Vec3i& dims, int factor, const Vec3& centre, const Vec3& edge) noexcept {
  // In steps of a coarse voxel, inside the bone.
  const Vec3i last = (dims - 1) / factor,
              cells = glm::clamp(Vec3i(glm::ceil(edge / static_cast<double>(factor))), Vec3i(1), glm::max(last, 1));
  const Vec3i lo = glm::clamp(Vec3i(glm::round(centre / static_cast<double>(factor))) - cells / 2, Vec3i(0), glm::max(last - cells, 0));
  return {{lo * factor, (lo + cells) * factor + 1}, factor};
}

bool is_blended(const DetailGrid& grid, const VoxelBox& box) noexcept {
  const int margin = static_cast<int>(grid.ring() + grid.blend());
  return !VoxelBox{grid.box.lo + margin, grid.box.hi - margin}.contains(box);
}

VoxelBox detail_of(const DetailGrid& grid, const VoxelBox& box) noexcept {
  const VoxelBox changed = box.intersect(grid.box);
  if (!changed.empty() && !is_blended(grid, changed)) return changed;
  // Near the faces texels depend on coarse normals too, and those on voxels up to three coarse voxels away.
  const VoxelBox reached = box.grown(3 * grid.factor).intersect(grid.box);
  return reached.empty() ? VoxelBox{} : reached;
}

VoxelBox coarse_around(const DetailGrid& grid, const VoxelBox& box, const Vec3i& coarse_dims) noexcept {
  return VoxelBox{box.lo / grid.factor, (box.hi - 1) / grid.factor + 2}.intersect({Vec3i(0), coarse_dims});
}

void blend_with_coarse(const DetailGrid& grid, const TexelBox& coarse, TexelBox& own) {
  blend_box(grid, coarse.box, coarse.normal_opacity, own.box, own.normal_opacity);
  blend_box(grid, coarse.box, coarse.field, own.box, own.field);
}

DetailView make_detail_view(const DetailGrid& grid, const CoarseBone& coarse, const Voxmap& voxmap, bool with_tissue) {
  const VoxelBox cells = coarse_around(grid, grid.box, coarse.loaded().dims());
  const VolumeView outer = make_volume_view(coarse.drawn(voxmap), cells, with_tissue);
  DetailView out{grid, make_volume_view(drawn_bone(voxmap), grid.box, with_tissue)};
  blend_box(grid, cells, outer.normal_opacity, grid.box, out.volume.normal_opacity);
  blend_box(grid, cells, outer.field, grid.box, out.volume.field);
  blend_box(grid, cells, outer.color, grid.box, out.volume.color);
  blend_box(grid, cells, outer.tissue, grid.box, out.volume.tissue);
  return out;
}

}  // namespace burrhole
