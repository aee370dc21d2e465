/// tests/support/sanitized.h: whether a sanitizer watches this program, which makes it five to twenty times as slow.
#pragma once

namespace burrhole::test {

/// Statistics need many samples, memory faults do not: a loop over samples may be shorter where this is true.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace burrhole::test
