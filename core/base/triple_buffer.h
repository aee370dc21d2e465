/// core/base/triple_buffer.h: passes the latest value from one writer thread to one reader thread, wait-free on both sides. T is trivially
///   copyable. BH_REALTIME: the function neither blocks nor allocates; tests check it.
#pragma once

#include <type_traits>

#include "core/base/snapshot_buffer.h"

namespace burrhole {

template <class T>
class TripleBuffer {
  static_assert(std::is_trivially_copyable_v<T>, "a TripleBuffer carries trivially copyable values only");

 public:
  explicit TripleBuffer(const T& initial = {}) { buffer_.slots().fill(initial); }
  /// Writer: publishes a new value. A previous value that was not read is dropped.
  void publish(const T& value) noexcept BH_REALTIME {
    buffer_.back() = value;
    buffer_.publish();
  }
  /// Reader: the newest value, `initial` before the first publish(). The reference stays valid until the reader's next call.
  [[nodiscard]] const T& latest() noexcept BH_REALTIME { return buffer_.latest(); }

 private:
  SnapshotBuffer<T> buffer_;
};

}  // namespace burrhole
