#include <doctest/doctest.h>

#include <atomic>
#include <vector>

#include "core/base/parallel.h"

using namespace burrhole;

TEST_CASE("parallel: each number once, whatever the number of threads") {
  for (const int count : {0, 1, 2, 1000})
    for (const std::size_t threads : {std::size_t{1}, std::size_t{2}, std::size_t{64}}) {
      std::vector<std::atomic<int>> calls(static_cast<std::size_t>(count));
      for_each_number(count, threads, [&](int n) { ++calls[static_cast<std::size_t>(n)]; });
      for (const auto& n : calls) REQUIRE(n == 1);
    }
}
