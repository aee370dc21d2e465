/// app/engine/effect_names.h: tables that the scene language reserves for effects this version does not simulate.
#pragma once

#include <array>
#include <string_view>

namespace burrhole {

inline constexpr std::array<std::string_view, 9> kLaterEffects{"friction", "vibration", "clutch", "heat", "irrigation",
                                                               "dust",     "bleeding",  "dura",   "sound"};

}  // namespace burrhole
