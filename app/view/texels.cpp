#include "app/view/texels.h"

#include <algorithm>
#include <cmath>

#include "core/voxel/box_parts.h"
#include "core/voxel/gradient.h"

namespace burrhole {
namespace {

std::uint8_t to_byte(double unit) { return static_cast<std::uint8_t>(std::clamp(unit * 255.0 + 0.5, 0.0, 255.0)); }

/// [-] Relative mineral density above which bone is drawn as dense, and below which it is drawn as marrow between thin walls.
constexpr double kDenseFrom = 0.75, kMarrowAt = 0.12;

struct Tint {
  double r, g, b;
};

/// Fresh bone: ivory tables; diploe redder and darker with its share of marrow; dura greyish pink, brain pink.
Tint tint_of(VoxelLabel label, float hardness) {
  const auto mix = [](const Tint& a, const Tint& b, double t) {
    return Tint{a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
  };
  constexpr Tint kIvory{0.93, 0.88, 0.76}, kMarrow{0.55, 0.20, 0.14}, kSpongy{0.86, 0.70, 0.55}, kDura{0.80, 0.62, 0.60},
      kBrain{0.84, 0.55, 0.53};
  switch (label) {
    case VoxelLabel::diploe:
      return mix(kMarrow, kSpongy, std::clamp((static_cast<double>(hardness) - 0.1) / 0.35, 0.0, 1.0));
    case VoxelLabel::dura:
      return kDura;
    case VoxelLabel::brain:
      return kBrain;
    case VoxelLabel::forbidden:
      return {0.85, 0.15, 0.15};
    case VoxelLabel::none:
    case VoxelLabel::bone:
    case VoxelLabel::outer_table:
    case VoxelLabel::inner_table:
      return kIvory;
  }
  return kIvory;
}

/// Calls f(part) for slabs of the box that limit the scratch memory.
template <class F>
void for_each_slab(const VoxelBox& box, F&& f) {
  constexpr int kSlab = 16;
  for (int k = box.lo.z; k < box.hi.z; k += kSlab)
    f(VoxelBox{{box.lo.x, box.lo.y, k}, {box.hi.x, box.hi.y, std::min(k + kSlab, box.hi.z)}});
}

/// Smooths colours over a voxel along one axis ([1 2 1] / 4): tissue borders become smooth, as by partial volume in a scan.
void fade(std::vector<Vec3f>& colors, const Vec3i& dims, std::size_t axis) {
  const VoxelBox box{Vec3i(0), dims};
  Vec3i step(0);
  step[axis] = 1;
  std::vector<Vec3f> out(colors.size());
  for_each_voxel(box, [&](const Vec3i& v) {
    const Vec3i before = glm::max(v - step, Vec3i(0)), after = glm::min(v + step, dims - 1);
    const std::size_t n = box.offset_of(v);
    out[n] = 0.25f * (colors[box.offset_of(before)] + 2.0f * colors[n] + colors[box.offset_of(after)]);
  });
  colors = std::move(out);
}

/// Tissue colours of the whole volume; alpha is the occupancy of soft tissue.
std::vector<Rgba8> make_colors(const BoneModel& bone) {
  const VoxelBox box = bone.bounds();
  std::vector<float> hardness(box.count()), soft(box.count()), labels(box.count());
  bone.read_hardness(box, hardness);
  bone.read_soft(box, soft);
  bone.read_labels(box, labels);
  std::vector<Vec3f> colors(box.count());
  for (std::size_t n = 0; n < colors.size(); ++n) {
    const Tint tint = tint_of(static_cast<VoxelLabel>(static_cast<int>(labels[n])), hardness[n]);
    colors[n] = Vec3f(Vec3(tint.r, tint.g, tint.b));
  }
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) fade(colors, bone.dims(), axis);
  std::vector<Rgba8> out;
  out.reserve(colors.size());
  for (std::size_t n = 0; n < colors.size(); ++n) {
    const Vec3 c(colors[n]);
    out.push_back({to_byte(c.x), to_byte(c.y), to_byte(c.z), to_byte(static_cast<double>(soft[n]))});
  }
  return out;
}

/// Sponginess of bone from its mineral density. A scan has this too, but no labels of tables and diploe.
std::vector<TissueTexel> make_tissue(const BoneModel& bone) {
  const VoxelBox box = bone.bounds();
  std::vector<float> occupancy(box.count()), hardness(box.count()), labels(box.count());
  bone.read_occupancy(box, occupancy);
  bone.read_hardness(box, hardness);
  bone.read_labels(box, labels);
  std::vector<TissueTexel> out;
  out.reserve(box.count());
  for (std::size_t n = 0; n < occupancy.size(); ++n) {
    const auto label = static_cast<VoxelLabel>(static_cast<int>(labels[n]));
    double kind = label == VoxelLabel::dura ? 1.0 : 0.0;
    if (is_felt(label)) kind = std::clamp((kDenseFrom - static_cast<double>(hardness[n])) / (kDenseFrom - kMarrowAt), 0.0, 1.0);
    out.push_back({to_byte(static_cast<double>(occupancy[n])), to_byte(kind)});
  }
  return out;
}

/// Input of the texels.
struct Slab {
  std::vector<float> density, soft;
  std::vector<Vec3f> gradient;  ///< of bone's density or soft tissue's occupancy; index axes
};

/// Central differences of soft tissue where its gradient is about as large as that of bone or larger: on dura that bone no longer covers,
/// and where bone lies on it. There, opposite normals of the two tissues would cancel in the texture filter.
void take_soft_gradients(const BoneModel& bone, const VoxelBox& part, float dead_zone, Slab& slab) {
  slab.soft.resize(part.count());
  const VoxelBox halo = part.grown(1);
  std::vector<float> soft(halo.count());
  bone.read_soft(halo, soft);
  if (std::all_of(soft.begin(), soft.end(), [](float s) { return s == 0.0f; })) return;
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
Slab make_slab(const BoneModel& bone, float dead_zone, const DensityBlock& from, const VoxelBox& part) {
  Slab slab{std::vector<float>(part.count()), {}, std::vector<Vec3f>(part.count())};
  copy_part(part, from.box, from.density.data(), part, slab.density.data());
  update_gradient(from, part, dead_zone, part, slab.gradient);
  take_soft_gradients(bone, part, dead_zone, slab);
  return slab;
}

/// The same from the present density of the bone.
Slab read_slab(const Voxmap& voxmap, const VoxelBox& part) {
  TexelSource source;
  read_texel_source(voxmap, part, source);
  return make_slab(voxmap.bone(), voxmap.config().gradient_dead_zone, {part.grown(1), source.density}, part);
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

void read_texel_source(const Voxmap& voxmap, const VoxelBox& box, TexelSource& out) {
  out.box = box.intersect(voxmap.bone().bounds());
  if (out.box.empty()) out.box = {};
  const VoxelBox halo = out.box.empty() ? VoxelBox{} : out.box.grown(1);
  out.density.resize(halo.count());
  voxmap.read_density(halo, out.density);
}

TexelBox make_texels(const BoneModel& bone, float dead_zone, const TexelSource& source) {
  TexelBox out;
  if (source.box.empty()) return out;
  out.box = source.box;
  out.normal_opacity.reserve(out.box.count());
  out.field.reserve(out.box.count());
  const Mat3 normal_map = normal_map_of(bone);
  for_each_slab(out.box, [&](const VoxelBox& part) {
    const Slab slab = make_slab(bone, dead_zone, {out.box.grown(1), source.density}, part);
    for (std::size_t n = 0; n < slab.density.size(); ++n) {
      out.normal_opacity.push_back(encode_normal(normal_of(normal_map, slab.gradient[n]), to_byte(static_cast<double>(slab.density[n]))));
      out.field.push_back(static_cast<std::uint16_t>(65535.0f * seen_of(slab, n) + 0.5f));
    }
  });
  return out;
}

TexelBox make_texels(const Voxmap& voxmap, const VoxelBox& box) {
  TexelBox out;
  out.box = box.intersect(voxmap.bone().bounds());
  if (out.box.empty()) return {};
  out.normal_opacity.reserve(out.box.count());
  out.field.reserve(out.box.count());
  // By slabs, so that the whole volume is never stored as dense floats.
  TexelSource source;
  for_each_slab(out.box, [&](const VoxelBox& part) {
    read_texel_source(voxmap, part, source);
    const TexelBox made = make_texels(voxmap.bone(), voxmap.config().gradient_dead_zone, source);
    out.normal_opacity.insert(out.normal_opacity.end(), made.normal_opacity.begin(), made.normal_opacity.end());
    out.field.insert(out.field.end(), made.field.begin(), made.field.end());
  });
  return out;
}

PreciseTexels make_precise_texels(const Voxmap& voxmap) {
  const VoxelBox all = voxmap.bone().bounds();
  PreciseTexels out;
  out.normal_opacity.reserve(all.count());
  out.field.reserve(all.count());
  const Mat3 normal_map = normal_map_of(voxmap.bone());
  for_each_slab(all, [&](const VoxelBox& part) {
    const Slab slab = read_slab(voxmap, part);
    for (std::size_t n = 0; n < slab.density.size(); ++n) {
      out.normal_opacity.emplace_back(Vec3f(0.5 + 0.5 * normal_of(normal_map, slab.gradient[n])), slab.density[n]);
      out.field.push_back(seen_of(slab, n));
    }
  });
  return out;
}

VolumeView make_volume_view(const Voxmap& voxmap, bool with_tissue) {
  const BoneModel& bone = voxmap.bone();
  VolumeView out;
  out.dims = bone.dims();
  out.bone_from_index = bone.bone_from_index();
  TexelBox all = make_texels(voxmap, bone.bounds());
  out.normal_opacity = std::move(all.normal_opacity);
  out.field = std::move(all.field);
  out.color = make_colors(bone);
  if (with_tissue) out.tissue = make_tissue(bone);
  return out;
}

}  // namespace burrhole
