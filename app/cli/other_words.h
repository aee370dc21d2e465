/// app/cli/other_words.h: words that other programs use for what burrhole names otherwise, for messages about unknown words.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace burrhole::cli {

/// @returns the command for a word such as "run", "open" or "diff"; nothing if there is none.
[[nodiscard]] std::optional<std::string> command_for(std::string_view word);

/// @returns what to do for a word that stands for no command of its own, such as "report" or "sweep"; nothing for others.
[[nodiscard]] std::optional<std::string> advice_for(std::string_view word);

/// What to write in place of an option of other programs.
struct OtherOption {
  std::string instead;  ///< as it is typed; words in capitals stand for values
  std::string option;   ///< of burrhole, which the command must have; empty: an argument
};
/// @param option with its hyphens. @param output option of the command for its one output file; empty: it has --out, or none.
/// @returns nothing if there is none.
[[nodiscard]] std::optional<OtherOption> option_for(std::string_view option, const std::string& output);

}  // namespace burrhole::cli
