/// volumes/read/memory_check.h: checks the available memory before a large array is allocated. On systems that overcommit memory, an
///   allocation succeeds and the process is killed later, on a write, which cannot be caught.
///   Units  bytes.
///   Source  proc(5): MemAvailable of /proc/meminfo, the memory usable without swapping. Limits of a container are not considered.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace burrhole {

/// @param meminfo the text of /proc/meminfo. @returns the usable memory [bytes], or nothing if the text does not contain it.
[[nodiscard]] std::optional<double> available_memory(std::string_view meminfo);

/// @returns the usable memory [bytes] at the time of the call: of this machine, from /proc/meminfo, and at most what the limit of the address
/// space (ulimit -v) leaves this process; nothing if neither is known.
[[nodiscard]] std::optional<double> available_memory();

/// @param limit [bytes] default: available_memory(), or no limit if that is unknown.
/// @returns a message with the required and the available size if `bytes` exceeds the limit; nothing otherwise.
[[nodiscard]] std::optional<std::string> memory_error(double bytes, std::optional<double> limit = {});

}  // namespace burrhole
