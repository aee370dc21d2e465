/// core/contact/surface_probe.h: computes distance and normal of the bone's surface at many points at once, from surface records.
///   Frame  distances in voxel edges, normals in the axes of the bone frame.   Thread  contact; never allocates after reserve().
///   Source own derivation. One record near a point bounds its distance. For points near the surface eight records are interpolated; each
///   gives d + n.(p - v) / 2 at a point p, with v its voxel. With trilinear weights this is exact for distances of second order, while d
///   alone has an error of up to f (1 - f) / 2 per axis over the radius of curvature. Where two faces meet, normals of both are mixed, and the sum is up to 0.25
///   voxel too low: bone that is not there, and that no tool can cut. So where bone is cut (RecordView::cut), a cell with a convex edge, or
///   with a wall of one or two voxels, has the distance of the highest tangent plane, d + n.(p - v). For planes that is exact.
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

/// Records as contact reads them. The pointees must outlive the view.
struct RecordView {
  VoxelBox box, valid;
  const Record8* records8 = nullptr;  ///< exactly one of the two is set
  const Record16* records16 = nullptr;
  Affine bone_from_index;
  VoxelBox cut{};      ///< where records may be of the cut surface
  double lying = 0.0;  ///< [voxels] added to every distance: bone that reaches this deep into the tool does not touch it
};

inline constexpr std::size_t kHitBlock = 128;  ///< largest number of shell points per block of hits

struct HitRange {
  std::size_t first, last;
};

/// Bounds over neighbouring hits, with which a search can skip them. One array per quantity.
struct HitBlocks {
  std::vector<std::uint32_t> end;            ///< per block: index after its last hit; the next block begins there
  std::vector<float> distance;               ///< [voxels] minimum, in voxel edges
  std::array<std::vector<float>, 6> lo, hi;  ///< minimum and maximum of x, y, z, nx, ny, nz
  std::size_t count = 0;
  bool wanted = true;  ///< false: no blocks are made

  void reserve(std::size_t points);
  [[nodiscard]] HitRange hits_of(std::size_t block) const noexcept { return {block == 0 ? 0 : end[block - 1], end[block]}; }
};

/// Points of the shell within reach of the surface. All arrays have the same size.
struct ProbeHits {
  LineVector<float> x, y, z;               ///< [m] tool frame
  LineVector<float> distance, nx, ny, nz;  ///< [voxels] in voxel edges, [-] bone frame, not normalised
  LineVector<std::uint32_t> point;         ///< index into the shell
  LineVector<float> lower;                 ///< [voxels] lower bounds of the distance in the cells of the points (shell_cells.h)
  bool lowered = false;                    ///< `lower` is set, and is what find_worst() compares; so are the minima of the blocks
  std::size_t count = 0;
  HitBlocks blocks;      ///< of all hits in order, or empty
  float nearest = 0.0f;  ///< [voxels] lower bound of the distances of all probed points; at most the records' band, also inside
  bool outside = false;  ///< a point was outside the known records

  void reserve(std::size_t points);
  /// @param blocked whether blocks are made for hits appended from now on; without blocks a search scans all hits.
  void clear(bool blocked = true) noexcept;
};

/// Appends the points with a distance to the surface below `look_ahead` [voxel edges] (points inside bone have a negative distance).
void probe_surface(const RecordView& bone, const ContactShellPart& points, const Affine& index_from_tool, double look_ahead,
                   ProbeHits& hits) noexcept;

/// The same at single points, without vectors.
class RecordSampler {
 public:
  explicit RecordSampler(const RecordView& bone) noexcept;
  /// @param index in index coordinates. @returns empty outside the known records; the normal has length 1, or is zero where it is
  /// undefined.
  [[nodiscard]] std::optional<SurfaceSample> at(const Vec3& index) const noexcept;

 private:
  RecordView bone_;
  Mat3 metric_;  // voxel edges from index
};
[[nodiscard]] inline std::optional<SurfaceSample> sample_records(const RecordView& bone, const Vec3& index) noexcept {
  return RecordSampler(bone).at(index);
}

}  // namespace burrhole
