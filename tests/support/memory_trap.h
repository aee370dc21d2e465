/// tests/support/memory_trap.h: counts blocks of memory and locks taken on a real-time path. A program that links this has its own malloc and
/// pthread locks, which count while the calling thread has its trap set. Not for sanitizers, which replace malloc too.
#pragma once

#include <cstdint>

namespace burrhole::test {

/// Of one thread since clear_trap().
struct TrapCounts {
  std::uint64_t allocations = 0;  ///< malloc and its kin, free included
  std::uint64_t locks = 0;        ///< mutexes, read locks, waits on conditions
  std::int64_t held = 0;          ///< [bytes] allocated less freed, as the allocator rounds them
  std::int64_t most_held = 0;     ///< [bytes] largest value of held
};

void set_trap(bool on) noexcept;
void clear_trap() noexcept;
[[nodiscard]] TrapCounts trapped() noexcept;

/// Takes one block and gives it back, and takes one lock: for tests that a trap sees what it must.
void break_the_rules() noexcept;

/// Runs f with the trap set.
template <class F>
void on_trap(F&& f) {
  set_trap(true);
  f();
  set_trap(false);
}

}  // namespace burrhole::test
