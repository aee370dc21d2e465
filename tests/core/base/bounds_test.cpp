#include "core/base/bounds.h"

#include <doctest/doctest.h>

using namespace burrhole;

TEST_CASE("Bounds: corner n takes the upper end along the axes whose bit is set, as a cell's corners do") {
  const Bounds box{{-1.0, 2.0, 3.0}, {4.0, 5.0, 7.0}};
  for (unsigned n = 0; n < 8; ++n) {
    const Vec3 corner = box.lo + Vec3(cell_corner(n)) * (box.hi - box.lo);
    CHECK(box.corner(n) == corner);
    CHECK(box.corners()[n] == corner);
    CHECK(cell_corner(n).x + 2 * cell_corner(n).y + 4 * cell_corner(n).z == static_cast<int>(n));
  }
}

TEST_CASE("bounds_under: a turned box reaches as far along an axis as the absolute rows of the map say") {
  const Bounds box{{-1.0, 0.5, 0.0}, {2.0, 1.0, 4.0}};
  const Affine map{Mat3(Vec3(0.5, 0.2, -1.0), Vec3(-0.3, 2.0, 0.1), Vec3(0.7, -0.4, 0.9)), Vec3(10.0, -20.0, 30.0)};
  const Bounds turned = bounds_under(map, box);
  const Vec3 middle = map * (0.5 * (box.lo + box.hi)), half = 0.5 * (box.hi - box.lo);
  const Mat3 rows = glm::transpose(map.linear);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach = glm::dot(glm::abs(rows[axis]), half);
    CHECK(turned.lo[axis] == doctest::Approx(middle[axis] - reach).epsilon(1e-14));
    CHECK(turned.hi[axis] == doctest::Approx(middle[axis] + reach).epsilon(1e-14));
  }
}

TEST_CASE("Bounds: none() holds no point, bounds_of_points the least box") {
  const Bounds none = Bounds::none();
  CHECK(none.lo.x > none.hi.x);
  const Vec3 points[] = {{1.0, -2.0, 3.0}, {-1.0, 5.0, 2.0}};
  const Bounds box = bounds_of_points(points);
  CHECK(box.lo == Vec3(-1.0, -2.0, 2.0));
  CHECK(box.hi == Vec3(1.0, 5.0, 3.0));
}
