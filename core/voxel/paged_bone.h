/// core/voxel/paged_bone.h: the fields of a bone model in a temporary file, for a bone that is larger than the memory it may use.
///   Layout  Blocks of 8^3 voxels, as in block_store.h. Of each block the file holds the fields that are not constant in it: floats
///           unchanged, labels as bytes. An index in memory holds 4 bytes a block, in nodes of 8^3 blocks that exist only where there is
///           bone, and 32 bytes for each block with bone. The cache of the kernel is the only cache.
///   Frame   index.   Errors  those of bone_file.h; a read that fails gives zeros and an error that remains, see status().
///   Thread  write(): one, before any reads. Then any number may read: no locks, no allocation, one system call for each block.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/voxel/block_store.h"
#include "core/voxel/bone_file.h"

namespace burrhole {

/// A field of bone as loaded.
enum class BoneField : std::uint8_t { occupancy, hardness, soft, labels };

/// New values of a box, i fastest. An empty field leaves the values that are there.
struct BoneValues {
  std::array<std::span<const float>, 3> floats;  ///< [-] 0..1 occupancy, hardness, soft tissue
  std::span<const std::uint8_t> labels;          ///< VoxelLabel
};

class PagedBone {
 public:
  /// As BoneFile::create. @param dims of the grid; there is no bone outside.
  [[nodiscard]] static Result<std::unique_ptr<PagedBone>> create(const Vec3i& dims, const BoneStorage& storage);

  /// Boxes may overlap and cut blocks; the last value of a voxel counts. unavailable: the file cannot be written or read back.
  /// @pre `box` is inside the grid.
  [[nodiscard]] Status write(const VoxelBox& box, const BoneValues& values);

  /// Dense copy of a box, i fastest; labels as numbers. The box may reach outside the grid.
  void read(BoneField field, const VoxelBox& box, std::span<float> out) const noexcept;
  [[nodiscard]] float value(BoneField field, const Vec3i& v) const noexcept;
  /// Calls f for boxes that together hold all voxels of a field that are not 0; each holds at least one. Unordered. Reads no file.
  /// @param field occupancy or soft.
  void for_each_region(BoneField field, const std::function<void(const VoxelBox&)>& f) const;
  /// Number and bounding box of the voxels with an occupancy of at least 0.5. Reads no file.
  struct Part {
    std::size_t voxels = 0;
    VoxelBox box;
  };
  [[nodiscard]] Part bone() const;

  /// @returns the error of the first read that failed; success if none has.
  [[nodiscard]] Status status() const;
  /// True from the first read that failed.
  [[nodiscard]] const std::atomic<bool>& failed() const noexcept { return failed_; }
  [[nodiscard]] std::size_t bytes() const noexcept;                           ///< of the index
  [[nodiscard]] std::size_t blocks() const noexcept { return rows_.size(); }  ///< with bone or soft tissue
  [[nodiscard]] const BoneFile& file() const noexcept { return file_; }

  /// @returns an upper bound of bytes(). @param share [-] of the blocks that hold bone.
  [[nodiscard]] static std::uint64_t index_bytes(const Vec3i& dims, double share) noexcept;
  /// @returns an upper bound of the file's size, if no block has a constant field. @param soft whether there may be soft tissue.
  [[nodiscard]] static std::uint64_t file_bytes(const Vec3i& dims, bool soft, double share) noexcept;

 private:
  static constexpr std::size_t kFields = 4, kUnit = 512;  // [bytes] a unit of the file: the labels of a block
  static constexpr int kNodeEdge = 8;                     // [blocks]
  static constexpr std::size_t kMostUnits = 13;           // of a block: three floats and a byte a voxel
  using Node = std::array<std::uint32_t, kBlockVoxels>;   // numbers of rows; 0: no bone
  /// A box inside a block, 4 bits a coordinate.
  using SmallBox = std::uint32_t;
  struct Row {
    std::array<float, 3> constant{};  // of each float field that is not stored
    std::uint32_t place = 0;          // [units] in the file
    std::uint8_t stored = 0;          // a bit for each field
    std::uint8_t label = 0;           // if labels are not stored
    std::uint16_t bone_voxels = 0;    // of occupancy >= 0.5
    std::array<SmallBox, 3> box{};    // of occupancy > 0, of soft tissue > 0, of the bone voxels
  };
  struct Values {
    std::array<BlockValues, 3> floats;
    std::array<std::uint8_t, kBlockVoxels> labels;
  };

  PagedBone(const Vec3i& dims, BoneFile file);
  [[nodiscard]] static SmallBox pack(const VoxelBox& box) noexcept;
  [[nodiscard]] static VoxelBox unpack(SmallBox packed, const Vec3i& block) noexcept;
  [[nodiscard]] static std::size_t units_of(std::uint8_t stored) noexcept;
  /// Bytes from the start of the file to the values of a stored field.
  [[nodiscard]] static std::uint64_t offset_of(const Row& row, std::size_t field) noexcept;
  [[nodiscard]] const Row* find(const Vec3i& block) const noexcept;
  [[nodiscard]] Row& make_row(const Vec3i& block);
  void take_place(Row& row, std::size_t units_before, std::size_t units);
  [[nodiscard]] Status store(const Vec3i& block, const Values& values);
  /// The part of a block, within it, as bytes of the file. @returns whether it was read.
  [[nodiscard]] bool read_file(std::uint64_t at, std::span<std::byte> out) const noexcept;
  void read_block(const Row& row, std::size_t field, const Vec3i& block, const VoxelBox& part, const VoxelBox& box,
                  float* out) const noexcept;
  void load(const Row* row, const Vec3i& block, Values& out) const noexcept;
  template <class F>
  void for_each_row(F&& f) const;

  Vec3i nodes_size_;  // [nodes]
  std::vector<std::unique_ptr<Node>> nodes_;
  std::deque<Row> rows_;                                         // row n is number n + 1; a deque does not move its elements when it grows
  std::array<std::vector<std::uint32_t>, kMostUnits + 1> free_;  // places of blocks that are stored elsewhere now, by their units
  std::uint32_t end_ = 0;                                        // [units] of the file
  BoneFile file_;
  mutable std::atomic<int> error_{0};  // errno of the first read that failed
  mutable std::atomic<bool> failed_{false};
};

}  // namespace burrhole
