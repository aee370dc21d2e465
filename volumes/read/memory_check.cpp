#include "volumes/read/memory_check.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>

namespace burrhole {

std::optional<double> available_memory(std::string_view meminfo) {
  constexpr std::string_view kKey = "MemAvailable:";
  std::size_t at = meminfo.starts_with(kKey) ? 0 : meminfo.find("\nMemAvailable:");
  if (at == std::string_view::npos) return std::nullopt;
  at = meminfo.find_first_not_of(' ', meminfo.find(':', at) + 1);
  if (at == std::string_view::npos) return std::nullopt;
  std::uint64_t kibibytes = 0;
  const char* const end = meminfo.data() + meminfo.size();
  const auto [rest, error] = std::from_chars(meminfo.data() + at, end, kibibytes);
  if (error != std::errc() || !std::string_view(rest, static_cast<std::size_t>(end - rest)).starts_with(" kB")) return std::nullopt;
  return static_cast<double>(kibibytes) * 1024.0;
}

namespace {

/// @returns what this process may still add to its address space; nothing without a limit.
std::optional<double> left_of_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(::sysconf(_SC_PAGESIZE)));
}

}  // namespace

std::optional<double> available_memory() {
  std::ifstream file("/proc/meminfo");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::optional<double> machine = available_memory(text), process = left_of_limit();
  return machine && process ? std::min(*machine, *process) : process ? process : machine;
}

std::optional<std::string> memory_error(double bytes, std::optional<double> limit) {
  if (!limit) limit = available_memory();
  if (!limit || bytes <= *limit) return std::nullopt;
  return fmt::format("needs {:.3g} GB of memory, {:.3g} GB are available", bytes * 1e-9, *limit * 1e-9);
}

}  // namespace burrhole
