/// core/base/spsc_queue.h: queue of events from one writer thread to one reader thread, in order; wait-free on both sides.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "core/base/assert.h"

namespace burrhole {

/// Holds up to `kCapacity` values. push() returns false if the queue is full; the writer decides how to react.
template <class T, std::size_t kCapacity>
class SpscQueue {
  static_assert(std::is_trivially_copyable_v<T> && kCapacity > 0 && (kCapacity & (kCapacity - 1)) == 0, "plain values, a power of two");

 public:
  SpscQueue() : ring_(std::make_unique<T[]>(kCapacity)) {}
  /// Writer. @returns false, and drops the value, if the queue holds kCapacity values.
  bool push(const T& value) noexcept BH_REALTIME {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) return false;
    ring_[head & (kCapacity - 1)] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Reader. @returns false if the queue is empty.
  bool pop(T& value) noexcept BH_REALTIME {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = ring_[tail & (kCapacity - 1)];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::unique_ptr<T[]> ring_;
  // Separate cache lines: otherwise each value would move the line between the cores of writer and reader (false sharing).
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace burrhole
