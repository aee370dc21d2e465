/// core/voxel/bone_model.h: bone as loaded, constant: two fields from one scan, labels apart from colours.
///   Frame   bone frame (LPS at load); bone_from_index is a full affine; voxel centres at integer indices, i fastest.
///   Units   occupancy 0..1 (is this bone? the 0.5 level is the surface), hardness 0..1 (relative mineral density).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

/// Tissue of a voxel. A grid of its own: never a colour, never derived from density at run time.
enum class VoxelLabel : std::uint8_t {
  none = 0,
  bone = 1,
  outer_table = 2,
  diploe = 3,
  inner_table = 4,
  dura = 5,
  brain = 6,
  forbidden = 7
};
inline constexpr std::size_t kVoxelLabels = 8;

/// Whether the tissue is felt: bone of any kind.
[[nodiscard]] constexpr bool is_felt(VoxelLabel label) noexcept {
  return label != VoxelLabel::none && label != VoxelLabel::dura && label != VoxelLabel::brain;
}

/// A factor for each label, in the order of VoxelLabel.
using LabelFactors = std::array<float, kVoxelLabels>;
inline constexpr LabelFactors kAllAlike{1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f};

/// Dense fields as phantoms and readers make them. All vectors hold dims.x*dims.y*dims.z values, i fastest.
struct DenseBone {
  Vec3i dims{0};
  Affine bone_from_index;            ///< [m]
  std::vector<float> occupancy;      ///< 0..1
  std::vector<float> hardness;       ///< 0..1
  std::vector<float> soft;           ///< 0..1 occupancy of dura and brain, shown and labelled but neither felt nor cut; may be empty
  std::vector<std::uint8_t> labels;  ///< VoxelLabel
};

class FloatVdb;

/// Bone as loaded, sparse in OpenVDB, constant, shared between threads. Outside the grid there is no bone.
class BoneModel {
 public:
  /// bad_input when sizes disagree, dims are not positive, the affine is singular, or a value is not finite or outside 0..1.
  [[nodiscard]] static Result<std::shared_ptr<const BoneModel>> create(const DenseBone& dense);
  /// A file written by Voxmap::save; its `remaining` grid is not part of the model.
  [[nodiscard]] static Result<std::shared_ptr<const BoneModel>> load(const std::string& path);
  ~BoneModel();

  [[nodiscard]] const Vec3i& dims() const noexcept { return dims_; }
  [[nodiscard]] VoxelBox bounds() const noexcept { return {Vec3i(0), dims_}; }
  [[nodiscard]] const Affine& bone_from_index() const noexcept { return bone_from_index_; }
  [[nodiscard]] std::size_t bone_voxels() const noexcept { return bone_voxels_; }  ///< occupancy >= 0.5
  [[nodiscard]] const VoxelBox& bone_box() const noexcept { return bone_box_; }    ///< round those
  /// What was taken for granted when the bone was made from a scan, a line each; saved with it.
  [[nodiscard]] const std::string& notes() const noexcept { return notes_; }
  [[nodiscard]] std::size_t bytes() const;
  // Dense copies of a box, i fastest; the box may reach outside the grid, where all fields are 0.
  void read_occupancy(const VoxelBox& box, std::span<float> out) const;
  void read_hardness(const VoxelBox& box, std::span<float> out) const;
  void read_soft(const VoxelBox& box, std::span<float> out) const;
  void read_labels(const VoxelBox& box, std::span<float> out) const;  ///< VoxelLabel as a number
  [[nodiscard]] VoxelLabel label(const Vec3i& v) const;
  [[nodiscard]] float occupancy(const Vec3i& v) const;
  /// The grids, for writing a file.
  [[nodiscard]] std::vector<const FloatVdb*> grids() const;

 private:
  friend class BoneModelBuilder;
  struct Grids;
  BoneModel(const Vec3i& dims, const Affine& bone_from_index, std::unique_ptr<Grids> grids, std::string notes);
  Vec3i dims_;
  Affine bone_from_index_;
  std::unique_ptr<Grids> grids_;
  std::size_t bone_voxels_ = 0;
  VoxelBox bone_box_;
  std::string notes_;
};

/// Makes a bone model part by part, so that a large scan never lies in memory as dense fields. One owner.
class BoneModelBuilder {
 public:
  /// bad_input when dims are not positive or the affine is singular or not finite.
  [[nodiscard]] static Result<BoneModelBuilder> create(const Vec3i& dims, const Affine& bone_from_index);
  BoneModelBuilder(BoneModelBuilder&&) noexcept;
  ~BoneModelBuilder();

  /// Fields of one box; those of DenseBone, whose `dims` is the size of the box and whose affine is not looked at. Boxes may come in any
  /// order. bad_input as BoneModel::create, or when the box reaches outside.
  [[nodiscard]] Status add(const VoxelBox& box, const DenseBone& fields);
  /// The model; the builder is empty afterwards.
  [[nodiscard]] std::shared_ptr<const BoneModel> finish(std::string notes = {});

 private:
  BoneModelBuilder(const Vec3i& dims, const Affine& bone_from_index);
  Vec3i dims_;
  Affine bone_from_index_;
  std::unique_ptr<BoneModel::Grids> grids_;
};

}  // namespace burrhole
