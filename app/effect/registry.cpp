#include "app/effect/registry.h"

namespace burrhole {

const EffectRegistry& shipped_effects() {
#define BH_EFFECT(name) name##_effect(),
#define BH_LATER(name) EffectEntry{#name, "", nullptr},
  static const EffectRegistry effects{
#include "app/effect/registry.inc"
  };
#undef BH_EFFECT
#undef BH_LATER
  return effects;
}

}  // namespace burrhole
