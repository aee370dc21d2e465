/// app/bench/machine.h: the machine and the build that produced a bench.json.
#pragma once

#include <string>

namespace burrhole {

/// What one run of the program was measured on and with.
struct BenchMachine {
  std::string cpu;         ///< model name, or "unknown"
  unsigned cores = 0;      ///< that this process may use
  std::string simd;        ///< level of the vector kernels
  std::string compiler;    ///< name and version
  std::string build_type;  ///< of CMake, or "none"
  std::string revision;    ///< of the sources, as the caller names it; may be empty
  std::string date;        ///< of the run, UTC, YYYY-MM-DD
};

/// @param revision is copied. @returns what the system and the build report; the date is today's.
[[nodiscard]] BenchMachine this_machine(std::string revision);

}  // namespace burrhole
