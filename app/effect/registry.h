/// app/effect/registry.h: the effects that this program knows.
#pragma once

#include "app/stage/effect.h"

namespace burrhole {

/// Of registry.inc, in its order.
[[nodiscard]] const EffectRegistry& shipped_effects();

// One function per line of registry.inc: NAME_effect(), defined in app/effect/NAME.cpp.
#define BH_EFFECT(name) [[nodiscard]] EffectEntry name##_effect();
#define BH_LATER(name)
#include "app/effect/registry.inc"
#undef BH_EFFECT
#undef BH_LATER

}  // namespace burrhole
