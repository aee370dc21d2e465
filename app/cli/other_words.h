/// app/cli/other_words.h: words that other programs use for what burrhole names otherwise, for messages about unknown words.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace burrhole::cli {

/// @returns the command for a word such as "run", "open" or "diff"; nothing if there is none.
[[nodiscard]] std::optional<std::string> command_for(std::string_view word);

/// What to write in place of an option of other programs.
struct OtherOption {
  std::string instead;  ///< as it is typed; words in capitals stand for values
  std::string option;   ///< of burrhole, which the command must have; empty: an argument
};
/// @param option with its hyphens. @returns nothing if there is none.
[[nodiscard]] std::optional<OtherOption> option_for(std::string_view option, bool has_image);

}  // namespace burrhole::cli
