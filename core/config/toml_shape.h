/// core/config/toml_shape.h: limits of the shape of TOML text, checked before toml++ parses it: that builds and frees tables by recursion
///   and without a bound of the parts of a key.   Errors  bad_input with file:line:column.   Thread  any: no state.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/input_file.h"
#include "core/base/result.h"

namespace burrhole {

inline constexpr std::size_t kMostTomlBytes = kTomlInput.most_bytes;
inline constexpr std::size_t kMostNested = 32;     ///< arrays and inline tables one in another
inline constexpr std::size_t kMostKeyParts = 16;   ///< of a dotted key or of the name of a table
inline constexpr std::size_t kLongestKey = 256;    ///< [bytes] of one part
inline constexpr std::size_t kMostTables = 10000;  ///< headers [name] and [[name]]

/// Checks sizes, nesting and keys, and that there is no byte 0. Text that is not TOML passes, up to its first error: toml++ reports that.
[[nodiscard]] Status check_toml_shape(std::string_view text, const std::string& file);

}  // namespace burrhole
