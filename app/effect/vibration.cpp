// [vibration]: the vibration of a turning bit in the hand.

#include <fmt/format.h>

#include "app/effect/registry.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/stage.h"
#include "core/config/rules.h"
#include "haptics/servo/tip_vibration.h"

namespace burrhole {
namespace {

class VibrationEffect final : public Effect {
 public:
  explicit VibrationEffect(const TipVibration& law) : law_(law) {}

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::servo, "vibration", "vibration", [](void* self, const Tick& tick) { static_cast<VibrationEffect*>(self)->run(tick); }, this);
    hand_ = step.now(slots::kHand);
    spin_ = step.latest(graph.is_written(slots::kDrillSpin.name) ? slots::kDrillSpin : slots::kSpin);
    force_ = step.add(slots::kAddedForce);
    return {};
  }

 private:
  void run(const Tick& tick) noexcept {
    const double spin = hand_->spin > 0.0 ? *spin_ : 0.0;
    *force_ += law_(spin, hand_->world_from_hand.rotate(Vec3(0.0, 0.0, 1.0)), tick.dt);
  }

  TipVibration law_;
  const HandState* hand_ = nullptr;
  const double* spin_ = nullptr;  // [rev/s]
  Vec3* force_ = nullptr;
};

class VibrationPlan final : public ConfigPlan<VibrationPlan, TipVibrationConfig> {
 public:
  explicit VibrationPlan(TableReader& table) {
    config_.amplitude =
        table.number("amplitude_N", at_least_zero(config_.amplitude, 1.0, 10.0), "size of the force that turns with the bit");
    config_.cycles =
        table.number("cycles_per_rev", above_zero(config_.cycles, 1.0, 100.0),
                     "turns of the force in a turn of the bit, such as its number of teeth; above 0.4 servo_hz the frequency is "
                     "reduced to that");
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "vibration",
            .clock = Clock::servo,
            .step = "force that turns with the bit",
            .needs = "hand, spin",
            .gives = "added force",
            .detail = fmt::format("{:g} N, {:g} cycles per revolution", config_.amplitude, config_.cycles),
            .rate_hz = static_cast<double>(context.config.servo_hz),
            .bytes = sizeof(VibrationEffect)};
  }
  std::string setting() const override { return fmt::format("vibration {:g} N", config_.amplitude); }

  Result<std::unique_ptr<Effect>> make(Stage&) const override {
    auto law = TipVibration::create(config_);
    if (!law) return law.error();
    return std::unique_ptr<Effect>(std::make_unique<VibrationEffect>(*law));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<VibrationPlan>(table); }

}  // namespace

EffectEntry vibration_effect() { return {"vibration", "vibration of the turning bit in the hand; without it there is none", read}; }

}  // namespace burrhole
