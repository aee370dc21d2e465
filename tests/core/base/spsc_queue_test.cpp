#include "core/base/spsc_queue.h"

#include <doctest/doctest.h>

#include <cstdint>
#include <thread>

#include "core/base/random.h"

using namespace burrhole;

namespace {

struct Row {
  std::uint64_t number = 0, twice = 0, mixed = 0;
};

}  // namespace

TEST_CASE("SpscQueue: values come out once, in order, and a full queue says so and loses nothing that it took") {
  SpscQueue<int, 4> queue;
  int value = -1;
  CHECK(!queue.pop(value));
  for (int n = 0; n < 4; ++n) CHECK(queue.push(n));
  CHECK(!queue.push(99));
  for (int n = 0; n < 4; ++n) {
    CHECK(queue.pop(value));
    CHECK(value == n);
  }
  CHECK(!queue.pop(value));
  for (int round = 0; round < 10; ++round) {  // past the end of the ring
    CHECK(queue.push(round));
    CHECK(queue.pop(value));
    CHECK(value == round);
  }
}

TEST_CASE("SpscQueue: between two threads every value arrives whole and in order") {
  constexpr std::uint64_t kCount = 200000;
  SpscQueue<Row, 256> queue;
  std::thread writer([&] {
    for (std::uint64_t n = 0; n < kCount; ++n)
      while (!queue.push({n, 2 * n, mix64(n)})) std::this_thread::yield();
  });
  std::uint64_t expected = 0, wrong = 0;
  Row row;
  while (expected < kCount) {
    if (!queue.pop(row)) {
      std::this_thread::yield();
      continue;
    }
    wrong += row.number != expected || row.twice != 2 * expected || row.mixed != mix64(expected);
    ++expected;
  }
  writer.join();
  CHECK(wrong == 0);
}
