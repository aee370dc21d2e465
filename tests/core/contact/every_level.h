/// tests/core/contact/every_level.h: the same check at every SIMD level of this machine.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "core/base/simd.h"

namespace burrhole {

/// Calls f once a level of this machine, then at the best, and goes back.
template <class F>
void at_all_levels(F&& f) {
  const SimdLevelGuard guard;
  for (const SimdLevel level : simd_levels()) {
    REQUIRE(choose_simd(name_of(level)).ok());
    CAPTURE(std::string(name_of(level)));
    f();
  }
  REQUIRE(choose_simd("auto").ok());
  f();
}

}  // namespace burrhole
