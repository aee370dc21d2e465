#include "surface_probe_twin.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace burrhole::probe_test {
namespace {

using Four = std::array<float, 4>;

/// Stored channels of the record at window coordinates.
Four stored(const RecordView& bone, int i, int j, int k) {
  const Vec3i size = bone.box.size();
  const auto at =
      (static_cast<std::size_t>(k) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(j)) * static_cast<std::size_t>(size.x) +
      static_cast<std::size_t>(i);
  if (bone.records8 != nullptr) {
    const Record8& r = bone.records8[at];
    return {static_cast<float>(r.distance), static_cast<float>(r.nx), static_cast<float>(r.ny), static_cast<float>(r.nz)};
  }
  const Record16& r = bone.records16[at];
  return {static_cast<float>(r.distance), static_cast<float>(r.nx), static_cast<float>(r.ny), static_cast<float>(r.nz)};
}

Four between(const Four& a, const Four& b, float t) {
  Four out;
  for (std::size_t c = 0; c < 4; ++c) out[c] = a[c] + (b[c] - a[c]) * t;
  return out;
}

/// First along k, then j, then i; and how every channel changes along i, j and k, mixed along the other two in the same order.
struct Cell {
  Four value;
  std::array<Four, 3> change;
};

Four less(const Four& a, const Four& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]}; }

Cell interpolated(const RecordView& bone, const std::array<float, 3>& p) {
  const int i = static_cast<int>(p[0]), j = static_cast<int>(p[1]), k = static_cast<int>(p[2]);
  const float fx = p[0] - static_cast<float>(i), fy = p[1] - static_cast<float>(j), fz = p[2] - static_cast<float>(k);
  std::array<Four, 2> faces, over_j, over_k;
  for (int x = 0; x < 2; ++x) {
    std::array<Four, 2> edges, rises;
    for (int y = 0; y < 2; ++y) {
      const Four low = stored(bone, i + x, j + y, k), high = stored(bone, i + x, j + y, k + 1);
      edges[static_cast<std::size_t>(y)] = between(low, high, fz);
      rises[static_cast<std::size_t>(y)] = less(high, low);
    }
    const auto side = static_cast<std::size_t>(x);
    faces[side] = between(edges[0], edges[1], fy);
    over_j[side] = less(edges[1], edges[0]);
    over_k[side] = between(rises[0], rises[1], fy);
  }
  return {between(faces[0], faces[1], fx),
          {less(faces[1], faces[0]), between(over_j[0], over_j[1], fx), between(over_k[0], over_k[1], fx)}};
}

/// [stored steps] the distance at a point: what its cell interpolates, less by axis f (1 - f) / 2 times the change of slope; where bone may be
/// cut, the highest tangent instead where the slope rises by more than 1/2, in full from 3/4, or where it rises and the distance changes by 0.1 more or less
/// than by the mean slope, in full from 0.2. Slopes are kept times -1/2, as the kernel's rounding asks.
float distance_in(const RecordView& bone, const Cell& cell, const std::array<float, 3>& p) {
  const bool small = bone.records8 != nullptr;
  const double scale = small ? kRecord8Normal / kRecord8Distance : kRecord16Normal / kRecord16Distance;
  const auto slope = [&](const Four& normal, std::size_t axis) {
    std::array<float, 3> part{};
    for (std::size_t c = 0; c < 3; ++c)
      part[c] = normal[c + 1] * static_cast<float>(-0.5 * scale * bone.bone_from_index.linear[axis][c] / bone.bone_from_index.mean_edge());
    return (part[0] + part[1]) + part[2];
  };
  std::array<float, 3> curved{}, f{};
  float sharp = 0.0f;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    f[axis] = p[axis] - static_cast<float>(static_cast<int>(p[axis]));
    const Four& change = cell.change[axis];
    Four first = cell.value;
    for (std::size_t c = 0; c < 4; ++c) first[c] = cell.value[c] - f[axis] * change[c];
    const float turn = slope(change, axis), before = slope(first, axis), steps = small ? 32.0f : 4096.0f;
    curved[axis] = turn * (f[axis] * (1.0f - f[axis]));
    if (turn >= 0.0f) continue;
    const float uneven = std::abs(change[0] + (before + (before + turn)));
    sharp = std::max({sharp, -turn * (8.0f / steps) - 2.0f, uneven * (10.0f / steps) - 1.0f});
  }
  const float smooth = cell.value[0] + ((curved[0] + curved[1]) + curved[2]);
  bool cut = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int at = static_cast<int>(p[axis]) + bone.box.lo[axis];
    cut = cut && at >= bone.cut.lo[axis] && at < bone.cut.hi[axis];
  }
  if (sharp <= 0.0f || !cut) return smooth;
  float highest = -1e9f;
  for (int n = 0; n < 8; ++n) {
    const std::array<int, 3> up{n & 1, (n >> 1) & 1, n >> 2};
    const Four corner = stored(bone, static_cast<int>(p[0]) + up[0], static_cast<int>(p[1]) + up[1], static_cast<int>(p[2]) + up[2]);
    std::array<float, 3> part{};
    for (std::size_t axis = 0; axis < 3; ++axis) part[axis] = (f[axis] - static_cast<float>(up[axis])) * slope(corner, axis);
    const float half = (part[0] + part[1]) + part[2];
    highest = std::max(highest, corner[0] - (half + half));
  }
  return smooth + std::min(sharp, 1.0f) * (highest - smooth);
}

std::array<float, 3> times(const Affine& map, float x, float y, float z) {
  std::array<float, 3> out;
  for (std::size_t r = 0; r < 3; ++r) {
    float sum = static_cast<float>(map.linear[0][r]) * x + static_cast<float>(map.linear[1][r]) * y;
    sum += static_cast<float>(map.linear[2][r]) * z;
    out[r] = sum + static_cast<float>(map.offset[r]);
  }
  return out;
}

}  // namespace

TwinProbe probe_plainly(const RecordView& bone, const ContactShellPart& points, const Affine& index_from_tool, double look_ahead) {
  const bool small = bone.records8 != nullptr;
  const auto steps = static_cast<float>(small ? 32.0 : 4096.0);
  const auto normal_scale = static_cast<float>(small ? 1.0 / 127.0 : 1.0 / 32767.0);
  // Half the longest diagonal of a cell: of the four, by the signs of its edges.
  double diagonal = 0.0;
  for (const double sy : {-1.0, 1.0})
    for (const double sz : {-1.0, 1.0}) diagonal = std::max(diagonal, glm::length(bone.bone_from_index.linear * Vec3(1.0, sy, sz)));
  const auto slack = static_cast<float>(0.5 * diagonal / bone.bone_from_index.mean_edge() + 0.02);
  const auto reach = static_cast<float>(look_ahead);
  Affine window_from_tool = index_from_tool;
  window_from_tool.offset -= Vec3(bone.box.lo);
  TwinProbe out;
  float least = static_cast<float>(kRecordBand) * steps;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const std::array<float, 3> p = times(window_from_tool, points.x[n], points.y[n], points.z[n]);
    bool known = true;
    for (std::size_t a = 0; a < 3; ++a)
      known = known && p[a] >= static_cast<float>(bone.valid.lo[a] - bone.box.lo[a]) &&
              p[a] < static_cast<float>(bone.valid.hi[a] - 1 - bone.box.lo[a]);
    if (!known) {
      out.outside = true;
      continue;
    }
    const float first = stored(bone, static_cast<int>(p[0] + 0.5f), static_cast<int>(p[1] + 0.5f), static_cast<int>(p[2] + 0.5f))[0];
    least = std::min(least, first);
    if (!(first < (reach + slack) * steps)) continue;
    const Cell cell = interpolated(bone, p);
    const Four& found = cell.value;
    const float distance = distance_in(bone, cell, p) * (1.0f / steps);
    if (!(distance < reach)) continue;
    out.hits.push_back({points.point[n], points.x[n], points.y[n], points.z[n], distance, found[1] * normal_scale, found[2] * normal_scale,
                        found[3] * normal_scale});
  }
  out.nearest = std::min(static_cast<float>(kRecordBand), least / steps - slack);
  return out;
}

std::optional<WorstHit> worst_plainly(const ProbeHits& hits, std::size_t first, std::size_t last, const PointMotion& motion, float limit) {
  std::optional<WorstHit> worst;
  for (std::size_t n = first; n < last; ++n) {
    const std::array<float, 3> m = times({motion.linear, motion.offset}, hits.x[n], hits.y[n], hits.z[n]);
    const float along = (hits.nx[n] * m[0] + hits.ny[n] * m[1]) + hits.nz[n] * m[2];
    const float after = hits.distance[n] + along;
    if (after < (worst ? worst->distance : limit)) worst = WorstHit{n, after};
  }
  return worst;
}

std::vector<TwinHit> hits_of(const ProbeHits& hits) {
  std::vector<TwinHit> out;
  for (std::size_t n = 0; n < hits.count; ++n)
    out.push_back({hits.point[n], hits.x[n], hits.y[n], hits.z[n], hits.distance[n], hits.nx[n], hits.ny[n], hits.nz[n]});
  return out;
}

Truth half_space(const Vec3& outward, double offset) {
  return [n = glm::normalize(outward), offset](const Vec3& p) { return SurfaceSample{glm::dot(n, p) - offset, n}; };
}

Truth plate(const Vec3& across, double thickness) {
  return [n = glm::normalize(across), thickness](const Vec3& p) {
    const double at = glm::dot(n, p);
    return SurfaceSample{std::abs(at) - 0.5 * thickness, at < 0.0 ? -n : n};
  };
}

Truth sphere(double radius) {
  return [radius](const Vec3& p) {
    const double r = glm::length(p);
    return SurfaceSample{r - radius, r > 0.0 ? p / r : Vec3(0.0)};
  };
}

Truth rim(const Vec3& first, const Vec3& second) {
  return [a = glm::normalize(first), b = glm::normalize(second)](const Vec3& p) {
    const double to_a = glm::dot(a, p), to_b = glm::dot(b, p);
    return to_a > to_b ? SurfaceSample{to_a, a} : SurfaceSample{to_b, b};
  };
}

Truth cavity(double radius) {
  return [radius](const Vec3& p) {
    const double r = glm::length(p);
    return SurfaceSample{radius - r, r > 0.0 ? -p / r : Vec3(0.0)};
  };
}

TrueField::TrueField(const Affine& bone_from_index, const VoxelBox& box, const Truth& truth)
    : map_(bone_from_index), box_(box), valid_{box.lo + 2, box.hi - 3}, truth_(truth) {
  for_each_voxel(box_, [&](const Vec3i& v) {
    SurfaceSample sample = truth_(map_ * Vec3(v));
    sample.distance = std::clamp(sample.distance / map_.mean_edge(), -kRecordBand, kRecordBand);
    if (std::abs(sample.distance) >= kRecordBand) sample.normal = Vec3(0.0);
    if (!valid_.contains(v)) sample.distance = -kRecordBand;
    const auto byte = [](double value) { return static_cast<std::int8_t>(std::lround(value)); };
    const auto word = [](double value) { return static_cast<std::int16_t>(std::lround(value)); };
    const Vec3 small = 127.0 * sample.normal, large = 32767.0 * sample.normal;
    records8_.push_back({byte(32.0 * sample.distance), byte(small.x), byte(small.y), byte(small.z)});
    records16_.push_back({word(4096.0 * sample.distance), word(large.x), word(large.y), word(large.z)});
  });
}

RecordView TrueField::view(RecordPrecision precision) const {
  RecordView out{.box = box_, .valid = valid_, .bone_from_index = map_};
  if (precision == RecordPrecision::bits8)
    out.records8 = records8_.data();
  else
    out.records16 = records16_.data();
  return out;
}

void TrueField::stretch(double factor) {
  for (Record8& r : records8_) r.distance = static_cast<std::int8_t>(std::clamp(factor * r.distance, -112.0, 112.0));
  for (Record16& r : records16_) r.distance = static_cast<std::int16_t>(std::clamp(factor * r.distance, -14336.0, 14336.0));
}

void TrueField::nudge() {
  for (std::size_t n = 1; n < records8_.size(); n += 2) {
    ++records8_[n].distance;
    ++records16_[n].distance;
  }
}

std::vector<Affine> test_maps() {
  const Vec3 offset(1e-3, -2e-3, 0.5e-3);
  Affine sheared;
  sheared.linear = glm::mat3_cast(glm::angleAxis(0.6, glm::normalize(Vec3(1.0, 2.0, -1.0)))) *
                   Mat3(0.5e-3, 0.0, 0.0, 0.15e-3, 0.45e-3, 0.0, -0.1e-3, 0.1e-3, 0.6e-3);
  sheared.offset = offset;
  return {Affine::scaling(0.5e-3, offset),
          {Mat3(0.35e-3, 0.0, 0.0, 0.0, 0.5e-3, 0.0, 0.0, 0.0, 0.7e-3), offset},
          sheared,
          {Mat3(-0.5e-3, 0.0, 0.0, 0.0, 0.0, 0.5e-3, 0.0, 0.5e-3, 0.0), offset}};
}

}  // namespace burrhole::probe_test
