/// core/base/child_attributes.h: attributes of posix_spawn for the programs that this one starts. SIGPIPE has its default action in them, which
///   many programs rely on; in this program it is ignored, and what is ignored would be inherited.
///   Thread  one owner.   Source  posix_spawnattr_setsigdefault(3).
#pragma once

#include <spawn.h>

#include <csignal>

namespace burrhole {

class ChildAttributes {
 public:
  /// @param own_group puts the program into a process group of its own: Ctrl-C does not reach it.
  explicit ChildAttributes(bool own_group = false) noexcept {
    ::posix_spawnattr_init(&attributes_);
    sigset_t restored;
    sigemptyset(&restored);
    sigaddset(&restored, SIGPIPE);
    ::posix_spawnattr_setsigdefault(&attributes_, &restored);
    ::posix_spawnattr_setflags(&attributes_, static_cast<short>(POSIX_SPAWN_SETSIGDEF | (own_group ? POSIX_SPAWN_SETPGROUP : 0)));
  }
  ChildAttributes(const ChildAttributes&) = delete;
  ChildAttributes& operator=(const ChildAttributes&) = delete;
  ~ChildAttributes() { ::posix_spawnattr_destroy(&attributes_); }
  [[nodiscard]] const posix_spawnattr_t* get() const noexcept { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

}  // namespace burrhole
