/// core/base/parallel.h: calls a function for the numbers 0 to count - 1 on all cores.
///   Units none.   Errors  none: where threads cannot be had, fewer do the work. An exception of f is thrown to the caller, once.
///   Thread any; it returns when all calls have returned. The order of the calls is not fixed, so results must not depend on it.
#pragma once

#include <cstddef>
#include <functional>

namespace burrhole {

/// @param f after its first exception, numbers may be left out. @param most_threads at least 1; the number of cores is a further limit.
void for_each_number(int count, std::size_t most_threads, const std::function<void(int)>& f);
/// On all cores.
void for_each_number(int count, const std::function<void(int)>& f);

}  // namespace burrhole
