/// app/effect/registry.h: the list of all effects.   Thread  any.
#pragma once

#include "app/stage/effect.h"

namespace burrhole {

/// @returns the effects of registry.inc, in its order.
[[nodiscard]] const EffectRegistry& shipped_effects();

// One function per line of registry.inc: NAME_effect(), defined in app/effect/NAME.cpp.
#define BH_EFFECT(name) [[nodiscard]] EffectEntry name##_effect();
#include "app/effect/registry.inc"
#undef BH_EFFECT

}  // namespace burrhole
