/// core/base/input_file.h: the reader of whole files that a person names, and the check of those that other readers open.
///   A pipe would wait for a writer and a device may never end, so only regular files are read, and each kind has a largest size.
///   Units  bytes.   Errors  bad_input with the path; text() names line and column of a byte 0.   Thread  any: no state.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace burrhole {

/// What a file is read as.
struct FileLimit {
  std::string_view name;         ///< in the message about its size: "a scene, a tool or another TOML file"
  std::uint64_t most_bytes = 0;  ///< a larger file is refused before it is read
  bool text = true;              ///< a byte 0 is refused
};

inline constexpr FileLimit kTomlInput{"a TOML file", 4u << 20, true};
inline constexpr FileLimit kMarkupsInput{"a markups file", 16'000'000, true};
inline constexpr FileLimit kMeshInput{"a mesh", 1u << 30, false};  // takes about three times its size in memory
inline constexpr FileLimit kResultsInput{"a file of results", 1u << 28, false};
inline constexpr FileLimit kCheckpointInput{"a checkpoint", 1'000'000'000, false};  // SQLite's largest value: sessions contain it

/// @returns the bytes of a regular file of at most kind.most_bytes.
[[nodiscard]] Result<std::string> read_input(const std::string& path, const FileLimit& kind);

/// @returns bad_input unless `path` is a regular file that can be opened for reading: for readers that open it by themselves. Does not wait.
[[nodiscard]] Status check_regular_file(const std::string& path);

/// @returns bad_input with "name:line:column" if the text contains a byte 0.
[[nodiscard]] Status check_no_zero_byte(std::string_view text, const std::string& name);

}  // namespace burrhole
