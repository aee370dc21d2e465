// Slices between those of a scan, against the formulas one pixel at a time, and against bodies of closed form.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "core/base/units.h"
#include "tests/volumes/read/interpolations.h"
#include "volumes/read/bone_from_scan.h"
#include "volumes/read/cubic_kernel.h"
#include "volumes/read/refine_slices.h"

using namespace burrhole;

namespace {

constexpr double kMm = kMillimetre;
constexpr double kPixel = 0.94, kSlice = 1.9;  // [mm]

Scan make_scan(const Vec3i& dims, const std::function<double(const Vec3&)>& value_at) {
  Scan scan{dims, {Mat3(kPixel * kMm, 0, 0, 0, kPixel * kMm, 0, 0, 0, kSlice * kMm), Vec3(0.0)}, Quantity::hounsfield, {}};
  for_each_voxel({Vec3i(0), dims},
                 [&](const Vec3i& v) { scan.values.push_back(static_cast<float>(value_at(Vec3(v) * Vec3(kPixel, kPixel, kSlice)))); });
  return scan;
}

/// Numbers from `least` up to `most`, the same on every machine.
Scan noisy_scan(const Vec3i& dims, double least, double most) {
  unsigned state = 11;
  return make_scan(dims, [&](const Vec3&) {
    state = state * 1664525u + 1013904223u;
    return least + (most - least) * static_cast<double>(state >> 8) / static_cast<double>((1u << 24) - 1);
  });
}

/// The formulas of refine_slices.h for one pixel, in doubles: the Gaussian as one sum over its box.
struct Twin {
  const Scan& scan;
  RefineRule rule;

  [[nodiscard]] double value(Vec3i v) const {
    v = glm::clamp(v, Vec3i(0), scan.dims - 1);
    return static_cast<double>(scan.values[VoxelBox{Vec3i(0), scan.dims}.offset_of(v)]);
  }

  /// Weighted difference quotient of one axis, and the sum of the others.
  [[nodiscard]] Vec3 gradient(const Vec3i& at) const {
    const double sigma = kSlice / kPixel;
    const int reach = static_cast<int>(std::ceil(2.5 * sigma));
    Vec3 sum(0.0), square(0.0);
    double weights = 0.0;
    for (int k = -2; k <= 3; ++k)
      for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i) {
          const Vec3 d(i, j, k - 0.5);
          const double w = std::exp(-0.5 * (d.x * d.x + d.y * d.y) / (sigma * sigma) - 0.5 * d.z * d.z);
          weights += w;
          square += w * d * d;
          sum += w * d * std::max(value(at + Vec3i(i, j, k)), rule.low);
        }
    return sum / square;
  }

  [[nodiscard]] Vec3 shift(const Vec3i& at) const {
    const Vec3 g = gradient(at) / (Vec3(kPixel, kPixel, kSlice) * kMm);
    const double across = g.x * g.x + g.y * g.y, flat = rule.flat * rule.flat;
    if (across + g.z * g.z < flat) return Vec3(0.0);
    return Vec3(g.x, g.y, 0.0) * (-g.z / (across + g.z * g.z / 16.0 + flat)) * kSlice / kPixel;
  }

  static double weight(double d) {
    d = std::abs(d);
    if (d < 1.0) return 4.0 / 3.0 * d * d * d - 7.0 / 3.0 * d * d + 1.0;
    if (d < 2.0) return -7.0 / 12.0 * d * d * d + 3.0 * d * d - 59.0 / 12.0 * d + 15.0 / 6.0;
    return d < 3.0 ? 1.0 / 12.0 * d * d * d - 2.0 / 3.0 * d * d + 21.0 / 12.0 * d - 3.0 / 2.0 : 0.0;
  }
  static double limited(double place, const std::function<double(int)>& sample) {
    const int base = static_cast<int>(std::floor(place));
    double sum = 0.0, least = 1e30, most = -1e30;
    for (int n = base - 2; n <= base + 3; ++n) {
      const double v = sample(n);
      sum += weight(place - n) * v;
      least = std::min(least, v);
      most = std::max(most, v);
    }
    return std::clamp(sum, least, most);
  }

  [[nodiscard]] double refined(const Vec3i& at, double t) const {
    const Vec3 s = shift(at);
    return limited(at.z + t, [&](int k) {
      const Vec3 p = glm::clamp(Vec3(at.x, at.y, 0) + s * (k - at.z - t), Vec3(0.0), Vec3(scan.dims - 1));
      return limited(p.y, [&](int j) { return limited(p.x, [&](int i) { return value({i, j, k}); }); });
    });
  }
};

double pixel(std::span<const float> slice, const Scan& scan, int i, int j) {
  return static_cast<double>(slice[VoxelBox{Vec3i(0), scan.dims}.offset_of({i, j, 0})]);
}

/// An edge from 0 to 1000 over the extent of a voxel along its normal.
double edge(const Vec3& p, const Vec3& normal, const Vec3& through) {
  const double width = std::abs(normal.x) * kPixel + std::abs(normal.y) * kPixel + std::abs(normal.z) * kSlice;
  return 1000.0 * std::clamp(0.5 - glm::dot(p - through, normal) / width, 0.0, 1.0);
}

std::shared_ptr<const BoneModel> import_fine(const Scan& scan) {
  std::vector<std::string> assumed;
  BoneOptions options;
  options.spacing = 0.25 * kMm;
  const auto made = make_bone(scan, options, assumed);
  return made ? made->bone : nullptr;
}

}  // namespace

TEST_CASE("cubic kernel: exact for cubics, exactly the sample at a sample, and as bounded as stated") {
  double overshoot = 0.0, weights = 0.0;
  for (int part = 0; part <= 64; ++part) {
    const double t = part / 64.0;
    const auto w = cubic_weights(t);
    for (int power = 0; power <= 3; ++power) {
      double sum = 0.0;
      for (int n = 0; n < 6; ++n) sum += static_cast<double>(w[static_cast<std::size_t>(n)]) * std::pow(n - 2, power);
      CHECK(std::abs(sum - std::pow(t, power)) < 1e-5);  // weights are floats, powers up to 27
    }
    double all = 0.0, edge = 0.0;
    for (std::size_t n = 0; n < 6; ++n) {
      edge += static_cast<double>(w[n]);
      overshoot = std::max(overshoot, edge - 1.0);
      all += std::abs(static_cast<double>(w[n]));
    }
    weights = std::max(weights, all);
  }
  CHECK(cubic_weights(0.0) == std::array<float, 6>{0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f});
  CHECK(cubic_weights(1.0) == std::array<float, 6>{0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f});
  CHECK(std::abs(overshoot - 0.0929) < 1e-3);
  CHECK(std::abs(weights - 1.375) < 1e-6);
}

TEST_CASE("refined slices: those of the scan are its own, the others follow the formulas") {
  // A rough edge: noise of a tenth on it makes each shift different. Values up to 1100, shifts up to 2 slices: floats of the gradient give
  // shifts to 1e-5 pixels, at most 1e-2 of the value; sums of floats another 1e-2 (resample_test.cpp).
  Scan scan = noisy_scan({17, 15, 9}, 0.0, 100.0);
  const Vec3 normal = glm::normalize(Vec3(0.3, 0.5, 0.7));
  const VoxelBox all{Vec3i(0), scan.dims};
  for_each_voxel(all, [&](const Vec3i& v) {
    const Vec3 size(kPixel, kPixel, kSlice);
    scan.values[all.offset_of(v)] += static_cast<float>(edge(Vec3(v) * size, normal, Vec3(8, 7, 4) * size));
  });
  for (const int factor : {2, 3}) {
    const RefineRule rule{factor, 25.0, 1e4};
    RefinedSlices slices(scan, rule);
    const Twin twin{scan, rule};
    double worst = 0.0, most = 0.0, own = 0.0;
    for (int n = 0; n < slices.count(); ++n) {
      const std::span<const float> slice = slices.slice(n);
      for (int j = 0; j < scan.dims.y; ++j)
        for (int i = 0; i < scan.dims.x; ++i) {
          const Vec3i at(i, j, n / factor);
          if (n % factor == 0) {
            own = std::max(own, std::abs(pixel(slice, scan, i, j) - twin.value(at)));
            continue;
          }
          const double t = static_cast<double>(n % factor) / factor;
          worst = std::max(worst, std::abs(pixel(slice, scan, i, j) - twin.refined(at, t)));
          most = std::max(most, glm::length(twin.shift(at)));
        }
    }
    CHECK(own == 0.0);
    CHECK(most > 1.0);
    CHECK(worst < 2e-2);
  }
}

TEST_CASE("refined slices: the order of the calls does not change them") {
  const Scan scan = noisy_scan({17, 15, 6}, -1000.0, 1500.0);
  const RefineRule rule{3, 25.0, 1e4};
  RefinedSlices up(scan, rule), down(scan, rule);
  std::vector<std::vector<float>> rising, falling;
  for (int n = 0; n < up.count(); ++n) rising.emplace_back(up.slice(n).begin(), up.slice(n).end());
  for (int n = down.count() - 1; n >= 0; --n) {
    const auto slice = down.slice(n);
    falling.emplace(falling.begin(), slice.begin(), slice.end());
  }
  CHECK(rising == falling);
}

TEST_CASE("refined slices: an oblique edge lies between two slices where it is, and not without the shifts") {
  // 30 to 60 degrees: the edge of 1000 is as wide as a voxel along its normal. S = 4 leaves a displacement of 1 / (1 + cot^2 / 16) of the
  // right one, 0.84 at 30 degrees: the sides mix over a sixth of a slice instead of a whole one. Interpolation across the slices is off by the
  // largest where the slices on either side are 0 and 1000.
  for (const double tilt : {30.0, 45.0, 60.0}) {
    const double c = std::cos(tilt * kDegree), s = std::sin(tilt * kDegree);
    const Vec3 normal(0.8 * s, 0.6 * s, c), through(14 * kPixel, 14 * kPixel, 5.3 * kSlice);
    const Scan scan = make_scan({29, 29, 11}, [&](const Vec3& p) { return edge(p, normal, through); });
    const auto largest = [&](double flat) {
      RefinedSlices slices(scan, {2, 25.0, flat});
      double worst = 0.0;
      for (int n = 9; n <= 13; n += 2) {
        const std::span<const float> slice = slices.slice(n);
        for (int j = 8; j < 21; ++j)
          for (int i = 8; i < 21; ++i)
            worst =
                std::max(worst, std::abs(pixel(slice, scan, i, j) - edge(Vec3(i * kPixel, j * kPixel, 0.5 * n * kSlice), normal, through)));
      }
      return worst;
    };
    const double with = largest(1e4), without = largest(1e30);
    MESSAGE(tilt << " degrees: off by " << with << " of 1000, without shifts by " << without);
    CHECK(with < 0.7 * without);
    CHECK(with < 75.0);
  }
}

TEST_CASE("refined slices: factors by the shape of the voxels, and no more than the grid needs") {
  Scan scan = noisy_scan({4, 4, 4}, 0.0, 1.0);
  CHECK(slice_factor(scan, 0.25 * kMm) == 2);
  CHECK(slice_factor(scan, 1.2 * kMm) == 2);
  CHECK(slice_factor(scan, 2.0 * kMm) == 1);
  scan.bone_from_index.linear[2] = Vec3(0, 0, 1.3) * kMm;
  CHECK(slice_factor(scan, 0.25 * kMm) == 1);
  scan.bone_from_index.linear[2] = Vec3(0, 0, 50.0) * kMm;
  CHECK(slice_factor(scan, 0.25 * kMm) == 8);
}

TEST_CASE("import: no values of air and soft tissue make bone, and no values of bone a hole") {
  // Limits along x and y leave one overshoot, by 0.1875 of the range (cubic_kernel.h): at most 100 + 0.1875 * 1100 = 306 < 325 HU, and at
  // least 700 - 0.1875 * 1300 = 456 HU.
  const Scan soft = noisy_scan({21, 19, 11}, -1000.0, 100.0), hard = noisy_scan({21, 19, 11}, 700.0, 2000.0);
  CHECK(import_fine(soft) == nullptr);
  const auto bone = import_fine(hard);
  REQUIRE(bone);
  CHECK(bone->bone_voxels() == bone->bounds().count());
  // Sabotage twin: at a corner of tissue in air the kernel without limits overshoots by 9.3 % on each axis, -1000 + 1100 * 1.093^3 = 436 HU.
  const Scan corner = make_scan({21, 19, 11}, [](const Vec3& p) { return p.x > 9.0 && p.y > 8.0 && p.z > 9.0 ? 100.0 : -1000.0; });
  CHECK(import_fine(corner) == nullptr);
  std::vector<std::string> assumed;
  const auto unlimited = make_bone(test::interpolate(corner, 0.25 * kMm, test::Kernel::cubic6, test::Kernel::cubic6), {}, assumed);
  REQUIRE(unlimited);
  CHECK(unlimited->bone->bone_voxels() > 0);
}

TEST_CASE("import: an oblique scan of a head in air gives the same bone with quiet values left out") {
  // A ball of soft tissue with a shell of bone in air, turned by 1e-300: no axes are parallel any more, and no place differs.
  const auto head = [](const Vec3& p) {
    const double r = glm::length(p - Vec3(24.0, 24.0, 24.0));
    return -1000.0 + 1040.0 * std::clamp(23.0 - r, 0.0, 1.0) + 1100.0 * std::clamp(20.0 - r, 0.0, 1.0) * std::clamp(r - 16.0, 0.0, 1.0);
  };
  const Scan straight = make_scan({52, 52, 26}, head);
  Scan turned = straight;
  turned.bone_from_index.linear[1][0] = 1e-300;
  const auto one = import_fine(straight), other = import_fine(turned);
  REQUIRE(one);
  REQUIRE(other);
  std::vector<float> a(one->bounds().count()), b(a.size());
  one->read_occupancy(one->bounds(), a);
  other->read_occupancy(other->bounds(), b);
  CHECK(a == b);
  one->read_hardness(one->bounds(), a);
  other->read_hardness(other->bounds(), b);
  CHECK(a == b);
}
