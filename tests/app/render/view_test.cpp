#include "app/view/view.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace burrhole;

TEST_CASE("normal code: eq. 6 undoes eq. 5 within the rounding of 8 bits") {
  for (int n = 0; n < 500; ++n) {
    const double z = -1.0 + 2.0 * n / 499.0, angle = 2.399963 * n, r = std::sqrt(std::max(0.0, 1.0 - z * z));
    const Vec3 normal(r * std::cos(angle), r * std::sin(angle), z);
    const Rgba8 code = encode_normal(normal, 77);
    const Vec3 back = decode_normal(code);
    // Half a level of 255 in the code is 1/255 in the normal.
    for (int axis = 0; axis < 3; ++axis) REQUIRE(std::abs(back[axis] - normal[axis]) <= 1.0 / 255.0 + 1e-12);
    REQUIRE(code.a == 77);
  }
}

TEST_CASE("normal code: an unknown normal stays near zero, so that a reader can recognise it") {
  CHECK(glm::length(decode_normal(encode_normal(Vec3(0.0), 255))) < 0.01);
  CHECK(encode_normal(Vec3(2.0, -2.0, 0.0), 0) == Rgba8{255, 0, 128, 0});
}
