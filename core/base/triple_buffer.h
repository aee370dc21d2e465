/// core/base/triple_buffer.h: mailbox of plain values from one writer thread to one reader thread. The latest value wins; wait-free on both
/// sides.
#pragma once

#include <type_traits>

#include "core/base/snapshot_buffer.h"

namespace burrhole {

template <class T>
class TripleBuffer {
  static_assert(std::is_trivially_copyable_v<T>, "a mailbox carries plain values only");

 public:
  explicit TripleBuffer(const T& initial = {}) { buffer_.slots().fill(initial); }
  /// Writer: publishes a new value. A previous value that was not read is dropped.
  void publish(const T& value) noexcept BH_REALTIME {
    buffer_.back() = value;
    buffer_.publish();
  }
  /// Reader: the newest value. The reference stays valid until the next call.
  [[nodiscard]] const T& latest() noexcept BH_REALTIME { return buffer_.latest(); }

 private:
  SnapshotBuffer<T> buffer_;
};

}  // namespace burrhole
