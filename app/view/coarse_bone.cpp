#include "app/view/coarse_bone.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/voxel/box_parts.h"

namespace burrhole {
namespace {

constexpr int kTile = 16;  // [coarse voxels] along an edge of the parts in which a bone is made coarser

/// The voxels of the bone on which the coarse voxels of a box depend.
VoxelBox support_of(const VoxelBox& coarse, int factor) { return {factor * coarse.lo - (factor - 1), factor * (coarse.hi - 1) + factor}; }

/// One axis of the weighted mean: `from` holds, for each of `outer` lines, values at `inner` places each, of which the line takes every
/// `factor`-th one.
void mean_along(std::size_t outer, std::size_t inner, std::size_t count, int factor, const std::vector<float>& from,
                std::vector<float>& to) {
  const std::size_t long_line = (count - 1) * static_cast<std::size_t>(factor) + 2 * static_cast<std::size_t>(factor) - 1;
  to.assign(outer * count * inner, 0.0f);
  const float scale = 1.0f / static_cast<float>(factor * factor);
  for (std::size_t line = 0; line < outer; ++line)
    for (std::size_t n = 0; n < count; ++n) {
      float* sum = to.data() + (line * count + n) * inner;
      for (int d = 1 - factor; d < factor; ++d) {
        const float weight = scale * static_cast<float>(factor - std::abs(d));
        const float* value =
            from.data() + (line * long_line + n * static_cast<std::size_t>(factor) + static_cast<std::size_t>(d + factor - 1)) * inner;
        for (std::size_t i = 0; i < inner; ++i) sum[i] += weight * value[i];
      }
    }
}

/// @param values over support_of(coarse). @returns the means, over `coarse`.
std::vector<float> mean_over(const VoxelBox& coarse, int factor, std::vector<float> values) {
  const Vec3i size = coarse.size(), support = support_of(coarse, factor).size();
  const auto count = [](int n) { return static_cast<std::size_t>(n); };
  std::vector<float> next;
  mean_along(count(support.y) * count(support.z), 1, count(size.x), factor, values, next);
  mean_along(count(support.z), count(size.x), count(size.y), factor, next, values);
  mean_along(1, count(size.x) * count(size.y), count(size.z), factor, values, next);
  for (float& value : next) value = std::min(value, 1.0f);  // the weights add up to 1, except for rounding
  return next;
}

/// The label of a coarse voxel is that of the bone's voxel there; where that has none, the label of the one that adds most to the mean.
std::uint8_t label_at(const Vec3i& centre, int factor, const VoxelBox& support, const std::vector<float>& share,
                      const std::vector<float>& labels) {
  const float own = labels[support.offset_of(centre)];
  if (own != 0.0f) return static_cast<std::uint8_t>(own);
  float most = 0.0f, label = 0.0f;
  for_each_voxel({centre - (factor - 1), centre + factor}, [&](const Vec3i& v) {
    const Vec3i weight = factor - glm::abs(v - centre);
    const float adds = static_cast<float>(weight.x * weight.y * weight.z) * share[support.offset_of(v)];
    if (adds > most && labels[support.offset_of(v)] != 0.0f) {
      most = adds;
      label = labels[support.offset_of(v)];
    }
  });
  return static_cast<std::uint8_t>(label);
}

DenseBone make_part(const BoneModel& bone, const VoxelBox& coarse, int factor) {
  const VoxelBox support = support_of(coarse, factor);
  std::vector<float> occupancy(support.count()), hardness(support.count()), soft(support.count()), labels(support.count());
  bone.read_density(support, occupancy);
  bone.read_hardness(support, hardness);
  bone.read_soft(support, soft);
  bone.read_labels(support, labels);
  std::vector<float> mineral(support.count()), share(support.count());
  for (std::size_t n = 0; n < mineral.size(); ++n) {
    mineral[n] = occupancy[n] * hardness[n];
    share[n] = occupancy[n] + soft[n];
  }
  DenseBone out;
  out.dims = coarse.size();
  out.occupancy = mean_over(coarse, factor, std::move(occupancy));
  out.hardness = mean_over(coarse, factor, std::move(mineral));
  out.soft = mean_over(coarse, factor, std::move(soft));
  out.labels.resize(coarse.count());
  std::size_t n = 0;
  for_each_voxel(coarse, [&](const Vec3i& v) {
    const float bone_share = out.occupancy[n];
    out.hardness[n] = bone_share > 0.0f ? std::min(out.hardness[n] / bone_share, 1.0f) : 0.0f;
    if (bone_share + out.soft[n] > 0.0f) out.labels[n] = label_at(factor * v, factor, support, share, labels);
    ++n;
  });
  return out;
}

/// The parts of tiles that hold bone or soft tissue, in a fixed order. The rest of a tile is empty, and thin bone fills little of it.
std::vector<VoxelBox> find_parts(const BoneModel& bone, const CoarseBone& grid, const VoxelBox& all) {
  std::map<std::tuple<int, int, int>, VoxelBox> found;
  bone.for_each_drawn_region([&](const VoxelBox& region) {
    const VoxelBox coarse = grid.coarse_of(region).intersect(all);
    for_each_voxel({coarse.lo / kTile, (coarse.hi - 1) / kTile + 1}, [&](const Vec3i& t) {
      VoxelBox& part = found[{t.z, t.y, t.x}];
      part = part.unite(VoxelBox{kTile * t, kTile * (t + 1)}.intersect(coarse));
    });
  });
  std::vector<VoxelBox> out;
  out.reserve(found.size());
  for (const auto& [tile, part] : found) out.push_back(part);
  return out;
}

}  // namespace

Result<CoarseBone> CoarseBone::create(const BoneModel& bone, int factor) {
  BH_ASSERT(factor >= 2);
  const Vec3i dims = dims_of(bone.dims(), factor);
  const Affine& fine = bone.bone_from_index();
  auto builder = BoneModelBuilder::create(dims, {fine.linear * static_cast<double>(factor), fine.offset});
  if (!builder) return builder.error();
  const std::vector<VoxelBox> parts = find_parts(bone, CoarseBone(nullptr, factor), {Vec3i(0), dims});
  constexpr std::size_t kBatch = 64;  // in memory at a time
  for (std::size_t first = 0; first < parts.size(); first += kBatch) {
    std::vector<DenseBone> made(std::min(kBatch, parts.size() - first));
    for_each_number(static_cast<int>(made.size()), [&](int n) {
      const auto at = static_cast<std::size_t>(n);
      made[at] = make_part(bone, parts[first + at], factor);
    });
    for (std::size_t n = 0; n < made.size(); ++n)
      if (const Status added = builder->add(parts[first + n], made[n]); !added) return added.error();
  }
  return CoarseBone(builder->finish(bone.notes()), factor);
}

VoxelBox CoarseBone::coarse_of(const VoxelBox& box) const noexcept {
  // Coarse voxel I depends on the voxels v with |factor I - v| < factor.
  const auto floor_of = [this](const Vec3i& v) { return Vec3i(glm::floor(Vec3(v) / static_cast<double>(factor_))); };
  return {floor_of(box.lo), floor_of(box.hi - 1 + factor_ - 1) + 1};
}

void CoarseBone::read_density(const Voxmap& voxmap, const VoxelBox& coarse, std::span<float> out) const {
  BH_ASSERT(out.size() == coarse.count());
  loaded_->read_occupancy(coarse, out);
  std::vector<float> part_values, values;
  const VoxelBox tiles{Vec3i(glm::floor(Vec3(coarse.lo) / double{kTile})), Vec3i(glm::floor(Vec3(coarse.hi - 1) / double{kTile})) + 1};
  for_each_voxel(tiles, [&](const Vec3i& tile) {
    const VoxelBox part = VoxelBox{kTile * tile, kTile * (tile + 1)}.intersect(coarse), support = support_of(part, factor_);
    if (voxmap.is_as_loaded(support)) return;
    values.resize(support.count());
    voxmap.read_density(support, values);
    if (surrounds_) return subtract_removed(voxmap.bone(), part, std::move(values), coarse, out);
    part_values = mean_over(part, factor_, values);
    copy_part(part, part, part_values.data(), coarse, out.data());
  });
}

void CoarseBone::subtract_removed(const BoneModel& bone, const VoxelBox& part, std::vector<float> density, const VoxelBox& coarse,
                                  std::span<float> out) const {
  const VoxelBox support = support_of(part, factor_);
  std::vector<float> removed(support.count());
  bone.read_density(support, removed);
  for (std::size_t n = 0; n < removed.size(); ++n) removed[n] = std::max(removed[n] - density[n], 0.0f);
  const std::vector<float> mean = mean_over(part, factor_, std::move(removed));
  std::size_t n = 0;
  for_each_voxel(part, [&](const Vec3i& v) {
    float& left = out[coarse.offset_of(v)];
    left = std::max(left - mean[n++], 0.0f);
  });
}

DrawnBone CoarseBone::drawn(const Voxmap& voxmap) const {
  return {loaded_.get(), [this, &voxmap](const VoxelBox& box, std::span<float> out) { read_density(voxmap, box, out); },
          voxmap.config().gradient_dead_zone};
}

}  // namespace burrhole
