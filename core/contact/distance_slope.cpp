#include "core/contact/distance_slope.h"

#include <array>

namespace burrhole {
namespace {

constexpr double kLeastSlope = 0.5;  // [-] the slope of a distance is 1; less means a ridge between two faces with no defined normal

/// The four taps of a cubic B-spline and of its derivative, at voxels -1, 0, 1, 2 from the cell's corner.
struct Taps {
  std::array<double, 4> value, slope;
  explicit Taps(double t) noexcept {
    const double s = 1.0 - t;
    value = {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0, (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
    slope = {-0.5 * s * s, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t};
  }
};

template <class Record>
Vec3 slope_of(const VoxelBox& box, const Record* records, double step, const Vec3i& corner, const Vec3& part) noexcept {
  const Taps x(part.x), y(part.y), z(part.z);
  Vec3 sum(0.0);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t j = 0; j < 4; ++j) {
      const Record* row = records + box.offset_of(corner + Vec3i(-1, static_cast<int>(j) - 1, static_cast<int>(k) - 1));
      double value = 0.0, slope = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        value += x.value[i] * row[i].distance;
        slope += x.slope[i] * row[i].distance;
      }
      sum += Vec3(slope * y.value[j] * z.value[k], value * y.slope[j] * z.value[k], value * y.value[j] * z.slope[k]);
    }
  return step * sum;
}

}  // namespace

std::optional<Vec3> distance_slope(const RecordView& bone, const Vec3& index) noexcept {
  const Vec3 lo(bone.box.lo + 1), hi(bone.box.hi - 3);
  if (!(glm::all(glm::greaterThanEqual(index, lo)) && glm::all(glm::lessThan(index, hi)))) return std::nullopt;
  const Vec3 base = glm::floor(index);
  const Vec3 slope = bone.records16 != nullptr ? slope_of(bone.box, bone.records16, kRecord16Distance, Vec3i(base), index - base)
                                               : slope_of(bone.box, bone.records8, kRecord8Distance, Vec3i(base), index - base);
  // A covector maps by the transposed inverse of the map from index to metric voxel edges.
  const Vec3 metric = glm::transpose(glm::inverse(bone.bone_from_index.linear)) * slope * bone.bone_from_index.mean_edge();
  const double length = glm::length(metric);
  if (!(length >= kLeastSlope)) return std::nullopt;
  return metric / length;
}

}  // namespace burrhole
