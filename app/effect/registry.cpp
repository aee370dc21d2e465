#include "app/effect/registry.h"

namespace burrhole {

const EffectRegistry& shipped_effects() {
#define BH_EFFECT(name) name##_effect(),
  static const EffectRegistry effects{
#include "app/effect/registry.inc"
  };
#undef BH_EFFECT
  return effects;
}

}  // namespace burrhole
