/// core/base/assert.h: checks of internal invariants, enabled in debug and sanitizer builds. A failed check prints file and line and
/// aborts.
#pragma once

#include <cstdio>
#include <cstdlib>

#if defined(NDEBUG)
#define BH_ASSERT(condition) static_cast<void>(sizeof(!(condition)))  // not evaluated: what it names counts as used
#else
#define BH_ASSERT(condition)                                                        \
  do {                                                                              \
    if (!(condition)) {                                                             \
      std::fprintf(stderr, "%s:%d: our bug: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                 \
    }                                                                               \
  } while (false)
#endif

/// Marks a function of the servo path: it does not allocate, lock, throw, log, access files or OpenGL, and every loop has a documented
/// bound.
#define BH_REALTIME
