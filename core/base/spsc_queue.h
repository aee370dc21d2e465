/// core/base/spsc_queue.h: events that must arrive, from one writer to one reader, in order, wait-free on both sides.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "core/base/assert.h"

namespace burrhole {

/// Holds up to `Capacity` values. A writer that finds it full is told and keeps going; what to do about it is the writer's.
template <class T, std::size_t Capacity>
class SpscQueue {
  static_assert(std::is_trivially_copyable_v<T> && Capacity > 0 && (Capacity & (Capacity - 1)) == 0, "plain values, a power of two");

 public:
  SpscQueue() : ring_(std::make_unique<T[]>(Capacity)) {}
  /// Writer. @returns false, and drops the value, when the reader is Capacity values behind.
  bool push(const T& value) noexcept BH_REALTIME {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == Capacity) return false;
    ring_[head & (Capacity - 1)] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Reader. @returns false when there is nothing.
  bool pop(T& value) noexcept BH_REALTIME {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = ring_[tail & (Capacity - 1)];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::unique_ptr<T[]> ring_;
  // Lines of their own: writer and reader would otherwise take them from each other at every value.
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace burrhole
