/// tests/support/skip.h: ends a test program where this machine lacks what its cases need.
#pragma once

#include <string>

namespace burrhole::test {

/// Prints the reason and ends the program: with 77, which ctest counts as skipped, or with 1 if a case has failed already.
[[noreturn]] void skip(const std::string& reason);

}  // namespace burrhole::test
