/// core/base/assert.h: checks for our own bugs; on in debug and sanitizer builds.
#pragma once

#include <cstdio>
#include <cstdlib>

#if defined(NDEBUG)
#define BH_ASSERT(condition) static_cast<void>(0)
#else
#define BH_ASSERT(condition)                                                        \
  do {                                                                              \
    if (!(condition)) {                                                             \
      std::fprintf(stderr, "%s:%d: our bug: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                 \
    }                                                                               \
  } while (false)
#endif

/// Marks functions on the servo path: no allocation, lock, exception, log, file, GL, or loop without a written bound.
#define BH_REALTIME
