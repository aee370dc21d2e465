#include "core/base/snapshot_buffer.h"

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

#include "core/base/random.h"
#include "core/base/triple_buffer.h"

using namespace burrhole;

namespace {

constexpr std::size_t kWords = 24;

/// A value that shows when it is torn: every word follows from the sequence number, and the last word sums the others.
struct Sealed {
  std::uint64_t sequence = 0;
  std::array<std::uint64_t, kWords> words{};
  std::uint64_t checksum = 0;

  void write_half(std::uint64_t number, std::size_t half) {
    if (half == 0) sequence = number;
    for (std::size_t n = half * kWords / 2; n < (half + 1) * kWords / 2; ++n) words[n] = mix64(number + n);
    if (half == 1) checksum = sum();
  }
  void write(std::uint64_t number) {
    write_half(number, 0);
    write_half(number, 1);
  }
  [[nodiscard]] std::uint64_t sum() const {
    std::uint64_t total = sequence;
    for (const std::uint64_t word : words) total += word;
    return total;
  }
  [[nodiscard]] bool whole() const {
    for (std::size_t n = 0; n < kWords; ++n)
      if (words[n] != mix64(sequence + n)) return false;
    return checksum == sum();
  }
};

Sealed sealed(std::uint64_t number) {
  Sealed value;
  value.write(number);
  return value;
}

/// The sabotage: two slots instead of three, so that the writer's next slot is the one that the reader holds.
struct TwoSlots {
  std::array<Sealed, 2> slots_{sealed(0), sealed(0)};
  std::size_t back_ = 0;
  Sealed& back() { return slots_[back_]; }
  void publish() { back_ ^= 1; }
  const Sealed& latest() { return slots_[back_ ^ 1]; }
};

/// Random interleaving on one thread with the writer stopped half-way through a value: @returns how often what the reader holds is torn.
template <class Buffer>
int torn_when_interleaved(Buffer& buffer, std::uint64_t seed) {
  int torn = 0;
  std::uint64_t number = 1;
  std::size_t half = 0;
  const Sealed* held = &buffer.latest();
  for (std::uint64_t step = 0; step < 2000; ++step) {
    const double choice = uniform01(seed, step);
    if (choice < 0.7) {
      buffer.back().write_half(number, half);
      half ^= 1;
      if (half == 0) {
        buffer.publish();
        ++number;
      }
    } else {
      held = &buffer.latest();
    }
    torn += held->whole() ? 0 : 1;
  }
  return torn;
}

}  // namespace

TEST_CASE("TripleBuffer: the initial value is there before anything is published") {
  TripleBuffer<int> mailbox(7);
  CHECK(mailbox.latest() == 7);
  CHECK(mailbox.latest() == 7);
}

TEST_CASE("TripleBuffer: latest wins, values not taken are dropped, a value taken stays until a newer one") {
  TripleBuffer<int> mailbox;
  mailbox.publish(1);
  CHECK(mailbox.latest() == 1);
  CHECK(mailbox.latest() == 1);
  for (int value = 2; value <= 9; ++value) mailbox.publish(value);
  CHECK(mailbox.latest() == 9);
  mailbox.publish(10);
  mailbox.publish(11);
  mailbox.publish(12);
  CHECK(mailbox.latest() == 12);
  CHECK(mailbox.latest() == 12);
}

TEST_CASE("TripleBuffer: a reference taken keeps its value however often the writer publishes") {
  TripleBuffer<int> mailbox;
  mailbox.publish(1);
  const int& held = mailbox.latest();
  for (int value = 2; value < 20; ++value) {
    mailbox.publish(value);
    CHECK(held == 1);
  }
  CHECK(mailbox.latest() == 19);
}

TEST_CASE("SnapshotBuffer: the writer's slot is never the reader's, and the three slots stay distinct") {
  SnapshotBuffer<int> buffer;
  for (std::uint64_t step = 0; step < 500; ++step) {
    if (uniform01(3, step) < 0.6) buffer.publish();
    const int* front = uniform01(4, step) < 0.5 ? &buffer.latest() : nullptr;
    REQUIRE(buffer.back_index() < 3);
    REQUIRE(&buffer.back() == &buffer.slots()[buffer.back_index()]);
    if (front != nullptr) REQUIRE(front != &buffer.back());
  }
}

TEST_CASE("SnapshotBuffer: a reader interleaved with half-written values never holds a torn one, and two slots are caught tearing") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    SnapshotBuffer<Sealed> buffer;
    buffer.slots().fill(sealed(0));
    CHECK(torn_when_interleaved(buffer, seed) == 0);
    TwoSlots sabotaged;
    CHECK(torn_when_interleaved(sabotaged, seed) > 0);
  }
}

TEST_CASE("TripleBuffer: two threads, every value read is whole and none is older than the one before") {
  constexpr std::uint64_t kCount = 20000;
  TripleBuffer<Sealed> mailbox(sealed(0));
  std::thread writer([&] {
    for (std::uint64_t number = 1; number <= kCount; ++number) mailbox.publish(sealed(number));
  });
  int torn = 0, backwards = 0;
  std::uint64_t last = 0;
  for (std::uint64_t read = 0; read < 20 * kCount && last < kCount; ++read) {
    const Sealed& value = mailbox.latest();
    torn += value.whole() ? 0 : 1;
    backwards += value.sequence < last ? 1 : 0;
    last = value.sequence;
    if (read % 64 == 0) std::this_thread::yield();
  }
  writer.join();
  CHECK(torn == 0);
  CHECK(backwards == 0);
  CHECK(mailbox.latest().sequence == kCount);
  CHECK(mailbox.latest().whole());
}

TEST_CASE("SnapshotBuffer: two threads, a slot caught up in place is handed over whole") {
  constexpr std::uint64_t kCount = 20000;
  SnapshotBuffer<Sealed> buffer;
  buffer.slots().fill(sealed(0));
  std::atomic<bool> started{false};
  std::thread writer([&] {
    started = true;
    for (std::uint64_t number = 1; number <= kCount; ++number) {
      buffer.back().write(number);
      buffer.publish();
    }
  });
  while (!started) std::this_thread::yield();
  int torn = 0, backwards = 0;
  std::uint64_t last = 0;
  for (std::uint64_t read = 0; read < 20 * kCount && last < kCount; ++read) {
    const Sealed& value = buffer.latest();
    torn += value.whole() ? 0 : 1;
    backwards += value.sequence < last ? 1 : 0;
    last = value.sequence;
    if (read % 64 == 0) std::this_thread::yield();
  }
  writer.join();
  CHECK(torn == 0);
  CHECK(backwards == 0);
  CHECK(buffer.latest().sequence == kCount);
}
