/// core/base/descriptor.h: the owner of a file descriptor, and calls of the system that a signal does not fail.
///   Thread  one owner.   Source  open(2), close(2), signal(7).
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <utility>

namespace burrhole {

/// Closes its descriptor.
class Descriptor {
 public:
  explicit Descriptor(int file = -1) noexcept : file_(file) {}
  Descriptor(Descriptor&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }
  ~Descriptor() {
    if (file_ >= 0) ::close(file_);
  }
  [[nodiscard]] int get() const noexcept { return file_; }  ///< below 0: none
  /// @returns 0, or errno: some file systems report a failed write only here.
  [[nodiscard]] int close() noexcept {
    const int file = std::exchange(file_, -1);
    // Linux closes the descriptor also if a signal interrupts.
    return file < 0 || ::close(file) == 0 || errno == EINTR ? 0 : errno;
  }

 private:
  int file_;
};

[[nodiscard]] inline bool is_stopped(const std::atomic<bool>* stop) noexcept {
  return stop != nullptr && stop->load(std::memory_order_relaxed);
}

/// Repeats a call that a signal interrupted. @param call returns below 0 and sets errno when it fails. @param stop once true, an interrupted
/// call is not repeated. @returns the value of the last call.
template <class Call>
[[nodiscard]] auto repeat_interrupted(Call call, const std::atomic<bool>* stop = nullptr) noexcept {
  auto value = call();
  while (value < 0 && errno == EINTR && !is_stopped(stop)) value = call();
  return value;
}

/// As open(2), again when a signal interrupts: on network file systems it may wait, and a pipe waits for its other end. @param stop as of
/// repeat_interrupted(). @returns below 0: errno says why.
[[nodiscard]] inline int open_descriptor(const char* path, int flags, mode_t mode = 0, const std::atomic<bool>* stop = nullptr) noexcept {
  return repeat_interrupted([&] { return ::open(path, flags | O_CLOEXEC | O_NOCTTY, mode); }, stop);
}

}  // namespace burrhole
