#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <string>
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

TEST_CASE("parallel: an exception of any thread reaches the caller, and no thread is left") {
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}, std::size_t{64}})
    for (const bool all : {false, true}) {
      std::atomic<int> inside{0};
      const auto call = [&](int n) {
        ++inside;
        const bool throws = all || n == 500;
        --inside;
        if (throws) throw std::runtime_error("number " + std::to_string(n));
      };
      CHECK_THROWS_AS(for_each_number(1000, threads, call), std::runtime_error);
      CHECK(inside == 0);
    }
}
