// doctest::Approx, as tests/support/doctest_main.cpp sets it up: its tolerance is a share of the values, however small they are.
#include <doctest/doctest.h>

#include <initializer_list>

TEST_CASE("Approx: a tolerance is relative to values of any size, and no other number is about 0") {
  for (const double size : {1e-12, 1e-9, 1e-3, 1.0, 1e3}) {
    CAPTURE(size);
    CHECK(1.009 * size == doctest::Approx(size).epsilon(0.01));
    CHECK(1.02 * size != doctest::Approx(size).epsilon(0.01));
    CHECK(2.0 * size != doctest::Approx(size).epsilon(0.01));
  }
  CHECK(0.0 == doctest::Approx(0.0));
  CHECK(1e-15 != doctest::Approx(0.0).epsilon(1e-6));
  // Where 1 is the size of the values it can be said.
  CHECK(1e-15 == doctest::Approx(0.0).epsilon(1e-6).scale(1.0));
  CHECK(1e-5 != doctest::Approx(0.0).epsilon(1e-6).scale(1.0));
}
