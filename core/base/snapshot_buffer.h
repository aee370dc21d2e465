/// core/base/snapshot_buffer.h: transfers large values from one writer thread to one reader thread by index swap; wait-free on both sides.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "core/base/assert.h"

namespace burrhole {

/// Three slots: the writer owns one, the reader owns one, and the third is exchanged. After each publish() the writer owns a slot with an
/// older value and must bring it up to date, so it must track what that slot missed. The reader never waits and never sees a partly written
/// value. Where one thread writes and reads, one slot suffices.
template <class T>
class SnapshotBuffer {
 public:
  /// Before the first use: one thread writes and reads, and back() is always what latest() returns.
  void use_one_slot() noexcept { shared_ = back_ = front_ = 0; }
  /// Writer: the slot to update before publish().
  [[nodiscard]] T& back() noexcept { return slots_[back_]; }
  [[nodiscard]] std::size_t back_index() const noexcept { return back_; }
  /// Writer: passes the slot to the reader. If the previous slot was not taken, it returns to the writer.
  void publish() noexcept BH_REALTIME {
    back_ = shared_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }
  /// Reader: the newest published value. The reference stays valid until the next call.
  [[nodiscard]] const T& latest() noexcept BH_REALTIME {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) != 0) front_ = shared_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return slots_[front_];
  }
  /// Reader: the value that the last call of latest() returned.
  [[nodiscard]] const T& front() const noexcept { return slots_[front_]; }
  /// All slots, for initialisation before the threads start.
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
