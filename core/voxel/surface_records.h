/// core/voxel/surface_records.h: where the 0.5 surface is, kept for every voxel near it: one look-up gives distance and normal.
///   Distance  from the voxel's centre to the surface, in voxel edges (bone_from_index.mean_edge()), above 0 outside bone. True metric
///             distance: the map may be oblique, sheared, or of uneven edges.
///   Normal    outward unit normal at the surface point nearest to the voxel, in the axes of the bone frame (not of the index).
///   Between voxel centres both are interpolated trilinearly (contact does that), which keeps a plane exact.
///   Beyond the band the distance is +-band and the normal zero: "at least that far".
///   Thread  simulation keeps them; contact reads copies.   Source  own derivation, shown in surface_records.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Distances up to this are true; further out they are +-kRecordBand [voxel edges].
inline constexpr double kRecordBand = 3.5;

/// How a record is stored: the knob of accuracy against bytes and time.
enum class RecordPrecision : std::uint8_t {
  bits8,   ///< 4 bytes: distance in 1/32 edge, normal in 1/127
  bits16,  ///< 8 bytes: distance in 1/4096 edge, normal in 1/32767
};

/// Distance, then normal x, y, z.
struct Record8 {
  std::int8_t distance, nx, ny, nz;
};
struct Record16 {
  std::int16_t distance, nx, ny, nz;
};
static_assert(sizeof(Record8) == 4 && sizeof(Record16) == 8);
inline constexpr double kRecord8Distance = 1.0 / 32.0, kRecord16Distance = 1.0 / 4096.0;  ///< [voxel edges] a step
inline constexpr double kRecord8Normal = 1.0 / 127.0, kRecord16Normal = 1.0 / 32767.0;

struct SurfaceSample {
  double distance = kRecordBand;  ///< [voxel edges]
  Vec3 normal{0.0};
};

/// Records of one window, i fastest over `box`.
using RecordArray = std::variant<std::vector<Record8>, std::vector<Record16>>;

class SurfaceRecords {
 public:
  SurfaceRecords(const Affine& bone_from_index, RecordPrecision precision);
  SurfaceRecords(SurfaceRecords&&) noexcept;
  SurfaceRecords& operator=(SurfaceRecords&&) noexcept;
  ~SurfaceRecords();

  /// Everything anew: after the window was placed, or bone grew.
  void rebuild(const MasterWindow& window);
  /// After density changed inside `dirty` (halo of gradients included or not, it does not matter). @returns the box of records that may
  /// differ now, to be copied. Afterwards the records equal those of a rebuild, bit for bit.
  VoxelBox update(const MasterWindow& window, const VoxelBox& dirty);

  /// The same after several boxes changed: boxes whose reaches overlap much are taken as one. @returns the boxes that may differ now.
  std::vector<VoxelBox> update(const MasterWindow& window, std::span<const VoxelBox> dirty);
  /// The window moved: records that were true and still are stay, the others are made anew.
  void slide(const MasterWindow& window);
  [[nodiscard]] std::size_t bytes() const noexcept;

  [[nodiscard]] const VoxelBox& box() const noexcept { return box_; }
  /// Records are known inside this box: nearer to the window's edge the surface may come from what the window does not know.
  [[nodiscard]] VoxelBox valid_box() const noexcept;
  [[nodiscard]] const RecordArray& records() const noexcept { return records_; }
  [[nodiscard]] RecordPrecision precision() const noexcept;

 private:
  struct Work;
  void make(const MasterWindow& window, const VoxelBox& part);

  std::unique_ptr<Work> work_;  // map and scratch; grows to its steady size at the first rebuild
  VoxelBox box_;
  RecordArray records_;
};

/// Voxels along each axis that a record depends on: so far in from a window's edge records are not known.
[[nodiscard]] Vec3i record_reach(const Affine& bone_from_index) noexcept;

/// One record, decoded (tests, plain twins).
[[nodiscard]] SurfaceSample decode(const Record8& record) noexcept;
[[nodiscard]] SurfaceSample decode(const Record16& record) noexcept;

}  // namespace burrhole
