/// core/contact/surface_probe.h: distance and normal of the bone's surface at many points at once, from surface records.
///   Frame  distances in voxel edges, normals in the axes of the bone frame.   Thread  contact; never allocates after reserve().
///   Source own derivation: one record near a point bounds its distance; points near the surface are then interpolated between eight.
///   Single precision, the same bits on every SIMD level.
#pragma once

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

/// Points of the shell within reach of the surface; sizes agree.
struct ProbeHits {
  std::vector<float> x, y, z;               ///< [m] tool frame
  std::vector<float> distance, nx, ny, nz;  ///< [voxel edges], [-] bone frame, not normalised
  std::vector<std::uint32_t> point;         ///< index into the shell
  std::size_t count = 0;
  float nearest = 0.0f;  ///< [voxel edges] no point looked at is nearer to the surface; at most the records' band, inside too
  bool outside = false;  ///< a point lay outside what the records know

  void reserve(std::size_t points);
  void clear() noexcept;
};

/// Appends the points whose surface is nearer than `look_ahead` [voxel edges] (inside bone counts as nearer).
void probe_surface(const RecordView& bone, const ContactShellPart& points, const Affine& index_from_tool, double look_ahead,
                   ProbeHits& hits) noexcept;

/// The same at one point, plainly. @param index in index coordinates. @returns nothing outside what the records know; the normal is of length 1,
/// or zero where there is none.
[[nodiscard]] std::optional<SurfaceSample> sample_records(const RecordView& bone, const Vec3& index) noexcept;

/// A rigid motion's small step and what it does to points: p moves by linear * p_tool + offset [voxel edges], bone frame.
struct PointMotion {
  Mat3 linear{0.0};
  Vec3 offset{0.0};
};

struct ProbeWorst {
  std::size_t hit = 0;
  float distance = 0.0f;  ///< [voxel edges] after the motion, linearised
};

/// The hit in [first, last) with the least distance after `motion`; ties go to the first. @pre first < last.
[[nodiscard]] ProbeWorst find_worst(const ProbeHits& hits, std::size_t first, std::size_t last, const PointMotion& motion) noexcept;

}  // namespace burrhole
