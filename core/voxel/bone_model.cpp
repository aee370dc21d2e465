#include "core/voxel/bone_model.h"

#include <cmath>

#include "core/base/parallel.h"
#include "core/voxel/vdb_grids.h"

namespace burrhole {

struct BoneModel::Grids {
  FloatVdb occupancy{"occupancy", 0.0f};
  FloatVdb hardness{"hardness", 0.0f};
  FloatVdb soft{"soft", 0.0f};
  FloatVdb labels{"labels", 0.0f};  // small integers, exact in float: one grid type keeps OpenVDB in few files
};

namespace {

/// Coplanar edges leave a determinant of rounding, not 0: the volume is judged against that of the box with the same edges.
bool is_usable(const Affine& bone_from_index) {
  constexpr double kFlattest = 1e-9;
  const Mat3& edges = bone_from_index.linear;
  const double box = glm::length(edges[0]) * glm::length(edges[1]) * glm::length(edges[2]);
  return std::isfinite(box) && is_finite(bone_from_index.offset) && bone_from_index.cell_volume() > kFlattest * box;
}

Status check_field(const std::vector<float>& field, std::size_t count, const char* name) {
  if (field.size() != count)
    return bad_input(std::string(name) + " holds " + std::to_string(field.size()) + " voxels, dims ask for " + std::to_string(count));
  for (const float value : field)
    if (!(value >= 0.0f && value <= 1.0f)) return bad_input(std::string(name) + " holds a value outside 0..1 or not finite");
  return {};
}

}  // namespace

BoneModel::BoneModel(const Vec3i& dims, const Affine& bone_from_index, std::unique_ptr<Grids> grids, std::string notes)
    : dims_(dims), bone_from_index_(bone_from_index), grids_(std::move(grids)), notes_(std::move(notes)) {
  const FloatVdb::Part bone = grids_->occupancy.part_from(0.5f);
  bone_voxels_ = bone.voxels;
  bone_box_ = bone.box;
}
BoneModel::~BoneModel() = default;

Result<std::shared_ptr<const BoneModel>> BoneModel::create(const DenseBone& dense) {
  auto builder = BoneModelBuilder::create(dense.dims, dense.bone_from_index);
  if (!builder) return builder.error();
  if (const Status added = builder->add({Vec3i(0), dense.dims}, dense); !added) return added.error();
  return builder->finish();
}

Result<BoneModelBuilder> BoneModelBuilder::create(const Vec3i& dims, const Affine& bone_from_index) {
  if (VoxelBox{Vec3i(0), dims}.empty()) return bad_input("the volume has no voxels");
  if (!is_usable(bone_from_index)) return bad_input("the voxel-to-bone map is singular or not finite");
  return BoneModelBuilder(dims, bone_from_index);
}

BoneModelBuilder::BoneModelBuilder(const Vec3i& dims, const Affine& bone_from_index)
    : dims_(dims), bone_from_index_(bone_from_index), grids_(std::make_unique<BoneModel::Grids>()) {}
BoneModelBuilder::BoneModelBuilder(BoneModelBuilder&&) noexcept = default;
BoneModelBuilder::~BoneModelBuilder() = default;

Status BoneModelBuilder::add(const VoxelBox& box, const DenseBone& fields) {
  if (!VoxelBox{Vec3i(0), dims_}.contains(box)) return bad_input("a part of the volume lies outside it");
  for (const auto& [field, name] : {std::pair{&fields.occupancy, "occupancy"}, std::pair{&fields.hardness, "hardness"}})
    if (const Status status = check_field(*field, box.count(), name); !status) return status;
  if (!fields.soft.empty())
    if (const Status status = check_field(fields.soft, box.count(), "soft"); !status) return status;
  if (!fields.labels.empty() && fields.labels.size() != box.count()) return bad_input("labels and dims disagree");

  // Each grid on a core of its own.
  constexpr std::size_t kLeast = 50'000;  // [voxels] for which a thread is worth starting
  for_each_number(4, box.count() / kLeast + 1, [&](int n) {
    if (n == 0) grids_->occupancy.write_box(box, fields.occupancy);
    if (n == 1) grids_->hardness.write_box(box, fields.hardness);
    if (n == 2 && !fields.soft.empty()) grids_->soft.write_box(box, fields.soft);
    if (n == 3 && !fields.labels.empty()) grids_->labels.write_box(box, std::vector<float>(fields.labels.begin(), fields.labels.end()));
  });
  return {};
}

std::size_t BoneModelBuilder::bytes() const {
  return grids_->occupancy.bytes() + grids_->hardness.bytes() + grids_->soft.bytes() + grids_->labels.bytes();
}

std::shared_ptr<const BoneModel> BoneModelBuilder::finish(std::string notes) {
  return std::shared_ptr<const BoneModel>(new BoneModel(dims_, bone_from_index_, std::move(grids_), std::move(notes)));
}

Result<std::shared_ptr<const BoneModel>> BoneModel::load(const std::string& path) {
  auto content = read_vdb(path);
  if (!content) return content.error();
  auto grids = std::make_unique<Grids>();
  int found = 0;
  for (FloatVdb& grid : content->grids) {
    for (FloatVdb* slot : {&grids->occupancy, &grids->hardness, &grids->soft, &grids->labels}) {
      if (grid.name() != slot->name()) continue;
      *slot = std::move(grid);
      ++found;
      break;
    }
  }
  if (found != 4 || VoxelBox{Vec3i(0), content->dims}.empty())
    return bad_input("is not a bone model: grids occupancy, hardness, soft and labels are needed", path);
  return std::shared_ptr<const BoneModel>(
      new BoneModel(content->dims, content->bone_from_index, std::move(grids), std::move(content->notes)));
}

std::size_t BoneModel::bytes() const {
  return grids_->occupancy.bytes() + grids_->hardness.bytes() + grids_->soft.bytes() + grids_->labels.bytes();
}
void BoneModel::for_each_region(const std::function<void(const VoxelBox&)>& f) const { grids_->occupancy.for_each_region(f); }
void BoneModel::for_each_drawn_region(const std::function<void(const VoxelBox&)>& f) const {
  grids_->occupancy.for_each_region(f);
  grids_->soft.for_each_region(f);
}
void BoneModel::read_occupancy(const VoxelBox& box, std::span<float> out) const { grids_->occupancy.read_box(box, out); }
void BoneModel::read_hardness(const VoxelBox& box, std::span<float> out) const { grids_->hardness.read_box(box, out); }
void BoneModel::read_soft(const VoxelBox& box, std::span<float> out) const { grids_->soft.read_box(box, out); }
void BoneModel::read_labels(const VoxelBox& box, std::span<float> out) const { grids_->labels.read_box(box, out); }
VoxelLabel BoneModel::label(const Vec3i& v) const { return static_cast<VoxelLabel>(static_cast<int>(grids_->labels.value(v))); }
float BoneModel::occupancy(const Vec3i& v) const { return grids_->occupancy.value(v); }
std::vector<const FloatVdb*> BoneModel::grids() const { return {&grids_->occupancy, &grids_->hardness, &grids_->soft, &grids_->labels}; }

}  // namespace burrhole
