/// core/base/cpu_model.h: the name of this machine's processor.   Errors  none.   Thread  any.
#pragma once

#include <string>

namespace burrhole {

/// @returns the model name as the system states it, or "unknown".
[[nodiscard]] std::string cpu_model();

}  // namespace burrhole
