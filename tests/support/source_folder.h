/// tests/support/source_folder.h: paths in the sources and in the build folder. One file knows both folders, so that the compiler cache serves
/// all the others in another clone.
#pragma once

#include <string>
#include <string_view>

namespace burrhole::test {

/// @returns the absolute path of PATH, given relative to the top of the sources; empty: the top itself, without a slash at the end.
[[nodiscard]] std::string in_source(std::string_view path);
/// The same in the build folder.
[[nodiscard]] std::string in_build(std::string_view path);

}  // namespace burrhole::test
