/// core/base/snapshot_buffer.h: hands large values from one writer to one reader by index swap, wait-free on both sides.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "core/base/assert.h"

namespace burrhole {

/// Three slots: the writer owns one, the reader one, the third is exchanged. The writer sees an old value in its slot after each
/// publish() and catches it up (it must know what that slot missed); the reader never waits and never sees half a value.
template <class T>
class SnapshotBuffer {
 public:
  /// Writer: the slot to bring up to date before publish().
  [[nodiscard]] T& back() noexcept { return slots_[back_]; }
  [[nodiscard]] std::size_t back_index() const noexcept { return back_; }
  /// Writer: hands the slot over; an older one not yet taken comes back to the writer.
  void publish() noexcept BH_REALTIME {
    back_ = shared_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }
  /// Reader: the newest value; the reference stays good until the next call.
  [[nodiscard]] const T& latest() noexcept BH_REALTIME {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) != 0) front_ = shared_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return slots_[front_];
  }
  /// Reader: what latest() gave, without looking for a newer one.
  [[nodiscard]] const T& front() const noexcept { return slots_[front_]; }
  /// All slots, for set-up before the threads run.
  [[nodiscard]] std::array<T, 3>& slots() noexcept { return slots_; }
  [[nodiscard]] const std::array<T, 3>& slots() const noexcept { return slots_; }

 private:
  static constexpr std::uint8_t kIndex = 3, kFresh = 4;
  std::array<T, 3> slots_{};
  std::uint8_t back_ = 0;   // writer's
  std::uint8_t front_ = 2;  // reader's
  std::atomic<std::uint8_t> shared_{1};
};

}  // namespace burrhole
