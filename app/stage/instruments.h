/// app/stage/instruments.h: the instruments that a person switches in a scene.
#pragma once

#include <cstdint>

#include "app/stage/effect.h"
#include "haptics/hand/hand_switches.h"

namespace burrhole {

/// The switches that an effect reads; a plan with any returns this struct from config().
struct Instruments {
  std::uint32_t switches = 0;  ///< InstrumentSwitch
};

/// @returns the switches that the effects of a scene read.
[[nodiscard]] inline std::uint32_t instruments_of(const EffectPlans& plans) noexcept {
  std::uint32_t out = 0;
  for (const EffectPlans::Item& item : plans.items())
    if (const void* config = item.plan->config(typeid(Instruments))) out |= static_cast<const Instruments*>(config)->switches;
  return out;
}

/// A plan that consists of one config struct and may read switches.
template <class Self, class Config>
class SwitchedPlan : public ConfigPlan<Self, Config> {
 public:
  [[nodiscard]] void* config(std::type_index type) noexcept override {
    return type == typeid(Instruments) ? &instruments_ : ConfigPlan<Self, Config>::config(type);
  }

 protected:
  Instruments instruments_;
};

}  // namespace burrhole
