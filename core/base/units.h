/// core/base/units.h: factors from the units of files to SI. No other file contains such factors.
#pragma once

#include <numbers>

namespace burrhole {

inline constexpr double kMillimetre = 1e-3;                  ///< [m]
inline constexpr double kRevPerMinute = 1.0 / 60.0;          ///< [rev/s]
inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< [rad]

}  // namespace burrhole
