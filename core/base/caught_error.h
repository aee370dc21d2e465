/// core/base/caught_error.h: an exception of a library or of the system as an error: memory and threads are the machine's, files the input's.
///   Thread  any: no state.
#pragma once

#include "core/base/result.h"

namespace burrhole {

/// Call it inside a catch block only. @returns unavailable for memory and for what the system refuses (a thread), bad_input for a path,
/// internal for everything else.
[[nodiscard]] Error caught_error();

}  // namespace burrhole
