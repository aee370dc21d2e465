/// core/voxel/surface_records.h: distance to the 0.5 surface and its normal, stored for every voxel in a narrow band round the surface.
///   Distance  from the voxel's centre to the surface, in voxel edges (bone_from_index.mean_edge()), positive outside bone. It is a metric
///             distance: the index map may be oblique, sheared, or anisotropic.
///   Normal    outward unit normal at the surface point nearest to the voxel.
///   Frame     boxes in index coordinates; normals in the axes of the bone frame.   Errors  none.
///   Contact interpolates both trilinearly between voxel centres; a plane is reproduced exactly.
///   Outside the band the distance is +-kRecordBand, a lower bound of its magnitude, and the normal is zero.
///   Thread    simulation updates the records; contact reads copies.   Source  own derivation, shown in surface_records.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/voxel/surface_record.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct SurfaceSample {
  double distance = kRecordBand;  ///< [voxel unit] in voxel edges
  Vec3 normal{0.0};               ///< [-] outward, bone frame
  double bend = 0.0;              ///< [1/voxel edge] sum of the principal curvatures, positive where bone is convex; RecordSampler only
};

/// Records of one window, i fastest over `box`.
using RecordArray = std::variant<std::vector<Record8>, std::vector<Record16>>;

class CutSurface;

class SurfaceRecords {
 public:
  SurfaceRecords(const Affine& bone_from_index, RecordPrecision precision);
  SurfaceRecords(SurfaceRecords&&) noexcept;
  SurfaceRecords& operator=(SurfaceRecords&&) noexcept;
  ~SurfaceRecords();

  /// Computes all records: after the window was placed, or bone was restored.
  void rebuild(const MasterWindow& window, const CutSurface* cut = nullptr);
  /// Updates the records after density changed inside `dirty`, which may include the halo of gradients. @returns the box of records that
  /// may have changed. The result equals that of rebuild(), bit for bit.
  VoxelBox update(const MasterWindow& window, const VoxelBox& dirty);

  /// The same for several boxes. Boxes whose reaches overlap much are united. @returns the boxes of records that may have changed.
  std::vector<VoxelBox> update(const MasterWindow& window, std::span<const VoxelBox> dirty);
  /// After bone was cut inside `dirty` boxes, and every change was written to `cut`: copies the nodes, and does not read the density.
  std::vector<VoxelBox> update_cut(const CutSurface& cut, std::span<const VoxelBox> dirty);
  /// Updates the records after the window moved: keeps those that remain valid and computes the others that are valid now.
  void slide(const MasterWindow& window, const CutSurface* cut = nullptr);
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Reserves memory for windows of up to `window_voxels`.
  void reserve(std::size_t window_voxels);

  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// @returns the box of valid records. Nearer to the window's boundary a record may depend on voxels outside of the window.
  [[nodiscard]] VoxelBox valid_box() const noexcept;
  [[nodiscard]] const RecordArray& records() const noexcept { return records_; }
  [[nodiscard]] RecordPrecision precision() const noexcept;

 private:
  struct Work;
  void make(const MasterWindow& window, const VoxelBox& part);
  /// Replaces records of `part` by the nodes that are set.
  void overlay(const CutSurface* cut, const VoxelBox& part);

  std::unique_ptr<Work> work_;  // map and scratch; grows to its steady size at the first rebuild
  VoxelBox box_;
  RecordArray records_;
};

/// Records of parts of a window from its density alone.
class SurfaceReader {
 public:
  explicit SurfaceReader(const Affine& bone_from_index);
  SurfaceReader(SurfaceReader&&) noexcept;
  SurfaceReader& operator=(SurfaceReader&&) noexcept;
  ~SurfaceReader();
  /// Writes the records of `part`, i fastest. @pre `part` is inside the window, and away from its boundary by record_reach().
  void read(const MasterWindow& window, const VoxelBox& part, std::vector<Record16>& out);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// @returns the distance along each axis up to which densities affect a record [voxels]; nearer to the window's boundary records are
/// invalid.
[[nodiscard]] Vec3i record_reach(const Affine& bone_from_index) noexcept;

/// One record, decoded (tests, plain twins).
[[nodiscard]] SurfaceSample decode(const Record8& record) noexcept;
[[nodiscard]] SurfaceSample decode(const Record16& record) noexcept;

}  // namespace burrhole
