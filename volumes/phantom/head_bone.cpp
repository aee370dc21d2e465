#include "volumes/phantom/head_bone.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "volumes/phantom/head_shape.h"
#include "volumes/phantom/skull_layers.h"

namespace burrhole {
namespace {

constexpr int kTile = 4;  // [voxels] edge of the cubes of which empty ones are not evaluated

/// [-] Largest slope of the fields of head_shape.h, with room: where one is further from 0 than this times a distance, there is no surface
/// within that distance. A test compares with all voxels evaluated.
constexpr double kSteepest = 1.3;

/// Makes the fields of one grid.
class HeadFill {
 public:
  HeadFill(const PhantomSpec& spec, const HeadShape& head, const SkullHardness& hardness, const Affine& bone_from_index)
      : spec_(spec),
        head_(head),
        hardness_(hardness),
        bone_from_index_(bone_from_index),
        pitch_(bone_from_index.mean_edge()),
        coarse_(pitch_ > 1.2 * spec.pitch) {
    // The colour of a surface is that of a voxel below it; with coarse voxels the tables are thick enough that this is not diploe.
    const double least = coarse_ ? 2.0 * pitch_ : 0.0;
    outer_ = std::max(spec.outer_table, least);
    inner_ = spec.thickness - std::max(spec.inner_table, least);
  }

  /// @returns the fields of a box, of which tiles are made on all cores.
  [[nodiscard]] DenseBone make(const VoxelBox& box) const {
    DenseBone out;
    out.dims = box.size();
    for (std::vector<float>* field : {&out.occupancy, &out.hardness, &out.soft}) field->resize(box.count());
    out.labels.resize(box.count());
    const Vec3i tiles = (out.dims + kTile - 1) / kTile;
    for_each_number(tiles.x * tiles.y * tiles.z, [&](int n) {
      const Vec3i tile(n % tiles.x, n / tiles.x % tiles.y, n / (tiles.x * tiles.y));
      const Vec3i lo = box.lo + kTile * tile;
      fill(VoxelBox{lo, lo + kTile}.intersect(box), box, out);
    });
    return out;
  }

 private:
  void fill(const VoxelBox& tile, const VoxelBox& box, DenseBone& out) const {
    const HeadFields middle = head_.at(bone_from_index_ * (0.5 * Vec3(tile.lo + tile.hi - 1)));
    // Half a diagonal, and the width of the ramp.
    const double reach = kSteepest * pitch_ * std::sqrt(3.0) * (0.5 * (kTile - 1) + 1.0);
    if (middle.bone.value > reach && middle.cavity.value > reach) return;
    if (middle.bone.value > reach && middle.cavity.value < -reach - spec_.dura) {
      for_each_voxel(tile, [&](const Vec3i& v) {
        const std::size_t at = box.offset_of(v);
        out.soft[at] = 1.0f;
        out.labels[at] = static_cast<std::uint8_t>(VoxelLabel::brain);
      });
      return;
    }
    for_each_voxel(tile, [&](const Vec3i& v) { fill(v, box.offset_of(v), out); });
  }

  /// The ramp of phantom.h, 0.5 - d / (2 w). d is the field over the length of its gradient, w the sum of the gradient's components along
  /// the grid's axes over the same length, which cancels.
  [[nodiscard]] double ramp(const HeadField& field) const {
    const Vec3 along = field.slope * bone_from_index_.linear;
    const double sum = std::abs(along.x) + std::abs(along.y) + std::abs(along.z);
    return std::clamp(0.5 - field.value / (2.0 * std::max(sum, 1e-12)), 0.0, 1.0);
  }

  void fill(const Vec3i& v, std::size_t at, DenseBone& out) const {
    const Vec3 p = bone_from_index_ * Vec3(v);
    const HeadFields fields = head_.at(p);
    const double occupancy = ramp(fields.bone), soft = std::min(1.0 - occupancy, ramp(fields.cavity));
    out.occupancy[at] = static_cast<float>(occupancy);
    out.soft[at] = static_cast<float>(soft);
    if (occupancy > 0.0) out.hardness[at] = static_cast<float>(hardness_at(p, -fields.outer));
    out.labels[at] = static_cast<std::uint8_t>(label_of(fields.bone.value, fields.cavity.value, -fields.outer));
  }

  [[nodiscard]] double hardness_at(const Vec3& p, double depth) const {
    return !coarse_ || (depth > outer_ && depth < inner_) ? hardness_.at(p, depth) : spec_.table_hardness;
  }

  [[nodiscard]] VoxelLabel label_of(double bone, double cavity, double depth) const {
    if (bone <= 0.0) {
      if (depth <= outer_) return VoxelLabel::outer_table;
      return depth <= inner_ ? VoxelLabel::diploe : VoxelLabel::inner_table;
    }
    if (cavity > 0.0) return VoxelLabel::none;
    return -cavity <= spec_.dura ? VoxelLabel::dura : VoxelLabel::brain;
  }

  const PhantomSpec& spec_;
  const HeadShape& head_;
  const SkullHardness& hardness_;
  Affine bone_from_index_;
  double pitch_;
  bool coarse_;
  double outer_ = 0.0, inner_ = 0.0;  // [m] depths between which there is diploe
};

/// Adds a part of a grid slab by slab, so that it is never in memory as dense fields.
Result<std::shared_ptr<const BoneModel>> build(const HeadFill& fill, const Vec3i& dims, const Affine& bone_from_index, const VoxelBox& part,
                                               const BoneStorage& storage, std::shared_ptr<const Surroundings> surroundings) {
  auto builder = BoneModelBuilder::create(dims, bone_from_index, storage);
  if (!builder) return builder.error();
  constexpr int kSlab = 4 * kTile;
  for (int k = part.lo.z; k < part.hi.z; k += kSlab) {
    const VoxelBox slab{{part.lo.x, part.lo.y, k}, {part.hi.x, part.hi.y, std::min(k + kSlab, part.hi.z)}};
    if (const Status added = builder->add(slab, fill.make(slab)); !added) return added.error();
  }
  builder->surround(std::move(surroundings));
  return builder->finish();
}

}  // namespace

HeadGrid head_grid(const PhantomSpec& spec) {
  HeadGrid out;
  out.factor = std::max(2, static_cast<int>(std::round(spec.surroundings / spec.pitch)));
  const double edge = out.factor * spec.pitch;
  const Mat3 axes = glm::mat3_cast(rotation_from_z(-spec.head_axis));
  const auto cells = [&](double length) { return static_cast<int>(std::ceil(length / edge - 1e-6)); };
  // Room for skin and cloth, which pictures add.
  constexpr double kRoom = 14e-3;
  // Near its faces a region is drawn as the coarse head is, see DetailGrid; the surface is to lie further inside.
  const int above = 7, below = std::max(1, cells(spec.region.z) - above);
  const Vec3i half(std::max(1, cells(0.5 * spec.region.x)), std::max(1, cells(0.5 * spec.region.y)), 0);
  const Vec3i down(half.x, half.y, below), up(half.x, half.y, above);
  Vec3i before(0), after(0);  // [coarse voxels] from the entry to the faces of the grid
  for (int a = 0; a < 3; ++a) {
    const double entry = glm::dot(axes[a], spec.head_entry);
    before[a] = std::max(down[a] + 1, cells(HeadShape::reach(-axes[a]) + entry + kRoom));
    after[a] = std::max(up[a] + 1, cells(HeadShape::reach(axes[a]) - entry + kRoom));
  }
  out.coarse_dims = before + after + 1;
  out.dims = out.factor * (before + after) + 1;
  out.region = {out.factor * (before - down), out.factor * (before + up) + 1};
  const Mat3 linear = axes * spec.pitch;
  out.bone_from_index = {linear, spec.head_entry - linear * Vec3(out.factor * before)};
  return out;
}

Result<std::shared_ptr<const BoneModel>> make_head_bone(const PhantomSpec& spec, const BoneStorage& storage) {
  const Issues issues = validate(spec);
  if (!issues.empty()) return issues.front();
  const HeadGrid grid = head_grid(spec);
  const HeadShape head(spec.thickness);
  const SkullHardness hardness(spec);
  const Affine coarse{grid.bone_from_index.linear * static_cast<double>(grid.factor), grid.bone_from_index.offset};
  auto around = build(HeadFill(spec, head, hardness, coarse), grid.coarse_dims, coarse, {Vec3i(0), grid.coarse_dims}, {}, nullptr);
  if (!around) return around.error();
  auto surroundings = std::make_shared<Surroundings>(Surroundings{*around, grid.factor, grid.region});
  return build(HeadFill(spec, head, hardness, grid.bone_from_index), grid.dims, grid.bone_from_index, grid.region, storage,
               std::move(surroundings));
}

}  // namespace burrhole
