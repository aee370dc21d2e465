#include "app/bench/machine.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <chrono>

#include "core/base/cpu_model.h"
#include "core/base/simd.h"

namespace burrhole {
namespace {

#ifdef __clang__
constexpr const char* kCompiler = "clang " __clang_version__;
#else
constexpr const char* kCompiler = "g++ " __VERSION__;
#endif

unsigned usable_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  if (::sched_getaffinity(0, sizeof cores, &cores) == 0) return static_cast<unsigned>(CPU_COUNT(&cores));
  return static_cast<unsigned>(::sysconf(_SC_NPROCESSORS_ONLN));
}

}  // namespace

BenchMachine this_machine(std::string revision) {
  const std::string build_type = BH_BUILD_TYPE;
  return {.cpu = cpu_model(),
          .cores = usable_cores(),
          .simd = simd_in_use(),
          .compiler = kCompiler,
          .build_type = build_type.empty() ? "none" : build_type,
          .revision = std::move(revision),
          .date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())))};
}

}  // namespace burrhole
