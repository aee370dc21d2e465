// Values of a scan on another grid, against sums over all 216 voxels around each place.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "volumes/read/resample.h"

using namespace burrhole;

namespace {

constexpr float kNothing = -4321.0f;

Scan noisy_scan(const Vec3i& dims) {
  Scan scan{dims, Affine::scaling(1e-3, Vec3(0.0)), Quantity::hounsfield, {}};
  unsigned state = 7;
  for (std::size_t n = 0; n < VoxelBox{Vec3i(0), dims}.count(); ++n) {
    state = state * 1664525u + 1013904223u;
    scan.values.push_back(static_cast<float>(state >> 20) - 1000.0f);
  }
  return scan;
}

/// Weight of a sample at distance d, the polynomials of [Keys81] as printed.
double kernel(double d) {
  d = std::abs(d);
  if (d < 1.0) return 4.0 / 3.0 * d * d * d - 7.0 / 3.0 * d * d + 1.0;
  if (d < 2.0) return -7.0 / 12.0 * d * d * d + 3.0 * d * d - 59.0 / 12.0 * d + 15.0 / 6.0;
  return d < 3.0 ? 1.0 / 12.0 * d * d * d - 2.0 / 3.0 * d * d + 21.0 / 12.0 * d - 3.0 / 2.0 : 0.0;
}

double plain_value(const Scan& scan, const Vec3& index) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (index[axis] < -0.5 || index[axis] > scan.dims[axis] - 0.5) return static_cast<double>(kNothing);
  const Vec3 place = glm::clamp(index, Vec3(0.0), Vec3(scan.dims - 1));
  const Vec3i base(glm::floor(place));
  const VoxelBox all{Vec3i(0), scan.dims};
  const auto sum_of = [&](std::size_t axis, bool limited, const std::function<double(int)>& sample) {
    double sum = 0.0, least = 1e30, most = -1e30;
    for (int n = base[axis] - 2; n <= base[axis] + 3; ++n) {
      const double value = sample(n);
      sum += kernel(place[axis] - n) * value;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    return limited ? std::clamp(sum, least, most) : sum;
  };
  return sum_of(2, false, [&](int k) {
    return sum_of(1, true, [&](int j) {
      return sum_of(0, true, [&](int i) {
        return static_cast<double>(scan.values[all.offset_of(glm::clamp(Vec3i(i, j, k), Vec3i(0), scan.dims - 1))]);
      });
    });
  });
}

/// Largest difference from the plain twin, in all layers with their margins, computed in slabs.
double largest_error(const Scan& scan, const Affine& scan_from_grid, const Vec3i& dims, int slab) {
  Resampler resampler(scan, {.slices = {}, .nothing = kNothing}, scan_from_grid, dims);
  double worst = 0.0;
  for (int k = 0; k < dims.z; k += slab) {
    const VoxelBox layers{{-1, -1, k - 1}, {dims.x + 1, dims.y + 1, std::min(k + slab, dims.z) + 1}};
    std::vector<float> values(layers.count());
    resampler.fill(k, std::min(k + slab, dims.z), values);
    for_each_voxel(layers, [&](const Vec3i& v) {
      const double expected = plain_value(scan, scan_from_grid * Vec3(v));
      worst = std::max(worst, std::abs(expected - static_cast<double>(values[layers.offset_of(v)])));
    });
  }
  return worst;
}

// A sum of six floats with weights of 1.375 in all is off by at most 7 half units of 1.375 * 4100, 2.4e-3, and three follow one another.
constexpr double kRounding = 1e-2;

}  // namespace

TEST_CASE("resample: parallel axes, finer, coarser and mirrored, past the ends of the scan") {
  const Scan scan = noisy_scan({9, 7, 6});
  for (const Vec3& edge : {Vec3(0.27, 0.31, 0.13), Vec3(1.7, 2.2, 0.5), Vec3(-0.4, 0.4, -0.3)}) {
    const Affine map{Mat3(edge.x, 0, 0, 0, edge.y, 0, 0, 0, edge.z), {edge.x < 0 ? 9.1 : -1.3, -0.7, edge.z < 0 ? 6.2 : -0.9}};
    for (const int slab : {1, 3, 8}) CHECK(largest_error(scan, map, {21, 17, 19}, slab) < kRounding);
  }
}

TEST_CASE("resample: any other axes") {
  const Scan scan = noisy_scan({9, 7, 6});
  const Mat3 turned(0.3, 0.05, -0.02, -0.04, 0.35, 0.06, 0.03, -0.01, 0.25);
  CHECK(largest_error(scan, {turned, {-0.8, -0.6, 0.2}}, {21, 17, 19}, 4) < kRounding);
  const Mat3 exchanged(0.0, 0.3, 0.0, 0.4, 0.0, 0.0, 0.0, 0.0, 0.2);
  CHECK(largest_error(scan, {exchanged, {-0.3, -0.6, 0.2}}, {15, 21, 19}, 8) < kRounding);
}

TEST_CASE("resample: both ways give the same bits, with slices between those of the scan and without") {
  const Scan scan = noisy_scan({9, 7, 6});
  const Affine aligned{Mat3(0.27, 0, 0, 0, 0.31, 0, 0, 0, 0.13), {-1.3, -0.7, -0.9}};
  Affine tilted = aligned;
  tilted.linear[1][0] = 1e-300;  // no longer parallel, and no different place
  const Vec3i dims(21, 17, 19);
  std::vector<float> one(VoxelBox{Vec3i(0), dims + 2}.count()), other(one.size());
  for (const int factor : {1, 2, 3}) {
    const ResampleRule rule{.slices = {.factor = factor, .low = -800.0, .flat = 1.0}, .nothing = kNothing};
    Resampler(scan, rule, aligned, dims).fill(0, dims.z, one);
    Resampler(scan, rule, tilted, dims).fill(0, dims.z, other);
    CHECK(one == other);
  }
}
