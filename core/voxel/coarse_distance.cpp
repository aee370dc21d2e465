#include "core/voxel/coarse_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

constexpr int kEdge = 8;  // [voxels] of a block
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kFar = 1e18f;  // [blocks^2] above any square of a distance

/// The smallest factor by which a linear map stretches a vector: exact for orthogonal axes of any orientation, a lower bound for others.
double least_stretch(const Mat3& linear) noexcept {
  const Mat3 inverse = glm::inverse(glm::transpose(linear) * linear);
  double most = 0.0;  // of the symmetric matrix: its largest row sum bounds its spectral radius
  for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(inverse[c].x) + std::abs(inverse[c].y) + std::abs(inverse[c].z));
  return 1.0 / std::sqrt(most);
}

/// One line of the squared distance transform: g(q) = min over p of f(p) + (q - p)^2, by the lower envelope of the parabolas.
class Line {
 public:
  explicit Line(int longest)
      : from_(static_cast<std::size_t>(longest)), apex_(static_cast<std::size_t>(longest)), start_(static_cast<std::size_t>(longest) + 1) {}

  void transform(float* values, std::size_t stride, int count) {
    for (int n = 0; n < count; ++n) from_[static_cast<std::size_t>(n)] = values[static_cast<std::size_t>(n) * stride];
    std::size_t last = 0;
    apex_[0] = 0;
    start_[0] = -kInfinity;
    start_[1] = kInfinity;
    for (int q = 1; q < count; ++q) {
      double s = crossing(q, apex_[last]);
      while (s <= start_[last]) s = crossing(q, apex_[--last]);
      apex_[++last] = q;
      start_[last] = s;
      start_[last + 1] = kInfinity;
    }
    std::size_t k = 0;
    for (int q = 0; q < count; ++q) {
      while (start_[k + 1] < q) ++k;
      const auto d = static_cast<float>(q - apex_[k]);
      values[static_cast<std::size_t>(q) * stride] = d * d + from_[static_cast<std::size_t>(apex_[k])];
    }
  }

 private:
  [[nodiscard]] double crossing(int q, int p) const noexcept {
    const auto f = [&](int n) { return static_cast<double>(from_[static_cast<std::size_t>(n)]) + static_cast<double>(n) * n; };
    return (f(q) - f(p)) / (2.0 * (q - p));
  }
  std::vector<float> from_;
  std::vector<int> apex_;
  std::vector<double> start_;
};

void transform(const Vec3i& size, std::vector<float>& squares) {
  Line line(std::max({size.x, size.y, size.z}));
  std::size_t stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<std::size_t>(size[static_cast<std::size_t>(axis)]);
    for (std::size_t outer = 0; outer < squares.size(); outer += stride * count)
      for (std::size_t inner = 0; inner < stride; ++inner) line.transform(&squares[outer + inner], stride, static_cast<int>(count));
    stride *= count;
  }
}

}  // namespace

CoarseDistance::CoarseDistance(const BoneModel& bone) : scale_(least_stretch(bone.bone_from_index().linear)) {
  bone.for_each_region([&](const VoxelBox& region) { blocks_ = blocks_.unite({block_of(region.lo), block_of(region.hi - 1) + 1}); });
  if (blocks_.empty()) return;
  gap_.assign(blocks_.count(), kFar);
  // A block next to one with bone may touch it: distances are between blocks without their neighbours.
  bone.for_each_region([&](const VoxelBox& region) {
    const VoxelBox near = VoxelBox{block_of(region.lo) - 1, block_of(region.hi - 1) + 2}.intersect(blocks_);
    for_each_voxel(near, [&](const Vec3i& block) { gap_[blocks_.offset_of(block)] = 0.0f; });
  });
  transform(blocks_.size(), gap_);
  for (float& gap : gap_) gap = std::max(0.0f, kEdge * std::sqrt(gap) - 1.7320509f);
}

double CoarseDistance::at(const Vec3& index) const noexcept {
  if (blocks_.empty()) return kInfinity;
  const Vec3 lo = Vec3(blocks_.lo * kEdge), hi = Vec3(blocks_.hi * kEdge - 1);
  const Vec3 inside = glm::clamp(index, lo, hi);
  if (!(glm::length(index - inside) < kInfinity)) return 0.0;  // not finite: nothing is known
  const double gap = static_cast<double>(gap_[blocks_.offset_of(block_of(Vec3i(glm::floor(inside))))]);
  // Bone lies in the convex box. So the square of its distance is at least that of the box plus that of the nearest point of the box. One
  // voxel is the reach of trilinear samples beyond the box.
  const double outside = std::max(0.0, glm::length(index - inside) - 1.7320509);
  return scale_ * std::hypot(outside, gap);
}

std::size_t CoarseDistance::bytes_for(const Vec3i& dims) noexcept {
  return VoxelBox{Vec3i(0), (dims + kEdge - 1) / kEdge}.count() * sizeof(float);
}

}  // namespace burrhole
