#include "core/zone/distance_field.h"

#include <cmath>
#include <limits>

namespace burrhole {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Lower envelope of the parabolas f(q) + w (x - q)^2 on a line of voxels.
class Envelope {
 public:
  Envelope(std::size_t length, double edge) : weight_(edge * edge), f_(length), apex_(length), from_(length + 1) {}
  [[nodiscard]] std::vector<double>& line() noexcept { return f_; }

  /// @returns false if the line has no finite value; it then stays as it is.
  bool find() {
    count_ = 0;
    for (std::size_t q = 0; q < f_.size(); ++q) {
      if (f_[q] == kFar) continue;
      double from = -kFar;
      while (count_ > 0) {
        from = crossing(apex_[count_ - 1], q);
        if (from > from_[count_ - 1]) break;
        --count_;
        from = -kFar;
      }
      apex_[count_] = q;
      from_[count_++] = from;
    }
    return count_ > 0;
  }
  /// Calls f(x, value) for each voxel of the line.
  template <class F>
  void each(F&& f) const {
    std::size_t part = 0;
    for (std::size_t x = 0; x < f_.size(); ++x) {
      while (part + 1 < count_ && from_[part + 1] < static_cast<double>(x)) ++part;
      const double d = static_cast<double>(x) - static_cast<double>(apex_[part]);
      f(x, f_[apex_[part]] + weight_ * d * d);
    }
  }

 private:
  /// @returns where the parabola of `b` falls below that of `a`, a < b.
  [[nodiscard]] double crossing(std::size_t a, std::size_t b) const noexcept {
    const double p = static_cast<double>(a), q = static_cast<double>(b);
    return (f_[b] - f_[a] + weight_ * (q * q - p * p)) / (2.0 * weight_ * (q - p));
  }

  double weight_;
  std::vector<double> f_;
  std::vector<std::size_t> apex_;
  std::vector<double> from_;
  std::size_t count_ = 0;
};

void along_axis(int axis, const Vec3i& size, double edge, std::vector<float>& squared) {
  const std::size_t strides[3] = {1, static_cast<std::size_t>(size.x), static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)};
  const auto length = static_cast<std::size_t>(size[axis]);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Envelope envelope(length, edge);
  for (std::size_t b = 0; b < static_cast<std::size_t>(size[v]); ++b)
    for (std::size_t a = 0; a < static_cast<std::size_t>(size[u]); ++a) {
      float* const first = squared.data() + a * strides[u] + b * strides[v];
      for (std::size_t n = 0; n < length; ++n) envelope.line()[n] = static_cast<double>(first[n * strides[axis]]);
      if (!envelope.find()) continue;
      envelope.each([&](std::size_t n, double value) { first[n * strides[axis]] = static_cast<float>(value); });
    }
}

/// @returns the part `inner` of an array over `outer`.
std::vector<float> part_of(const std::vector<float>& all, const VoxelBox& outer, const VoxelBox& inner) {
  std::vector<float> out;
  out.reserve(inner.count());
  for_each_voxel(inner, [&](const Vec3i& v) { out.push_back(all[outer.offset_of(v)]); });
  return out;
}

}  // namespace

std::vector<float> squared_distances(const Vec3i& size, const Vec3& edges, std::span<const std::uint8_t> inside, std::uint8_t wanted) {
  std::vector<float> out(inside.size());
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = inside[n] == wanted ? 0.0f : std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) along_axis(axis, size, edges[axis], out);
  return out;
}

Result<DistanceField> DistanceField::create(const VoxelBox& box, const Vec3& edges, double reach, const Members& members) {
  const double least = std::min({edges.x, edges.y, edges.z});
  if (box.empty() || !is_finite(edges) || !(least > 0.0) || !(reach > 0.0) || !std::isfinite(reach))
    return Error{ErrorCode::out_of_range, "distance field: the box, the edges and the reach must be finite and above 0", {}};
  const Vec3 margin = glm::ceil(Vec3(reach + least) / edges);
  const Vec3 whole = Vec3(box.size()) + 2.0 * margin;
  if (!(whole.x * whole.y * whole.z <= static_cast<double>(kMostVoxels)))
    return Error{ErrorCode::out_of_range, "distance field: too many voxels within the reach; reduce the reach", {}};
  const VoxelBox all{box.lo - Vec3i(margin), box.hi + Vec3i(margin)};
  std::vector<std::uint8_t> inside(all.count());
  members(all, inside);
  DistanceField out(box, edges, reach);
  const double half = 0.5 * (edges.x + edges.y + edges.z) / 3.0;
  const std::vector<float> outer = part_of(squared_distances(all.size(), edges, inside, 1), all, box),
                           inner = part_of(squared_distances(all.size(), edges, inside, 0), all, box);
  out.values_.resize(box.count());
  for (std::size_t n = 0; n < out.values_.size(); ++n) {
    const double o = std::sqrt(static_cast<double>(outer[n])), i = std::sqrt(static_cast<double>(inner[n]));
    out.values_[n] = static_cast<float>(std::clamp(o > 0.0 ? o - half : half - i, -reach, reach));
  }
  out.has_members_ = std::ranges::find(inside, std::uint8_t{1}) != inside.end();
  return out;
}

bool DistanceField::knows(const Vec3& index) const noexcept {
  const Vec3 lo(box_.lo), hi(box_.hi - 1);
  return index.x >= lo.x && index.y >= lo.y && index.z >= lo.z && index.x <= hi.x && index.y <= hi.y && index.z <= hi.z;
}

NearestZone DistanceField::at(const Vec3& index) const noexcept {
  const Vec3i least = box_.lo, most = glm::max(box_.hi - 2, box_.lo);
  const Vec3i cell = glm::clamp(floor_int(index), least, most);
  const Vec3 t = glm::clamp(index - Vec3(cell), 0.0, 1.0);
  double corner[8];
  for (int n = 0; n < 8; ++n) {
    const Vec3i v = glm::min(cell + Vec3i(n & 1, (n >> 1) & 1, n >> 2), box_.hi - 1);
    corner[n] = static_cast<double>(value(v));
  }
  const auto mix = [](double a, double b, double s) { return a + (b - a) * s; };
  double along_x[4], slope_x[4];
  for (int n = 0; n < 4; ++n) {
    along_x[n] = mix(corner[2 * n], corner[2 * n + 1], t.x);
    slope_x[n] = corner[2 * n + 1] - corner[2 * n];
  }
  const double low = mix(along_x[0], along_x[1], t.y), high = mix(along_x[2], along_x[3], t.y);
  const Vec3 slope(mix(mix(slope_x[0], slope_x[1], t.y), mix(slope_x[2], slope_x[3], t.y), t.z),
                   mix(along_x[1] - along_x[0], along_x[3] - along_x[2], t.z), high - low);
  const Vec3 grown = slope / edges_;
  const double length = glm::length(grown);
  return {mix(low, high, t.z), length > 1e-6 ? grown / length : Vec3(0.0)};
}

NearestZone distance_to_tube(const Vec3& from, const Vec3& to, double radius, const Vec3& point) noexcept {
  const Vec3 along = to - from;
  const double length2 = glm::dot(along, along);
  const double share = length2 > 0.0 ? std::clamp(glm::dot(point - from, along) / length2, 0.0, 1.0) : 0.0;
  const Vec3 apart = point - (from + share * along);
  const double distance = glm::length(apart);
  return {distance - radius, distance > 1e-9 ? apart / distance : Vec3(0.0)};
}

}  // namespace burrhole
