#include "volumes/read/memory_check.h"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

using namespace burrhole;

TEST_CASE("available_memory: the line of MemAvailable in bytes, wherever it stands, and nothing without it") {
  constexpr const char* kRest = "MemTotal:       24683520 kB\nMemFree:        20500480 kB\n";
  CHECK(available_memory(std::string(kRest) + "MemAvailable:   23769088 kB\nBuffers: 1 kB\n") == 23769088.0 * 1024.0);
  CHECK(available_memory("MemAvailable: 7 kB\n") == 7.0 * 1024.0);
  for (const char* const text : {"", kRest, "NoMemAvailable: 7 kB\n", "MemAvailable:", "MemAvailable:   \n", "MemAvailable: seven kB\n",
                                 "MemAvailable: 7 MB\n", "MemAvailable: 99999999999999999999999 kB\n"}) {
    CAPTURE(text);
    CHECK_FALSE(available_memory(text).has_value());
  }
}

TEST_CASE("memory_error: more than there is is refused with both numbers") {
  CHECK_FALSE(memory_error(4e9, 4e9));
  CHECK(memory_error(8.589934592e9, 4e9).value_or("") == "needs 8.59 GB of memory, 4 GB are available");
  CHECK_FALSE(memory_error(0.0));
  // No machine has an exabyte.
  if (available_memory()) CHECK(memory_error(1e18));
}

TEST_CASE("available_memory: a limit of the address space bounds it") {
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_AS, &before) == 0);
  const auto machine = available_memory();
  REQUIRE(machine.has_value());
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages;
  constexpr double kLeft = 5e7;  // [bytes]
  rlimit tight = before;
  tight.rlim_cur = static_cast<rlim_t>(pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) + kLeft);
  REQUIRE(::setrlimit(RLIMIT_AS, &tight) == 0);
  const auto limited = available_memory();
  const auto refused = memory_error(1e8), fits = memory_error(1e6);
  REQUIRE(::setrlimit(RLIMIT_AS, &before) == 0);
  REQUIRE(limited.has_value());
  CHECK(*limited <= kLeft);
  CHECK(*limited > 0.5 * kLeft);  // the reading of /proc itself takes some
  CHECK(refused.has_value());
  CHECK_FALSE(fits.has_value());
}
