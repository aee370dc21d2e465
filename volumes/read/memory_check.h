/// volumes/read/memory_check.h: checks the available memory before a large array is allocated. On systems that overcommit memory, an
///   allocation succeeds and the process is killed on a write, which cannot be caught.
///   Units  bytes.   Errors  one line of text.
///   Source  proc(5): MemAvailable of /proc/meminfo, the memory usable without swapping. Limits of a container are not considered.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace burrhole {

/// @param meminfo the text of /proc/meminfo. @returns the usable memory [bytes], or nothing if the text does not contain it.
[[nodiscard]] std::optional<double> available_memory(std::string_view meminfo);

/// @returns the same for this machine, now; nothing if there is no /proc/meminfo.
[[nodiscard]] std::optional<double> available_memory();

/// @param most [bytes] absent: the available memory of this machine; if that is unknown, no limit.
/// @returns both numbers if an array of `bytes` exceeds the limit; nothing otherwise.
[[nodiscard]] std::optional<std::string> memory_error(double bytes, std::optional<double> most = {});

}  // namespace burrhole
