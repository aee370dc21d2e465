#include "haptics/servo/realtime.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>
#include <thread>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace burrhole {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t nanoseconds(const timespec& t) noexcept { return static_cast<std::int64_t>(t.tv_sec) * kSecond + t.tv_nsec; }

}  // namespace

#if defined(__SSE2__)
FlushToZero::FlushToZero() noexcept : before_(_mm_getcsr()) {
  constexpr unsigned kResultsToZero = 0x8000u, kInputsAreZero = 0x0040u;
  _mm_setcsr(before_ | kResultsToZero | kInputsAreZero);
}
FlushToZero::~FlushToZero() { _mm_setcsr(before_); }
#else
FlushToZero::FlushToZero() noexcept = default;
FlushToZero::~FlushToZero() = default;
#endif

namespace {

/// @returns the limit [bytes] under which this user may lock memory; nothing without a limit.
std::optional<rlim_t> lock_limit() noexcept {
  rlimit limit{};
  if (::geteuid() == 0 || ::getrlimit(RLIMIT_MEMLOCK, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  return limit.rlim_cur;
}

}  // namespace

// A live run starts its threads anew after each pause, and glibc gives threads heaps of their own. What one thread takes and another gives
// back then leaves gaps in all of them: 21,000 inputs grew the memory by 2 %, with two heaps by 0.3 %.
constexpr int kHeaps = 2;

bool may_lock_memory() noexcept { return !lock_limit(); }

LockedMemory::LockedMemory() noexcept {
#ifdef M_ARENA_MAX
  ::mallopt(M_ARENA_MAX, kHeaps);
#endif
  // Under a memory limit, locking may succeed now and later allocations of the program then fail.
  if (const auto limit = lock_limit())
    refusal_ = "at most " + std::to_string(*limit / 1024) + " KiB";
  else if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    refusal_ = std::strerror(errno);
}
LockedMemory::~LockedMemory() {
  if (refusal_.empty()) ::munlockall();
}

int ask_for_fifo(int above) noexcept {
  sched_param parameters{};
  parameters.sched_priority = sched_get_priority_min(SCHED_FIFO) + above;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

std::string refusal_text(int priority_error, const std::string& memory) {
  std::string text;
  if (priority_error != 0) text = std::string("real-time priority was refused (") + std::strerror(priority_error) + ")";
  if (!memory.empty()) text += (text.empty() ? "" : ", ") + ("locking memory was refused (" + memory + ")");
  return text;
}

std::string realtime_refusal() {
  int error = 0;
  std::thread([&] { error = ask_for_fifo(kServoAbove); }).join();
  return refusal_text(error, LockedMemory().refusal());
}

TickClock::TickClock(const timespec& start, double period, double offset) noexcept
    : plan_(nanoseconds(start) + std::llround(offset * 1e9), std::llround(period * 1e9)) {}

TickPlan::Tick TickPlan::next(std::int64_t now) noexcept {
  Tick out;
  if (const std::int64_t late = now - next_; late <= 0) {
    overdue_ = false;
  } else {
    // The newest tick that is due, or the first future one.
    const std::int64_t dropped = late / period_ + (overdue_ ? 1 : 0);
    out.ticks += static_cast<std::uint64_t>(dropped);
    next_ += dropped * period_;
    overdue_ = !overdue_;
  }
  out.due = next_;
  next_ += period_;
  return out;
}

TickClock::Wake TickClock::wait() noexcept {
  const TickPlan::Tick tick = plan_.next(nanoseconds(now_monotonic()));
  const timespec due{static_cast<time_t>(tick.due / kSecond), static_cast<long>(tick.due % kSecond)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
  return {tick.ticks, static_cast<float>(nanoseconds(now_monotonic()) - tick.due) * 1e-3f};
}

timespec now_monotonic() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now;
}

float microseconds(const timespec& from, const timespec& to) noexcept {
  return static_cast<float>(nanoseconds(to) - nanoseconds(from)) * 1e-3f;
}

}  // namespace burrhole
