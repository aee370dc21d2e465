/// core/contact/surface_probe.h: distance and normal of the bone's surface at many points at once, from surface records.
///   Frame  distances in voxel edges, normals in the axes of the bone frame.   Thread  contact; never allocates after reserve().
///   Source own derivation: one record near a point bounds its distance; points near the surface are then interpolated between eight, each
///   of which says d + n.(p - v) / 2 of a point p, v its voxel: weighted as usual that is exact for distances of second order, where d
///   alone is off by up to f (1 - f) / 2 an axis over the radius of curvature.
///   Single precision, the same bits on every SIMD level.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/geometry.h"
#include "core/contact/contact_shell.h"
#include "core/voxel/surface_records.h"

namespace burrhole {

/// Records as contact reads them; what they point to must outlive the view.
struct RecordView {
  VoxelBox box, valid;
  const Record8* records8 = nullptr;  ///< one of the two
  const Record16* records16 = nullptr;
  Affine bone_from_index;
};

inline constexpr std::size_t kHitBlock = 128;  ///< points of the shell, at most, whose hits are one block

struct HitRange {
  std::size_t first, last;
};

/// What neighbouring hits have in common, so that a search may pass them by. One array a figure.
struct HitBlocks {
  std::vector<std::uint32_t> end;            ///< a block's hits begin where those of the block before end
  std::vector<float> distance;               ///< [voxel edges] least
  std::array<std::vector<float>, 6> lo, hi;  ///< least and greatest x, y, z, nx, ny, nz
  std::size_t count = 0;
  bool wanted = true;  ///< or none are made

  void reserve(std::size_t points);
  [[nodiscard]] HitRange hits_of(std::size_t block) const noexcept { return {block == 0 ? 0 : end[block - 1], end[block]}; }
};

/// Points of the shell within reach of the surface; sizes agree.
struct ProbeHits {
  LineVector<float> x, y, z;               ///< [m] tool frame
  LineVector<float> distance, nx, ny, nz;  ///< [voxel edges], [-] bone frame, not normalised
  LineVector<std::uint32_t> point;         ///< index into the shell
  std::size_t count = 0;
  HitBlocks blocks;      ///< of all hits, in order, or none
  float nearest = 0.0f;  ///< [voxel edges] no point looked at is nearer to the surface; at most the records' band, inside too
  bool outside = false;  ///< a point lay outside what the records know

  void reserve(std::size_t points);
  /// @param blocked whether blocks are wanted of what is appended from now on; without them a search looks at all.
  void clear(bool blocked = true) noexcept;
};

/// Appends the points whose surface is nearer than `look_ahead` [voxel edges] (inside bone counts as nearer).
void probe_surface(const RecordView& bone, const ContactShellPart& points, const Affine& index_from_tool, double look_ahead,
                   ProbeHits& hits) noexcept;

/// The same at one point, plainly, and at others of the same records.
class RecordSampler {
 public:
  explicit RecordSampler(const RecordView& bone) noexcept;
  /// @param index in index coordinates. @returns nothing outside what the records know; the normal is of length 1, or zero where there is
  /// none.
  [[nodiscard]] std::optional<SurfaceSample> at(const Vec3& index) const noexcept;

 private:
  RecordView bone_;
  Mat3 metric_;  // voxel edges from index
};
[[nodiscard]] inline std::optional<SurfaceSample> sample_records(const RecordView& bone, const Vec3& index) noexcept {
  return RecordSampler(bone).at(index);
}

}  // namespace burrhole
