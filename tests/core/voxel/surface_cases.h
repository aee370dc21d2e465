/// tests/core/voxel/surface_cases.h: bone of known shape, how contact reads records, and the 0.5 surface found by plain search.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/voxel/surface_records.h"

namespace burrhole::test {

/// Signed distance [voxel edges, metric], above 0 outside bone, and outward normal, at a metric point.
struct Truth {
  double distance = 0.0;
  Vec3 normal{0.0};
};
using Shape = std::function<Truth(const Vec3&)>;

[[nodiscard]] Shape plane(const Vec3& through, const Vec3& outward);
[[nodiscard]] Shape ball(const Vec3& centre, double radius, bool cavity);
/// A round hole along `axis` in solid bone.
[[nodiscard]] Shape hole(const Vec3& centre, const Vec3& axis, double radius);
/// Bone where both planes have bone.
[[nodiscard]] Shape wedge(const Shape& a, const Shape& b);

/// How density falls off across the surface.
enum class Ramp {
  wide,      ///< as the phantoms: linear over a voxel's corners
  coverage,  ///< the part of each voxel that is bone, by 8^3 samples: one voxel wide
};

/// A window of the shape's density; `metric` takes index to voxel edges.
[[nodiscard]] MasterWindow window_of(const VoxelBox& box, const Mat3& metric, const Shape& shape, Ramp ramp);
/// The same window inside a smaller box.
[[nodiscard]] MasterWindow cut_out(const MasterWindow& window, const VoxelBox& box);

/// What contact reads at an index position: 8 records, trilinear weights, the normal normalised afterwards.
[[nodiscard]] SurfaceSample read_records(const SurfaceRecords& records, const Vec3& at);

/// The trilinear 0.5 surface, as points on it, close to each other.
class PlainSurface {
 public:
  PlainSurface(const MasterWindow& window, const Mat3& metric);
  /// Signed distance to the surface [voxel edges], at an index position.
  [[nodiscard]] double distance(const Vec3& at) const;
  [[nodiscard]] double density(const Vec3& at) const;

 private:
  struct Point {
    Vec3 position, normal;  // metric
  };
  const MasterWindow* window_;
  Mat3 metric_;
  std::vector<std::vector<Point>> cells_;  // by cell of the window
};

/// Errors over many places: median and largest.
struct Errors {
  std::vector<double> distance, degrees;
  void add(double distance_error, double normal_error_degrees) {
    distance.push_back(std::abs(distance_error));
    degrees.push_back(normal_error_degrees);
  }
};
[[nodiscard]] double median(std::vector<double> values);
[[nodiscard]] double largest(const std::vector<double>& values);
[[nodiscard]] double degrees_between(const Vec3& a, const Vec3& b);

}  // namespace burrhole::test
