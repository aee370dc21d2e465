/// app/scene/other_branch.h: says of a key or table that is unknown in one file which choice in the file would read it.
///   Uses the samples of schema_samples.h, so every choice of the reference is covered.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/config/toml.h"

namespace burrhole {

/// @param path of the table, elements of arrays as "region[0]"; @param key in it.
/// @returns when scenes, tools or descriptions of raw volumes read this key, such as "only with kind = feed"; nothing if they never do or
/// always do.
[[nodiscard]] std::optional<std::string> when_read(std::string_view path, std::string_view key);

/// Rewrites each issue of a TableReader about an unknown key or table that another choice in the file would read, with the next step.
void explain_unknown_keys(Issues& issues);

}  // namespace burrhole
