/// tests/core/voxel/surface_twin.h: surface records once more, plainly, in double precision and without shared code: every surfel is
/// offered to every voxel round it. For sanitizers, which do not see through gathers, and against rows left out.
#pragma once

#include <vector>

#include "core/voxel/surface_records.h"

namespace burrhole::test {

class SurfaceTwin {
 public:
  /// What of the method is left out, to show that tests would see it.
  struct Leave {
    bool smoothing = false;     ///< plain central differences instead of five taps
    bool second_order = false;  ///< the nearest surfel's own plane and normal
    bool plane = false;         ///< the way to the nearest surfel itself
  };
  SurfaceTwin(const MasterWindow& window, const Mat3& metric) : SurfaceTwin(window, metric, Leave()) {}
  SurfaceTwin(const MasterWindow& window, const Mat3& metric, Leave leave);

  [[nodiscard]] SurfaceSample record(const Vec3i& v) const;
  /// As contact reads records: trilinear.
  [[nodiscard]] SurfaceSample read(const Vec3& at) const;

 private:
  struct Surfel {
    Vec3 index, normal;
  };
  [[nodiscard]] double density(const Vec3i& v) const;
  [[nodiscard]] double trilinear(const Vec3& at) const;
  [[nodiscard]] Vec3 normal_of(const Vec3& at) const;
  [[nodiscard]] Vec3 surfel_normal(const Vec3i& cell, const Vec3& at) const;
  [[nodiscard]] Vec3 gradient(const Vec3i& v) const;
  void add_surfel(const Vec3i& cell);

  const MasterWindow* window_;
  Mat3 metric_, index_;
  Leave leave_;
  std::vector<Vec3> gradients_;
  std::vector<Surfel> surfels_;
  std::vector<int> surfel_at_;
};

}  // namespace burrhole::test
