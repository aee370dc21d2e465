#include "app/view/texels.h"

#include <algorithm>
#include <cmath>

#include "app/view/tissue_texels.h"
#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/voxel/box_parts.h"
#include "core/voxel/gradient.h"

namespace burrhole {
namespace {

constexpr int kSlab = 16;  // [voxels] layers that are computed at a time, which limits the scratch memory

/// Calls f(part) for slabs of the box.
template <class F>
void for_each_slab(const VoxelBox& box, F&& f) {
  for (int k = box.lo.z; k < box.hi.z; k += kSlab)
    f(VoxelBox{{box.lo.x, box.lo.y, k}, {box.hi.x, box.hi.y, std::min(k + kSlab, box.hi.z)}});
}

/// Input of the texels.
struct Slab {
  std::vector<float> density, soft;
  std::vector<Vec3f> gradient;  ///< of bone's density or soft tissue's occupancy; index axes
};

/// Leaves out the soft tissue above a face that an effect has moved.
void limit_soft(const BoneModel& bone, const SoftTop& top, const VoxelBox& box, std::vector<float>& soft) {
  const double edge = bone.bone_from_index().mean_edge();
  const Bounds extent = top.extent();
  std::size_t n = 0;
  for_each_voxel(box, [&](const Vec3i& v) {
    float& one = soft[n++];
    const Vec3 p = bone.bone_from_index() * Vec3(v);
    if (one > 0.0f && glm::all(glm::lessThanEqual(extent.lo, p)) && glm::all(glm::lessThanEqual(p, extent.hi)))
      one = std::min(one, static_cast<float>(top.shown(p, edge)));
  });
}

/// Central differences of soft tissue where its gradient is about as large as that of bone or larger: on dura that bone no longer covers,
/// and where bone lies on it. There, opposite normals of the two tissues would cancel in the texture filter.
void take_soft_gradients(const BoneModel& bone, const VoxelBox& part, float dead_zone, std::span<const SoftTop* const> tops, Slab& slab) {
  slab.soft.resize(part.count());
  const VoxelBox halo = part.grown(1);
  std::vector<float> soft(halo.count());
  bone.read_soft(halo, soft);
  if (std::all_of(soft.begin(), soft.end(), [](float s) { return s == 0.0f; })) return;
  for (const SoftTop* top : tops) limit_soft(bone, *top, halo, soft);
  const Vec3i size = halo.size();
  const std::size_t steps[3] = {1, static_cast<std::size_t>(size.x), static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)};
  std::size_t n = 0;
  for_each_voxel(part, [&](const Vec3i& v) {
    const std::size_t at = halo.offset_of(v);
    const auto slope = [&](std::size_t step) { return 0.5f * (soft[at + step] - soft[at - step]); };
    const Vec3f gradient(slope(steps[0]), slope(steps[1]), slope(steps[2]));
    const float length2 = glm::dot(gradient, gradient);
    if (length2 >= dead_zone * dead_zone && 2.0f * length2 > glm::dot(slab.gradient[n], slab.gradient[n])) slab.gradient[n] = gradient;
    slab.soft[n++] = soft[at];
  });
}

/// @param from dense density over a box that holds `part` and a voxel round it.
Slab make_slab(const BoneModel& bone, float dead_zone, const DensityBlock& from, const VoxelBox& part,
               std::span<const SoftTop* const> tops = {}) {
  Slab slab{std::vector<float>(part.count()), {}, std::vector<Vec3f>(part.count())};
  copy_part(part, from.box, from.density.data(), part, slab.density.data());
  update_gradient(from, part, dead_zone, part, slab.gradient);
  take_soft_gradients(bone, part, dead_zone, tops, slab);
  return slab;
}

float seen_of(const Slab& slab, std::size_t n) { return std::clamp(std::max(slab.density[n], slab.soft[n]), 0.0f, 1.0f); }

/// Matrix from a gradient in index axes to one in metres: the transposed inverse.
Mat3 normal_map_of(const BoneModel& bone) { return glm::transpose(glm::inverse(bone.bone_from_index().linear)); }

/// Outward, unit length; zero for a zero gradient.
Vec3 normal_of(const Mat3& normal_map, const Vec3f& index_gradient) {
  const Vec3 normal = -(normal_map * Vec3(index_gradient));
  const double length = glm::length(normal);
  return length > 0.0 ? normal / length : Vec3(0.0);
}

}  // namespace

void read_texel_source(const DrawnBone& bone, const VoxelBox& box, TexelSource& out) {
  out.box = box.intersect(bone.loaded->bounds());
  if (out.box.empty()) out.box = {};
  const VoxelBox halo = out.box.empty() ? VoxelBox{} : out.box.grown(1);
  out.density.resize(halo.count());
  bone.read_density(halo, out.density);
}

TexelBox make_texels(const BoneModel& bone, float dead_zone, const TexelSource& source, std::span<const SoftTop* const> tops) {
  TexelBox out;
  if (source.box.empty()) return out;
  out.box = source.box;
  out.normal_opacity.reserve(out.box.count());
  out.field.reserve(out.box.count());
  const Mat3 normal_map = normal_map_of(bone);
  for_each_slab(out.box, [&](const VoxelBox& part) {
    const Slab slab = make_slab(bone, dead_zone, {out.box.grown(1), source.density}, part, tops);
    for (std::size_t n = 0; n < slab.density.size(); ++n) {
      out.normal_opacity.push_back(encode_normal(normal_of(normal_map, slab.gradient[n]), to_byte(static_cast<double>(slab.density[n]))));
      out.field.push_back(static_cast<std::uint16_t>(65535.0f * seen_of(slab, n) + 0.5f));
    }
  });
  return out;
}

TexelBox make_texels(const Voxmap& voxmap, const VoxelBox& box) {
  TexelSource source;
  read_texel_source(drawn_bone(voxmap), box, source);
  return make_texels(voxmap.bone(), voxmap.config().gradient_dead_zone, source);
}

PreciseTexels make_precise_texels(const Voxmap& voxmap) {
  const BoneModel& bone = voxmap.bone();
  const VoxelBox all = bone.bounds();
  PreciseTexels out;
  out.normal_opacity.reserve(all.count());
  out.field.reserve(all.count());
  const Mat3 normal_map = normal_map_of(bone);
  TexelSource source;
  for_each_slab(all, [&](const VoxelBox& part) {
    read_texel_source(drawn_bone(voxmap), part, source);
    const Slab slab = make_slab(bone, voxmap.config().gradient_dead_zone, {part.grown(1), source.density}, part);
    for (std::size_t n = 0; n < slab.density.size(); ++n) {
      out.normal_opacity.emplace_back(Vec3f(0.5 + 0.5 * normal_of(normal_map, slab.gradient[n])), slab.density[n]);
      out.field.push_back(seen_of(slab, n));
    }
  });
  return out;
}

VolumeView make_volume_view(const DrawnBone& bone, const VoxelBox& part, bool with_tissue) {
  BH_ASSERT(bone.loaded->bounds().contains(part));
  VolumeView out;
  out.dims = part.size();
  const Affine& affine = bone.loaded->bone_from_index();
  out.bone_from_index = {affine.linear, affine * Vec3(part.lo)};
  out.normal_opacity.resize(part.count());
  out.field.resize(part.count());
  out.color.resize(part.count());
  if (with_tissue) out.tissue.resize(part.count());
  // Slabs on all cores, so that the whole volume is never stored as dense floats.
  const int slabs = (out.dims.z + kSlab - 1) / kSlab;
  for_each_number(slabs, [&](int n) {
    const int k = part.lo.z + n * kSlab;
    const VoxelBox slab{{part.lo.x, part.lo.y, k}, {part.hi.x, part.hi.y, std::min(k + kSlab, part.hi.z)}};
    const auto at = static_cast<std::ptrdiff_t>(part.offset_of(slab.lo));
    TexelSource source;
    read_texel_source(bone, slab, source);
    const TexelBox texels = make_texels(*bone.loaded, bone.dead_zone, source);
    std::copy(texels.normal_opacity.begin(), texels.normal_opacity.end(), out.normal_opacity.begin() + at);
    std::copy(texels.field.begin(), texels.field.end(), out.field.begin() + at);
    const std::vector<Rgba8> colors = make_colors(*bone.loaded, slab);
    std::copy(colors.begin(), colors.end(), out.color.begin() + at);
    if (!with_tissue) return;
    const std::vector<TissueTexel> tissue = make_tissue(*bone.loaded, slab);
    std::copy(tissue.begin(), tissue.end(), out.tissue.begin() + at);
  });
  return out;
}

VolumeView make_volume_view(const Voxmap& voxmap, bool with_tissue) {
  return make_volume_view(drawn_bone(voxmap), voxmap.bone().bounds(), with_tissue);
}

}  // namespace burrhole
