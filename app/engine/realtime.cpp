#include "app/engine/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cmath>
#include <cstring>
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

LockedMemory::LockedMemory() noexcept {
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) refusal_ = std::strerror(errno);
}
LockedMemory::~LockedMemory() {
  if (refusal_.empty()) ::munlockall();
}

int ask_for_fifo(int above) noexcept {
  sched_param parameters{};
  parameters.sched_priority = sched_get_priority_min(SCHED_FIFO) + above;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

std::string refusal_text(int priority_fault, const std::string& memory) {
  std::string text;
  if (priority_fault != 0) text = std::string("real-time priority was refused (") + std::strerror(priority_fault) + ")";
  if (!memory.empty()) text += (text.empty() ? "" : ", ") + ("locking memory was refused (" + memory + ")");
  return text;
}

std::string realtime_refusal() {
  int fault = 0;
  std::thread([&] { fault = ask_for_fifo(0); }).join();
  return refusal_text(fault, LockedMemory().refusal());
}

TickClock::TickClock(const timespec& start, double period, double offset) noexcept
    : next_ns_(nanoseconds(start) + std::llround(offset * 1e9)), period_ns_(std::llround(period * 1e9)) {}

TickClock::Wake TickClock::wait() noexcept {
  Wake wake;
  const std::int64_t before = nanoseconds(now_monotonic());
  if (before > next_ns_ + period_ns_) {
    // Whole periods were missed: the newest tick is taken at once, the others are told.
    wake.ticks += static_cast<std::uint64_t>((before - next_ns_) / period_ns_);
    next_ns_ += static_cast<std::int64_t>(wake.ticks - 1) * period_ns_;
  }
  const timespec due{static_cast<time_t>(next_ns_ / kSecond), static_cast<long>(next_ns_ % kSecond)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
  wake.late_us = static_cast<float>(nanoseconds(now_monotonic()) - next_ns_) * 1e-3f;
  next_ns_ += period_ns_;
  return wake;
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
