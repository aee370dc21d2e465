#include "tests/volumes/read/interpolations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace burrhole::test {
namespace {

constexpr int kReach = 3;  // samples on either side

double weight_of(Kernel kernel, double d) {
  d = std::abs(d);
  switch (kernel) {
    case Kernel::linear:
      return std::max(1.0 - d, 0.0);
    case Kernel::catmull_rom:
      if (d < 1.0) return 1.0 - 2.5 * d * d + 1.5 * d * d * d;
      return d < 2.0 ? 2.0 - 4.0 * d + 2.5 * d * d - 0.5 * d * d * d : 0.0;
    case Kernel::cubic6:
      if (d < 1.0) return 1.0 - 7.0 / 3.0 * d * d + 4.0 / 3.0 * d * d * d;
      if (d < 2.0) return 2.5 - 59.0 / 12.0 * d + 3.0 * d * d - 7.0 / 12.0 * d * d * d;
      return d < 3.0 ? -1.5 + 1.75 * d - 2.0 / 3.0 * d * d + d * d * d / 12.0 : 0.0;
    case Kernel::spline:
    case Kernel::smooth_spline:
      if (d < 1.0) return 2.0 / 3.0 - d * d + 0.5 * d * d * d;
      return d < 2.0 ? (2.0 - d) * (2.0 - d) * (2.0 - d) / 6.0 : 0.0;
    case Kernel::lanczos: {
      if (d < 1e-9) return 1.0;
      const double x = std::numbers::pi * d;
      return d < 3.0 ? 3.0 * std::sin(x) * std::sin(x / 3.0) / (x * x) : 0.0;
    }
  }
  return 0.0;
}

/// Values to the coefficients of the interpolating cubic B-spline [Unser99], with a repeated border.
void prefilter(std::vector<double>& line) {
  const double pole = std::sqrt(3.0) - 2.0;
  const auto n = line.size();
  std::vector<double> out(n);
  // Both recursions as the one symmetric sum that they are: short lines only.
  for (std::size_t at = 0; at < n; ++at)
    for (int d = -24; d <= 24; ++d) {
      const auto from = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(at) + d, 0, static_cast<std::ptrdiff_t>(n) - 1);
      out[at] += std::pow(pole, std::abs(d)) * std::sqrt(3.0) * line[static_cast<std::size_t>(from)];
    }
  line = out;
}

/// One axis: `size` places from `first`, `step` apart [samples].
std::vector<double> resample_line(std::vector<double> line, Kernel kernel, int size, double step) {
  if (kernel == Kernel::spline) prefilter(line);
  const int last = static_cast<int>(line.size()) - 1;
  std::vector<double> out;
  for (int n = 0; n < size; ++n) {
    const double at = n * step;
    const int base = static_cast<int>(std::floor(at));
    double sum = 0.0, weights = 0.0;
    for (int d = 1 - kReach; d <= kReach; ++d) {
      const double w = weight_of(kernel, at - (base + d));
      weights += w;
      sum += w * line[static_cast<std::size_t>(std::clamp(base + d, 0, last))];
    }
    out.push_back(sum / weights);
  }
  return out;
}

/// @returns the scan with one axis at another spacing.
Scan resample_axis(const Scan& scan, std::size_t axis, Kernel kernel, double spacing) {
  const double step = spacing / scan.bone_from_index.linear[static_cast<glm::length_t>(axis)][static_cast<glm::length_t>(axis)];
  Scan out = scan;
  const auto a = static_cast<glm::length_t>(axis);
  out.dims[a] = static_cast<int>(std::floor((scan.dims[a] - 1) / step + 1e-6)) + 1;
  out.bone_from_index.linear[a][a] = spacing;
  const VoxelBox from{Vec3i(0), scan.dims}, to{Vec3i(0), out.dims};
  out.values.assign(to.count(), 0.0f);
  Vec3i lines = scan.dims;
  lines[a] = 1;
  for_each_voxel({Vec3i(0), lines}, [&](const Vec3i& start) {
    std::vector<double> line;
    Vec3i v = start;
    for (v[a] = 0; v[a] < scan.dims[a]; ++v[a]) line.push_back(static_cast<double>(scan.values[from.offset_of(v)]));
    const std::vector<double> fine = resample_line(line, kernel, out.dims[a], step);
    for (v[a] = 0; v[a] < out.dims[a]; ++v[a]) out.values[to.offset_of(v)] = static_cast<float>(fine[static_cast<std::size_t>(v[a])]);
  });
  return out;
}

struct Segment {
  Vec3 a, b;
};

double distance_to(const Segment& s, const Vec3& p) {
  const Vec3 along = s.b - s.a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - s.a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - s.a - t * along);
}

/// Contour of a slice: in each of the two triangles of a square of pixels a segment, linear between pixels.
std::vector<Segment> contour_of(const Scan& scan, int k, double level) {
  const VoxelBox box{Vec3i(0), scan.dims};
  const auto value = [&](const Vec3i& v) { return static_cast<double>(scan.values[box.offset_of(v)]) - level; };
  const auto place = [&](const Vec3i& v) { return scan.bone_from_index * Vec3(v); };
  std::vector<Segment> out;
  for (int j = 0; j + 1 < scan.dims.y; ++j)
    for (int i = 0; i + 1 < scan.dims.x; ++i)
      for (const int half : {0, 1}) {
        const std::array<Vec3i, 3> corner{Vec3i(i, j, k), half == 0 ? Vec3i(i + 1, j, k) : Vec3i(i, j + 1, k), Vec3i(i + 1, j + 1, k)};
        std::vector<Vec3> ends;
        for (std::size_t n = 0; n < 3; ++n) {
          const Vec3i &p = corner[n], &q = corner[(n + 1) % 3];
          if ((value(p) >= 0.0) == (value(q) >= 0.0)) continue;
          const double t = value(p) / (value(p) - value(q));
          ends.push_back(place(p) + t * (place(q) - place(p)));
        }
        if (ends.size() == 2) out.push_back({ends[0], ends[1]});
      }
  return out;
}

}  // namespace

Scan interpolate(const Scan& scan, double spacing, Kernel in_slice, Kernel across) {
  Scan out = resample_axis(scan, 2, across, spacing);
  out = resample_axis(out, 1, in_slice, spacing);
  return resample_axis(out, 0, in_slice, spacing);
}

Scan distances_of(const Scan& scan, double level, double slope) {
  constexpr double kFarthest = 8e-3;  // [m]
  Scan out = scan;
  const VoxelBox box{Vec3i(0), scan.dims};
  for (int k = 0; k < scan.dims.z; ++k) {
    const std::vector<Segment> contour = contour_of(scan, k, level);
    for_each_voxel({{0, 0, k}, {scan.dims.x, scan.dims.y, k + 1}}, [&](const Vec3i& v) {
      double distance = kFarthest;
      for (const Segment& s : contour) distance = std::min(distance, distance_to(s, scan.bone_from_index * Vec3(v)));
      float& value = out.values[box.offset_of(v)];
      value = static_cast<float>(level + slope * (static_cast<double>(value) >= level ? distance : -distance));
    });
  }
  return out;
}

}  // namespace burrhole::test
