/// volumes/read/located_json.h: a JSON text as values that know where they stand, for messages with line and column. nlohmann JSON parses.
///   Errors  bad_input with "name:line:column".   Thread  any: values.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

struct JsonValue {
  enum class Kind { null, boolean, number, text, list, object };
  Kind kind = Kind::null;
  bool boolean = false;
  double number = 0.0;                  ///< [-]
  std::string text = {};                ///< UTF-8
  std::vector<JsonValue> items = {};    ///< of a list, or the values of an object
  std::vector<std::string> names = {};  ///< of the members of an object, in the order of the file
  std::size_t at = 0;                   ///< offset of the first byte of the value in the text

  /// @returns the first member of that name; null if the value is no object or has none.
  [[nodiscard]] const JsonValue* find(std::string_view name) const noexcept;
};

/// @returns "name:line:column" of an offset, both counted from 1, the column in bytes.
[[nodiscard]] std::string place_in(std::string_view text, std::size_t at, const std::string& name);

/// @param name of the file, for messages. @returns the root; bad_input: not JSON, nested deeper than 64, numbers beyond double.
[[nodiscard]] Result<JsonValue> parse_json(std::string_view text, const std::string& name);

}  // namespace burrhole
