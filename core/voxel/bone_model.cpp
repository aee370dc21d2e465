#include "core/voxel/bone_model.h"

#include <cmath>

#include "core/base/parallel.h"
#include "core/voxel/paged_bone.h"
#include "core/voxel/saved_remaining.h"
#include "core/voxel/vdb_grids.h"

namespace burrhole {

struct BoneModel::Grids {
  FloatVdb occupancy{"occupancy", 0.0f};
  FloatVdb hardness{"hardness", 0.0f};
  FloatVdb soft{"soft", 0.0f};
  FloatVdb labels{"labels", 0.0f};  // small integers, exact in float: one grid type keeps OpenVDB in few files

  [[nodiscard]] std::size_t bytes() const { return occupancy.bytes() + hardness.bytes() + soft.bytes() + labels.bytes(); }
};

BoneModel::Fields::Fields() noexcept = default;
BoneModel::Fields::Fields(Fields&&) noexcept = default;
BoneModel::Fields::~Fields() = default;
std::size_t BoneModel::Fields::bytes() const { return (grids ? grids->bytes() : 0) + (pages ? pages->bytes() : 0); }

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

BoneModel::BoneModel(const Vec3i& dims, const Affine& bone_from_index, Fields fields, std::string notes)
    : dims_(dims), bone_from_index_(bone_from_index), fields_(std::move(fields)), notes_(std::move(notes)) {
  constexpr float kBone = 0.5f;
  const auto take = [&](const auto& bone) {
    bone_voxels_ = bone.voxels;
    bone_box_ = bone.box;
  };
  fields_.pages ? take(fields_.pages->bone()) : take(fields_.grids->occupancy.part_from(kBone));
}
BoneModel::~BoneModel() = default;

Result<std::shared_ptr<const BoneModel>> BoneModel::create(const DenseBone& dense, const BoneStorage& storage) {
  auto builder = BoneModelBuilder::create(dense.dims, dense.bone_from_index, storage);
  if (!builder) return builder.error();
  if (const Status added = builder->add({Vec3i(0), dense.dims}, dense); !added) return added.error();
  return builder->finish();
}

Result<BoneModelBuilder> BoneModelBuilder::create(const Vec3i& dims, const Affine& bone_from_index, const BoneStorage& storage) {
  if (VoxelBox{Vec3i(0), dims}.empty()) return bad_input("the volume has no voxels");
  if (!is_usable(bone_from_index)) return bad_input("the voxel-to-bone map is singular or not finite");
  BoneModelBuilder out(dims, bone_from_index);
  if (storage.is_paged()) {
    auto pages = PagedBone::create(dims, storage);
    if (!pages) return pages.error();
    out.fields_.pages = std::move(pages).value();
  } else {
    out.fields_.grids = std::make_unique<BoneModel::Grids>();
  }
  return out;
}

BoneModelBuilder::BoneModelBuilder(const Vec3i& dims, const Affine& bone_from_index) : dims_(dims), bone_from_index_(bone_from_index) {}
BoneModelBuilder::BoneModelBuilder(BoneModelBuilder&&) noexcept = default;
BoneModelBuilder::~BoneModelBuilder() = default;

Status BoneModelBuilder::add(const VoxelBox& box, const DenseBone& fields) {
  if (!VoxelBox{Vec3i(0), dims_}.contains(box)) return bad_input("a part of the volume lies outside it");
  for (const auto& [field, name] : {std::pair{&fields.occupancy, "occupancy"}, std::pair{&fields.hardness, "hardness"}})
    if (const Status status = check_field(*field, box.count(), name); !status) return status;
  if (!fields.soft.empty())
    if (const Status status = check_field(fields.soft, box.count(), "soft"); !status) return status;
  if (!fields.labels.empty() && fields.labels.size() != box.count()) return bad_input("labels and dims disagree");
  if (fields_.pages) return fields_.pages->write(box, {{fields.occupancy, fields.hardness, fields.soft}, fields.labels});

  // Each grid on a core of its own.
  BoneModel::Grids& grids = *fields_.grids;
  constexpr std::size_t kLeast = 50'000;  // [voxels] for which a thread is worth starting
  for_each_number(4, box.count() / kLeast + 1, [&](int n) {
    if (n == 0) grids.occupancy.write_box(box, fields.occupancy);
    if (n == 1) grids.hardness.write_box(box, fields.hardness);
    if (n == 2 && !fields.soft.empty()) grids.soft.write_box(box, fields.soft);
    if (n == 3 && !fields.labels.empty()) grids.labels.write_box(box, std::vector<float>(fields.labels.begin(), fields.labels.end()));
  });
  return {};
}

std::size_t BoneModelBuilder::bytes() const { return fields_.bytes(); }

std::shared_ptr<const BoneModel> BoneModelBuilder::finish(std::string notes) {
  std::shared_ptr<BoneModel> out(new BoneModel(dims_, bone_from_index_, std::move(fields_), std::move(notes)));
  out->surroundings_ = std::move(surroundings_);
  out->drilled_ = std::move(drilled_);
  return out;
}

Result<std::shared_ptr<const BoneModel>> BoneModel::load(const std::string& path) {
  auto content = read_vdb(path);
  if (!content) return content.error();
  Fields fields;
  fields.grids = std::make_unique<Grids>();
  const auto& grids = fields.grids;
  int found = 0;
  const FloatVdb* remaining = nullptr;
  for (FloatVdb& grid : content->grids) {
    if (grid.name() == kRemainingGrid) remaining = &grid;
    for (FloatVdb* slot : {&grids->occupancy, &grids->hardness, &grids->soft, &grids->labels}) {
      if (grid.name() != slot->name()) continue;
      *slot = std::move(grid);
      ++found;
      break;
    }
  }
  if (found != 4 || VoxelBox{Vec3i(0), content->dims}.empty())
    return found == 0 && remaining != nullptr
               ? bad_input("holds the changes of a bone alone, not the bone: give its source, and this file by --restore", path)
               : bad_input("is not a bone model: grids occupancy, hardness, soft and labels are needed", path);
  std::shared_ptr<BoneModel> out(new BoneModel(content->dims, content->bone_from_index, std::move(fields), std::move(content->notes)));
  if (remaining == nullptr) return std::shared_ptr<const BoneModel>(std::move(out));
  auto blocks = saved_remaining(*remaining, out->bounds(), path);
  if (!blocks) return blocks.error();
  if (blocks->size() > 0) out->drilled_ = std::make_shared<const BlockStore>(std::move(blocks).value());
  return std::shared_ptr<const BoneModel>(std::move(out));
}

Result<std::shared_ptr<const BoneModel>> BoneModel::paged(const BoneStorage& storage) const {
  auto builder = BoneModelBuilder::create(dims_, bone_from_index_, storage);
  if (!builder) return builder.error();
  const VoxelBox blocks = blocks_of(bounds());
  std::vector<bool> copied(blocks.count());  // grids have most blocks in common
  std::vector<float> labels;
  DenseBone part;
  Status status;
  const auto copy = [&](const Vec3i& block) {
    if (!status.ok() || copied[blocks.offset_of(block)]) return;
    copied[blocks.offset_of(block)] = true;
    const VoxelBox box = box_of_block(block).intersect(bounds());
    part.dims = box.size();
    for (std::vector<float>* field : {&part.occupancy, &part.hardness, &part.soft, &labels}) field->resize(box.count());
    read_occupancy(box, part.occupancy);
    read_hardness(box, part.hardness);
    read_soft(box, part.soft);
    read_labels(box, labels);
    part.labels.clear();
    for (const float label : labels) part.labels.push_back(label >= 0.0f && label <= 255.0f ? static_cast<std::uint8_t>(label) : 0);
    status = builder->add(box, part);
  };
  for (const FloatVdb* grid : grids())
    grid->for_each_region([&](const VoxelBox& region) { for_each_voxel(blocks_of(region.intersect(bounds())), copy); });
  if (!status.ok()) return status.error();
  builder->surround(surroundings_);
  builder->start_from(drilled_);
  return builder->finish(notes_);
}

std::size_t BoneModel::bytes() const { return fields_.bytes(); }
std::size_t BoneModel::bytes_in_memory() const {
  constexpr std::size_t kBlockBytes = 3 * (kBlockVoxels * sizeof(float) + 200);  // three fields, with the nodes of their grids
  return fields_.pages ? fields_.pages->blocks() * kBlockBytes : bytes();
}
std::optional<std::uint64_t> BoneModel::file_bytes() const {
  return fields_.pages ? std::optional(fields_.pages->file().size()) : std::nullopt;
}
Status BoneModel::read_status() const { return fields_.pages ? fields_.pages->status() : Status(); }
const std::atomic<bool>* BoneModel::read_failed() const noexcept { return fields_.pages ? &fields_.pages->failed() : nullptr; }

void BoneModel::for_each_region(const std::function<void(const VoxelBox&)>& f) const {
  if (fields_.pages) return fields_.pages->for_each_region(BoneField::occupancy, f);
  fields_.grids->occupancy.for_each_region(f);
}
void BoneModel::for_each_drawn_region(const std::function<void(const VoxelBox&)>& f) const {
  for_each_region(f);
  if (fields_.pages) return fields_.pages->for_each_region(BoneField::soft, f);
  fields_.grids->soft.for_each_region(f);
}
void BoneModel::read_occupancy(const VoxelBox& box, std::span<float> out) const {
  if (fields_.pages) return fields_.pages->read(BoneField::occupancy, box, out);
  fields_.grids->occupancy.read_box(box, out);
}
void BoneModel::read_density(const VoxelBox& box, std::span<float> out) const {
  read_occupancy(box, out);
  if (drilled_ == nullptr) return;
  std::vector<float> remaining(out.size());
  drilled_->read_box(box, remaining);
  for (std::size_t n = 0; n < out.size(); ++n) out[n] *= remaining[n];
}
void BoneModel::read_hardness(const VoxelBox& box, std::span<float> out) const {
  if (fields_.pages) return fields_.pages->read(BoneField::hardness, box, out);
  fields_.grids->hardness.read_box(box, out);
}
void BoneModel::read_soft(const VoxelBox& box, std::span<float> out) const {
  if (fields_.pages) return fields_.pages->read(BoneField::soft, box, out);
  fields_.grids->soft.read_box(box, out);
}
void BoneModel::read_labels(const VoxelBox& box, std::span<float> out) const {
  if (fields_.pages) return fields_.pages->read(BoneField::labels, box, out);
  fields_.grids->labels.read_box(box, out);
}
VoxelLabel BoneModel::label(const Vec3i& v) const {
  const float value = fields_.pages ? fields_.pages->value(BoneField::labels, v) : fields_.grids->labels.value(v);
  return static_cast<VoxelLabel>(static_cast<int>(value));
}
float BoneModel::occupancy(const Vec3i& v) const {
  return fields_.pages ? fields_.pages->value(BoneField::occupancy, v) : fields_.grids->occupancy.value(v);
}
std::vector<const FloatVdb*> BoneModel::grids() const {
  if (fields_.pages) return {};
  const Grids& grids = *fields_.grids;
  return {&grids.occupancy, &grids.hardness, &grids.soft, &grids.labels};
}

}  // namespace burrhole
