/// core/base/caught_error.h: an exception of a library or of the system as an error: memory and threads are the machine's, files the input's.
///   Thread  any: no state.
#pragma once

#include <exception>

#include "core/base/result.h"

namespace burrhole {

/// Call it inside a catch block only. @returns unavailable for memory and for what the system refuses (a thread), bad_input for a path,
/// internal for everything else.
[[nodiscard]] Error caught_error();

/// The same of an exception that another thread has caught: that one needs no memory to keep it. @param thrown not null.
[[nodiscard]] Error error_of(const std::exception_ptr& thrown);

}  // namespace burrhole
