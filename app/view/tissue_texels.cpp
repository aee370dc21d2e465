#include "app/view/tissue_texels.h"

#include "core/voxel/label_table.h"

namespace burrhole {
namespace {

/// [-] Relative mineral density above which bone is drawn as dense, and below which it is drawn as marrow between thin walls.
constexpr double kDenseFrom = 0.75, kMarrowAt = 0.12;
/// [-] Bounds of the sponginess of labelled layers, so that diploe and tables of a scan differ where its blur has evened out their densities.
constexpr double kLeastOfDiploe = 0.35, kMostOfTables = 0.2;

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
    case VoxelLabel::soft_tissue:
    case VoxelLabel::first_user:
      return kIvory;
  }
  return kIvory;
}

/// 0 dense .. 1 marrow.
double sponginess(VoxelLabel label, float hardness) {
  const double by_density = (kDenseFrom - static_cast<double>(hardness)) / (kDenseFrom - kMarrowAt);
  if (label == VoxelLabel::diploe) return std::clamp(by_density, kLeastOfDiploe, 1.0);
  if (label == VoxelLabel::outer_table || label == VoxelLabel::inner_table) return std::clamp(by_density, 0.0, kMostOfTables);
  return std::clamp(by_density, 0.0, 1.0);
}

/// The colour of a label of the user; ivory if it has none.
Tint tint_of(VoxelLabel label, const LabelTable& own) {
  for (const NamedLabel& one : own)
    if (one.label == label) return {one.color[0] / 255.0, one.color[1] / 255.0, one.color[2] / 255.0};
  return tint_of(VoxelLabel::bone, 1.0f);
}

/// Smooths colours over a voxel along one axis ([1 2 1] / 4): tissue borders become smooth, as by partial volume in a scan.
void fade(std::vector<Vec3f>& colors, const VoxelBox& box, std::size_t axis) {
  Vec3i step(0);
  step[axis] = 1;
  std::vector<Vec3f> out(colors.size());
  for_each_voxel(box, [&](const Vec3i& v) {
    const Vec3i before = glm::max(v - step, box.lo), after = glm::min(v + step, box.hi - 1);
    const std::size_t n = box.offset_of(v);
    out[n] = 0.25f * (colors[box.offset_of(before)] + 2.0f * colors[n] + colors[box.offset_of(after)]);
  });
  colors = std::move(out);
}

}  // namespace

std::vector<Rgba8> make_colors(const BoneModel& bone, const VoxelBox& box) {
  // A voxel depends on those next to it.
  const VoxelBox halo = box.grown(1).intersect(bone.bounds());
  std::vector<float> hardness(halo.count()), soft(box.count()), labels(halo.count());
  bone.read_hardness(halo, hardness);
  bone.read_soft(box, soft);
  bone.read_labels(halo, labels);
  std::vector<Vec3f> colors(halo.count());
  const LabelTable own = labels_of(bone.notes());
  for (std::size_t n = 0; n < colors.size(); ++n) {
    const auto label = static_cast<VoxelLabel>(static_cast<int>(labels[n]));
    const Tint tint = label >= VoxelLabel::first_user ? tint_of(label, own) : tint_of(label, hardness[n]);
    colors[n] = Vec3f(Vec3(tint.r, tint.g, tint.b));
  }
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) fade(colors, halo, axis);
  std::vector<Rgba8> out;
  out.reserve(box.count());
  std::size_t n = 0;
  for_each_voxel(box, [&](const Vec3i& v) {
    const Vec3 c(colors[halo.offset_of(v)]);
    out.push_back({to_byte(c.x), to_byte(c.y), to_byte(c.z), to_byte(static_cast<double>(soft[n++]))});
  });
  return out;
}

std::vector<TissueTexel> make_tissue(const BoneModel& bone, const VoxelBox& box) {
  std::vector<float> occupancy(box.count()), hardness(box.count()), labels(box.count());
  bone.read_occupancy(box, occupancy);
  bone.read_hardness(box, hardness);
  bone.read_labels(box, labels);
  std::vector<TissueTexel> out;
  out.reserve(box.count());
  for (std::size_t n = 0; n < occupancy.size(); ++n) {
    const auto label = static_cast<VoxelLabel>(static_cast<int>(labels[n]));
    double kind = label == VoxelLabel::dura ? 1.0 : 0.0;
    if (is_felt(label)) kind = sponginess(label, hardness[n]);
    out.push_back({to_byte(static_cast<double>(occupancy[n])), to_byte(kind)});
  }
  return out;
}

}  // namespace burrhole
