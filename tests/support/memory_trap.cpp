#include "tests/support/memory_trap.h"

#include <dlfcn.h>
#include <malloc.h>
#include <pthread.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace {

thread_local bool on_path = false;
thread_local std::uint64_t allocations = 0, locks = 0;
thread_local std::int64_t held = 0, most_held = 0;  // [bytes]

/// Adds a call, and the size of the block that it allocated or is about to free. @returns the block.
void* note(void* block, int sign) noexcept {
  if (!on_path) return block;
  if (sign > 0) ++allocations;
  held += sign * static_cast<std::int64_t>(malloc_usable_size(block));
  most_held = std::max(most_held, held);
  return block;
}

}  // namespace

namespace burrhole::test {

void set_trap(bool on) noexcept { on_path = on; }
void clear_trap() noexcept {
  allocations = locks = 0;
  held = most_held = 0;
}
TrapCounts trapped() noexcept { return {allocations, locks, held, most_held}; }

void break_the_rules() noexcept {
  void* volatile block = std::malloc(16);
  std::free(block);
  static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&mutex);
  pthread_mutex_unlock(&mutex);
}

}  // namespace burrhole::test

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) { return note(__libc_malloc(size), 1); }
void* calloc(std::size_t count, std::size_t size) { return note(__libc_calloc(count, size), 1); }
void* realloc(void* block, std::size_t size) {
  note(block, -1);
  return note(__libc_realloc(block, size), 1);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return note(__libc_memalign(alignment, size), 1); }
void* memalign(std::size_t alignment, std::size_t size) { return note(__libc_memalign(alignment, size), 1); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = note(__libc_memalign(alignment, size), 1);
  return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) {
  allocations += on_path ? 1 : 0;
  note(block, -1);
  __libc_free(block);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  using Lock = int (*)(pthread_mutex_t*);
  static const Lock real = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  locks += on_path ? 1 : 0;
  return real(mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
  using Lock = int (*)(pthread_rwlock_t*);
  static const Lock real = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_rwlock_rdlock"));
  locks += on_path ? 1 : 0;
  return real(lock);
}
int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  using Wait = int (*)(pthread_cond_t*, pthread_mutex_t*);
  static const Wait real = reinterpret_cast<Wait>(dlsym(RTLD_NEXT, "pthread_cond_wait"));
  locks += on_path ? 1 : 0;
  return real(condition, mutex);
}
}
