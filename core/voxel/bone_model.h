/// core/voxel/bone_model.h: bone as loaded, constant: occupancy, hardness, soft tissue and tissue labels of one scan.
///   Frame   bone frame (LPS at load); bone_from_index is a full affine; voxel centres at integer indices, i fastest.
///   Units   occupancy 0..1 (share of bone in the voxel; the 0.5 level is the surface), hardness 0..1 (relative mineral density).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/voxel/block_store.h"
#include "core/voxel/bone_file.h"

namespace burrhole {

/// Tissue of a voxel, stored in a separate grid. It is not a colour and is not derived from density at run time.
enum class VoxelLabel : std::uint8_t {
  none = 0,
  bone = 1,
  outer_table = 2,
  diploe = 3,
  inner_table = 4,
  dura = 5,
  brain = 6,
  forbidden = 7,
  soft_tissue = 8,  ///< outside the skull, within a few millimetres; air is `none`
  first_user = 16   ///< this number and those above are labels of the user, with names and colours: label_table.h
};
inline constexpr std::size_t kVoxelLabels = 8;  ///< that have a factor of their own

/// @returns whether the tissue exerts contact forces: bone of any kind. A label of the user counts as bone where there is bone.
[[nodiscard]] constexpr bool is_felt(VoxelLabel label) noexcept {
  return label != VoxelLabel::none && label != VoxelLabel::dura && label != VoxelLabel::brain && label != VoxelLabel::soft_tissue;
}

/// A factor for each label, in the order of VoxelLabel.
using LabelFactors = std::array<float, kVoxelLabels>;
inline constexpr LabelFactors kAllAlike{1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f};

/// @returns the factor of a label; that of `bone` for labels that have none of their own.
[[nodiscard]] constexpr float factor_of(const LabelFactors& factors, VoxelLabel label) noexcept {
  const auto n = static_cast<std::size_t>(label);
  return factors[n < kVoxelLabels ? n : static_cast<std::size_t>(VoxelLabel::bone)];
}

/// Dense fields, as created by phantoms and file readers. All vectors hold dims.x*dims.y*dims.z values, i fastest.
struct DenseBone {
  Vec3i dims{0};
  Affine bone_from_index;            ///< [m]
  std::vector<float> occupancy;      ///< [-] 0..1
  std::vector<float> hardness;       ///< [-] 0..1
  std::vector<float> soft;           ///< [-] 0..1 occupancy of dura and brain: drawn and labelled, no contact or erosion; may be empty
  std::vector<std::uint8_t> labels;  ///< VoxelLabel
};

class FloatVdb;

class PagedBone;

class BoneModel;

/// What pictures show of a body of which the bone is a part: the rest is drawn, but not felt, drilled or saved.
struct Surroundings {
  /// All of the body, the part included, at every `factor`-th voxel of the bone from voxel 0 on.
  std::shared_ptr<const BoneModel> coarse;
  int factor = 1;   ///< [voxels] of the bone, edge of a coarse voxel
  VoxelBox region;  ///< [voxels] of the bone, which holds none outside; region.lo and region.hi - 1 are multiples of factor
};

/// Bone as loaded, in sparse OpenVDB grids, or in a temporary file (a paged bone). Constant, so any number of threads may read it. There is no
/// bone outside the grid.
class BoneModel {
 public:
  /// bad_input when sizes disagree, dims are not positive, the affine is singular, or a value is not finite or outside 0..1; errors of
  /// bone_file.h.
  [[nodiscard]] static Result<std::shared_ptr<const BoneModel>> create(const DenseBone& dense, const BoneStorage& storage = {});
  /// Reads a file written by Voxmap::save. Its `remaining` becomes drilled(): a voxmap of the bone starts with it. bad_input: see
  /// read_vdb(); a `remaining` outside 0..1 or not finite.
  [[nodiscard]] static Result<std::shared_ptr<const BoneModel>> load(const std::string& path);
  ~BoneModel();

  [[nodiscard]] const Vec3i& dims() const noexcept { return dims_; }
  [[nodiscard]] VoxelBox bounds() const noexcept { return {Vec3i(0), dims_}; }
  [[nodiscard]] const Affine& bone_from_index() const noexcept { return bone_from_index_; }
  [[nodiscard]] std::size_t bone_voxels() const noexcept { return bone_voxels_; }  ///< occupancy >= 0.5
  [[nodiscard]] const VoxelBox& bone_box() const noexcept { return bone_box_; }    ///< bounding box of these voxels
  /// Assumptions made by the import of the scan, one per line; saved with the bone.
  [[nodiscard]] const std::string& notes() const noexcept { return notes_; }
  [[nodiscard]] std::size_t bytes() const;  ///< in memory, without the surroundings
  /// Blocks of `remaining` of a bone that was drilled before it was saved; null: it was not. The other fields are those before drilling.
  [[nodiscard]] const BlockStore* drilled() const noexcept { return drilled_.get(); }
  /// What is drawn around the bone; null if it is drawn alone.
  [[nodiscard]] const Surroundings* surroundings() const noexcept { return surroundings_.get(); }
  /// @returns bytes(); of a paged bone about what they would be in memory.
  [[nodiscard]] std::size_t bytes_in_memory() const;
  /// @returns the bytes of the temporary file of a paged bone; nothing for a bone in memory.
  [[nodiscard]] std::optional<std::uint64_t> file_bytes() const;
  /// @returns the error of the first read of a paged bone that failed. From then on what is read may be 0. A bone in memory has none.
  [[nodiscard]] Status read_status() const;
  /// Becomes true at the first read of a paged bone that fails; null for a bone in memory.
  [[nodiscard]] const std::atomic<bool>* read_failed() const noexcept;
  /// @returns a paged bone of the same voxels. Errors of bone_file.h.   @pre this bone is in memory.
  [[nodiscard]] Result<std::shared_ptr<const BoneModel>> paged(const BoneStorage& storage) const;
  /// Calls f for boxes that together hold all voxels with an occupancy above 0; each holds at least one. Unordered.
  void for_each_region(const std::function<void(const VoxelBox&)>& f) const;
  /// The same for all voxels with an occupancy of bone or soft tissue above 0; boxes of the two may overlap.
  void for_each_drawn_region(const std::function<void(const VoxelBox&)>& f) const;
  // Dense copies of a box, i fastest; the box may reach outside the grid, where all fields are 0.
  void read_occupancy(const VoxelBox& box, std::span<float> out) const;
  void read_density(const VoxelBox& box, std::span<float> out) const;  ///< occupancy x remaining of drilled()
  void read_hardness(const VoxelBox& box, std::span<float> out) const;
  void read_soft(const VoxelBox& box, std::span<float> out) const;
  void read_labels(const VoxelBox& box, std::span<float> out) const;  ///< VoxelLabel as a number
  [[nodiscard]] VoxelLabel label(const Vec3i& v) const;
  [[nodiscard]] float occupancy(const Vec3i& v) const;
  /// @returns the grids to be written to a file; none of a paged bone.
  [[nodiscard]] std::vector<const FloatVdb*> grids() const;

 private:
  friend class BoneModelBuilder;
  struct Grids;
  /// One of the two is there.
  struct Fields {
    std::unique_ptr<Grids> grids;
    std::unique_ptr<PagedBone> pages;
    Fields() noexcept;
    Fields(Fields&&) noexcept;
    ~Fields();
    [[nodiscard]] std::size_t bytes() const;
  };
  BoneModel(const Vec3i& dims, const Affine& bone_from_index, Fields fields, std::string notes);
  Vec3i dims_;
  Affine bone_from_index_;
  Fields fields_;
  std::size_t bone_voxels_ = 0;
  VoxelBox bone_box_;
  std::string notes_;
  std::shared_ptr<const Surroundings> surroundings_;
  std::shared_ptr<const BlockStore> drilled_;
};

/// Builds a bone model box by box, so that a large scan need not be in memory as dense fields.   Thread  one.
class BoneModelBuilder {
 public:
  /// bad_input when dims are not positive or the affine is singular or not finite; errors of bone_file.h.
  [[nodiscard]] static Result<BoneModelBuilder> create(const Vec3i& dims, const Affine& bone_from_index, const BoneStorage& storage = {});
  BoneModelBuilder(BoneModelBuilder&&) noexcept;
  ~BoneModelBuilder();

  /// Adds the fields of one box, in any order of boxes. `fields.dims` is the size of the box; `fields.bone_from_index` is ignored.
  /// As BoneModel::create; bad_input also if the box is not inside the grid.
  [[nodiscard]] Status add(const VoxelBox& box, const DenseBone& fields);
  [[nodiscard]] std::size_t bytes() const;
  /// Sets what is drawn around the bone; may be null.
  void surround(std::shared_ptr<const Surroundings> surroundings) noexcept { surroundings_ = std::move(surroundings); }
  /// Sets BoneModel::drilled(); may be null.
  void start_from(std::shared_ptr<const BlockStore> drilled) noexcept { drilled_ = std::move(drilled); }
  /// @returns the model; the builder is empty afterwards.
  [[nodiscard]] std::shared_ptr<const BoneModel> finish(std::string notes = {});

 private:
  BoneModelBuilder(const Vec3i& dims, const Affine& bone_from_index);
  Vec3i dims_;
  Affine bone_from_index_;
  BoneModel::Fields fields_;
  std::shared_ptr<const Surroundings> surroundings_;
  std::shared_ptr<const BlockStore> drilled_;
};

}  // namespace burrhole
