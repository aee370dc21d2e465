#include "core/heat/thermal_dose.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace burrhole;

TEST_CASE("thermal dose: published pairs of temperature and time") {
  CHECK(thermal_dose(43.0, 60.0) == doctest::Approx(1.0).epsilon(1e-12));
  CHECK(thermal_dose(47.0, 60.0) == doctest::Approx(16.0).epsilon(1e-12));
  CHECK(thermal_dose(50.0, 30.0) == doctest::Approx(64.0).epsilon(1e-12));
  CHECK(thermal_dose(42.0, 60.0) == doctest::Approx(0.25).epsilon(1e-12));  // not 0.5: the base differs below 43 C
}

TEST_CASE("thermal dose: it adds up over time, and stays finite at any temperature") {
  double sum = 0.0;
  for (int n = 0; n < 600; ++n) sum += thermal_dose(48.5, 0.1);
  CHECK(sum == doctest::Approx(thermal_dose(48.5, 60.0)).epsilon(1e-12));
  CHECK(thermal_dose(1e9, 1.0) == thermal_dose(kHottestOfDose, 1.0));
  CHECK(std::isfinite(static_cast<double>(static_cast<float>(1e6 * thermal_dose(1e9, 1.0)))));
  CHECK(thermal_dose(-1e9, 1.0) == 0.0);
}
