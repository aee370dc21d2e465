/// app/run/start_thread.h: a thread, or the reason why the system refuses it.
///   Errors  unavailable: as caught_error(); nothing of the thread has run then.   Thread  any.
#pragma once

#include <thread>
#include <utility>

#include "core/base/caught_error.h"

namespace burrhole {

/// @param thread receives it; not joinable after an error.
template <class F>
[[nodiscard]] Status start_thread(std::thread& thread, F f) {
  try {
    thread = std::thread(std::move(f));
  } catch (...) {
    return caught_error();
  }
  return {};
}

}  // namespace burrhole
