/// core/voxel/vdb_grids.h: the only wrapper of OpenVDB's storage: a sparse float grid with a background value, and .vdb files.
///   OpenVDB types are confined to the .cpp.   Frame  index; voxel centres at integers.   Errors  bad_input.
///   Thread  one; no internal locks.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

class FloatVdb {
 public:
  explicit FloatVdb(std::string name, float background);
  FloatVdb(FloatVdb&&) noexcept;
  FloatVdb& operator=(FloatVdb&&) noexcept;
  ~FloatVdb();

  [[nodiscard]] FloatVdb clone() const;
  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] float background() const noexcept;
  [[nodiscard]] float value(const Vec3i& v) const;
  /// Dense copy of a box, i fastest; out.size() == box.count().
  void read_box(const VoxelBox& box, std::span<float> out) const;
  /// Writes a dense box leaf by leaf. Values equal to the background become inactive and use no memory.
  void write_box(const VoxelBox& box, std::span<const float> in);
  /// Calls f(voxel, value) for each voxel that differs from the background, sorted by k, j, i.
  void for_each_sorted(const std::function<void(const Vec3i&, float)>& f) const;
  /// Calls f for boxes that together hold all voxels that differ from the background; each holds at least one. Unordered.
  void for_each_region(const std::function<void(const VoxelBox&)>& f) const;
  [[nodiscard]] VoxelBox active_bounds() const;
  /// Number and bounding box of voxels.
  struct Part {
    std::size_t voxels = 0;
    VoxelBox box;
  };
  /// @returns the voxels that differ from the background and whose value is at least `least`.
  [[nodiscard]] Part part_from(float least) const;
  [[nodiscard]] std::size_t bytes() const;
  void clear();

  struct Impl;
  [[nodiscard]] Impl& impl() noexcept { return *impl_; }
  [[nodiscard]] const Impl& impl() const noexcept { return *impl_; }

 private:
  explicit FloatVdb(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Contents of a .vdb file of this program: named float grids in one index space.
struct VdbFileContent {
  Vec3i dims{0};
  Affine bone_from_index;
  std::string notes;  ///< lines of text on the bone's origin
  std::vector<FloatVdb> grids;
};

/// Writes a temporary file and renames it. Metadata hold the exact affine map; the grid transform, for other programs, is the same in mm.
/// @param stop see OutputFile::create(). bad_input: the path cannot be written; unavailable: stopped.
[[nodiscard]] Status write_vdb(const std::string& path, const Vec3i& dims, const Affine& bone_from_index,
                               std::span<const FloatVdb* const> grids, const std::string& notes = {},
                               const std::atomic<bool>* stop = nullptr);
/// Reads without delayed loading. bad_input: the file is missing, not written by this program, or damaged.
[[nodiscard]] Result<VdbFileContent> read_vdb(const std::string& path);

/// One float grid of a file that another program wrote.
struct ForeignGrid {
  FloatVdb grid;
  bool level_set = false;                ///< the grid class is level set: signed distances, negative inside; otherwise densities
  Affine world_from_index;               ///< [units of the file]
  std::size_t active = 0;                ///< number of active voxels, > 0
  std::vector<std::string> other_float;  ///< names of float grids not read
  std::size_t other_type = 0;            ///< number of grids of other types
};

/// @param name of the grid; empty: the float grid with most active voxels. bad_input: the file is missing or damaged; the grid is missing,
/// empty, or its transform is not affine (a camera frustum).
[[nodiscard]] Result<ForeignGrid> read_foreign_grid(const std::string& path, const std::string& name);

}  // namespace burrhole
