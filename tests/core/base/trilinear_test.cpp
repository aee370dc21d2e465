#include "core/base/trilinear.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/random.h"

using namespace burrhole;

namespace {

/// Sum of corners and weights, the plain twin.
double weighted(const std::array<double, 8>& values, const Vec3& t) {
  double sum = 0.0;
  for (unsigned n = 0; n < 8; ++n) {
    const Vec3 w = glm::mix(1.0 - t, t, Vec3(cell_corner(n)));
    sum += w.x * w.y * w.z * values[n];
  }
  return sum;
}

}  // namespace

TEST_CASE("trilinear: equals the weighted sum of the corners, and the corners themselves at the corners") {
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    CAPTURE(trial);
    std::array<double, 8> values{};
    for (std::uint64_t n = 0; n < 8; ++n) values[n] = uniform01(trial, n);
    const auto corner = [&](unsigned n) { return values[n]; };
    const Vec3 t(uniform01(trial, 8), uniform01(trial, 9), uniform01(trial, 10));
    // Values within 0..1: three roundings of either form, each half an ulp of 1, twice.
    CHECK(std::abs(trilinear(t, corner) - weighted(values, t)) <= 16 * std::numeric_limits<double>::epsilon());
    CHECK(std::abs(trilinear(Vec3(t.y, t.x, t.z), corner) - weighted(values, t)) >
          16 * std::numeric_limits<double>::epsilon());  // sabotage
    CHECK(trilinear(Vec3(0.0), corner) == values[0]);
    CHECK(trilinear(Vec3(1.0, 0.0, 0.0), corner) == doctest::Approx(values[1]).epsilon(1e-15));
    CHECK(trilinear(Vec3(0.0, 0.0, 1.0), corner) == doctest::Approx(values[4]).epsilon(1e-15));
  }
}

TEST_CASE("trilinear: a constant comes back with the same bits, in both precisions and for vectors") {
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const Vec3 t(uniform01(trial, 0), uniform01(trial, 1), uniform01(trial, 2));
    CHECK(trilinear(t, [](unsigned) { return 0.7; }) == 0.7);
    CHECK(trilinear(Vec3f(t), [](unsigned) { return 0.7f; }) == 0.7f);
    CHECK(trilinear(t, [](unsigned) { return Vec3(0.1, 0.2, 0.3); }) == Vec3(0.1, 0.2, 0.3));
  }
}

TEST_CASE("trilinear: in a dense array the cell's voxels are those of the box, i fastest") {
  const VoxelBox box{Vec3i(-3, 2, 5), Vec3i(2, 6, 9)};
  std::vector<float> values(box.count());
  for_each_voxel(box, [&](const Vec3i& v) { values[box.offset_of(v)] = static_cast<float>(v.x + 10 * v.y + 100 * v.z); });
  const Vec3 at(-1.25, 3.5, 6.75);
  CHECK(trilinear(box, values.data(), at) == -1.25 + 35.0 + 675.0);  // exact in binary
}
