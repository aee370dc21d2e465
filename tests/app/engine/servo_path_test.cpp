// The servo path takes no memory and no lock over a whole drilled scene: malloc and the locks of this program are ours, and count while the
// servo is between reading the hand and pushing it.
#include <dlfcn.h>
#include <doctest/doctest.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "tests/support/drill_scene.h"

namespace {

thread_local bool on_path = false;
thread_local std::uint64_t allocations = 0, locks = 0;

void note_allocation() noexcept { allocations += on_path ? 1 : 0; }

}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
  note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  note_allocation();
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note_allocation();
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  note_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  note_allocation();
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) {
  note_allocation();
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

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// A run ends once so many were run: a busy machine sleeps through some, and none of those is counted. The bit is slow and the hand feels
/// no give, so that neither ends the run before; on a machine that starves the contact loop a latched fault may.
constexpr std::uint64_t kTicks = 1500;
constexpr std::uint64_t kEnough = 300;  // most of them with bone under the bit: every branch of the step is taken many times

/// Marks the servo's path: from reading the hand until it is pushed, its own step included. Sums up what this thread counted.
class MarkedHand final : public HandSource {
 public:
  MarkedHand(const LoadedScene& loaded, bool sabotage, std::atomic<bool>& enough)
      : hand_(loaded, [] {}), sabotage_(sabotage), enough_(&enough) {}
  const HandState& read() noexcept override {
    on_path = true;
    ++ticks;
    return hand_.read();
  }
  void apply(const Wrench& on_hand) noexcept override {
    if (sabotage_ && ticks == 100) {
      std::free(std::malloc(16));
      static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
      pthread_mutex_lock(&mutex);
      pthread_mutex_unlock(&mutex);
    }
    hand_.apply(on_hand);
    if (ticks == kTicks) *enough_ = true;
    on_path = false;
    taken = allocations;
    locked = locks;
  }
  std::uint64_t ticks = 0, taken = 0, locked = 0;

 private:
  WatchedHand hand_;
  bool sabotage_;
  std::atomic<bool>* enough_;
};

MarkedHand drilled(const std::vector<std::string>& sets, bool live, bool sabotage) {
  SmallScene scene{.sets = {"duration_s=60", "hand.standoff_mm=0.5", "tool.erosion_scale=0.1", "hand.give_mm_per_s=1000"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  const LoadedScene loaded = load_small(scene);
  std::atomic<bool> enough{false};
  MarkedHand hand(loaded, sabotage, enough);
  SimulationOptions options;
  options.hand = &hand;
  options.stop = &enough;
  options.live = live;
  DrillRun run(scene, options);
  allocations = locks = 0;
  run.run();
  on_path = false;
  CHECK(run.simulation().bone_step().removed_mass() > 0.0);
  return hand;
}

}  // namespace

TEST_CASE("servo path: no memory and no lock is taken while a hole is drilled on threads, by any scheme") {
  for (const char* scheme : {"planes", "gradient", "hold", "linear"}) {
    CAPTURE(scheme);
    const MarkedHand hand = drilled({std::string("servo.multirate=\"") + scheme + "\"", "contact.rate_hz=200"}, true, false);
    CHECK(hand.ticks >= kEnough);
    CHECK(hand.taken == 0);
    CHECK(hand.locked == 0);
  }
}

TEST_CASE("servo path: with every limit on, too") {
  const MarkedHand hand = drilled({"servo.slew_N_per_s=1000", "servo.soft_start_s=0.2", "servo.energy_mJ=1000",
                                   "servo.passivity_N_s_per_m=5", "servo.relied_on_N_s_per_m=5"},
                                  true, false);
  CHECK(hand.taken == 0);
  CHECK(hand.locked == 0);
}

TEST_CASE("servo path: a single block of memory or lock on it is seen") {
  const MarkedHand sound = drilled({}, true, false), harmed = drilled({}, true, true);
  CHECK(sound.taken == 0);
  CHECK(harmed.taken == 2);
  CHECK(harmed.locked == 1);
}
