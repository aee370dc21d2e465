/// tests/core/contact/surface_probe_twin.h: what surface_probe does, by plain loops over points and records, in the same single precision
///   and order of operations, so that results must be the same bits; and fields of records whose truth is known.
///   Frame  bone: origin anywhere, metres; tool as given by the pose.   Units  SI unless said.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "core/contact/surface_probe.h"
#include "core/contact/worst_hit.h"

namespace burrhole::probe_test {

struct TwinHit {
  std::uint32_t point = 0;
  float x = 0.0f, y = 0.0f, z = 0.0f;
  float distance = 0.0f, nx = 0.0f, ny = 0.0f, nz = 0.0f;
  friend bool operator==(const TwinHit&, const TwinHit&) = default;
};

struct TwinProbe {
  std::vector<TwinHit> hits;
  float nearest = 0.0f;
  bool outside = false;
};

[[nodiscard]] TwinProbe probe_plainly(const RecordView& bone, const ContactShellPart& points, const Affine& index_from_tool,
                                      double look_ahead);
/// As find_worst(), all hits looked at.
[[nodiscard]] std::optional<WorstHit> worst_plainly(const ProbeHits& hits, std::size_t first, std::size_t last, const PointMotion& motion,
                                                    float limit = std::numeric_limits<float>::infinity());
[[nodiscard]] std::vector<TwinHit> hits_of(const ProbeHits& hits);

/// Truth at a point of the bone frame: distance [m] and outward normal.
using Truth = std::function<SurfaceSample(const Vec3&)>;
[[nodiscard]] Truth half_space(const Vec3& outward, double offset);  ///< bone where outward . p < offset
[[nodiscard]] Truth plate(const Vec3& across, double thickness);     ///< bone where |across . p| < thickness / 2
[[nodiscard]] Truth sphere(double radius);                           ///< bone within
[[nodiscard]] Truth rim(const Vec3& first, const Vec3& second);      ///< bone below both planes through the origin; outward normals
[[nodiscard]] Truth cavity(double radius);                           ///< bone without

/// Records of a truth, to nearest steps, in both precisions. Voxels past `valid` say that they lie deep in bone: they must not be read.
class TrueField {
 public:
  TrueField(const Affine& bone_from_index, const VoxelBox& box, const Truth& truth);
  [[nodiscard]] RecordView view(RecordPrecision precision) const;
  [[nodiscard]] const Affine& map() const noexcept { return map_; }
  /// True distance at index coordinates [voxel edges].
  [[nodiscard]] double distance_at(const Vec3& index) const { return truth_(map_ * index).distance / map_.mean_edge(); }
  /// Sabotage: all distances times `factor`.
  void stretch(double factor);
  /// Sabotage: one step more in every record of odd i.
  void nudge();

 private:
  Affine map_;
  VoxelBox box_, valid_;
  Truth truth_;
  std::vector<Record8> records8_;
  std::vector<Record16> records16_;
};

/// Cubes of 0.5 mm; bricks of unequal edges; sheared and turned; mirrored.
[[nodiscard]] std::vector<Affine> test_maps();

}  // namespace burrhole::probe_test
