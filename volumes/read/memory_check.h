/// volumes/read/memory_check.h: is there memory for an array, asked before it is made? Where the system promises more than it has, an
/// allocation succeeds and the process is ended when it writes: that cannot be caught, so it is asked for beforehand.
///   Source  proc(5): MemAvailable of /proc/meminfo, what can be used without swapping. What limits a container is not looked at.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace burrhole {

/// @param meminfo the text of /proc/meminfo. @returns [bytes] that can be used, or nothing when it does not say.
[[nodiscard]] std::optional<double> available_memory(std::string_view meminfo);

/// The same of this machine, now; nothing where there is no /proc/meminfo.
[[nodiscard]] std::optional<double> available_memory();

/// @param most [bytes] absent: what this machine has available; where that is not known there is no limit.
/// @returns both numbers when an array of `bytes` is more than that, else nothing.
[[nodiscard]] std::optional<std::string> memory_fault(double bytes, std::optional<double> most = {});

}  // namespace burrhole
