// [spindle]: the spindle slows under the cutting torque.

#include "core/drill/spindle.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/effect/registry.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "core/base/units.h"
#include "core/config/rules.h"

namespace burrhole {
namespace {

class SpindleEffect final : public Effect {
 public:
  SpindleEffect(const Spindle& spindle, double free_speed) : spindle_(spindle), free_(free_speed), slowest_(spindle.speed()) {}

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "spindle", "spindle", [](void* self, const Tick& tick) { static_cast<SpindleEffect*>(self)->run(tick); }, this);
    asked_ = step.now(slots::kSpinAsked);
    removal_ = step.now_if_written(slots::kRemoval);
    spin_ = step.own(slots::kSpin);
    *spin_ = spindle_.speed();
    step.column("spin", "rev/s", spin_, true);
    return {};
  }
  void report(Figures& out) const override { out.add("slowest_rpm", slowest_ / kRevPerMinute); }

 private:
  void run(const Tick& tick) {
    spindle_.set_command(*asked_ / free_);
    if (removal_->cutting) {
      *spin_ = spindle_.step(removal_->torque, tick.dt);
      slowest_ = std::min(slowest_, *spin_);
    } else {
      *spin_ = spindle_.step(0.0, tick.dt);
    }
  }

  Spindle spindle_;
  double free_;     // [rev/s] at full command
  double slowest_;  // [rev/s] while cutting
  const double* asked_ = nullptr;
  const BoneRemoval* removal_ = nullptr;
  double* spin_ = nullptr;
};

class SpindlePlan final : public ConfigPlan<SpindlePlan, SpindleConfig>, public RequiringPlan {
 public:
  SpindlePlan(TableReader& table, const StageConfig&) {
    config_.stall_torque =
        table.number("stall_torque_Nm", above_zero(config_.stall_torque, 1.0, 1e3), "cutting torque at which the spindle stalls");
    config_.inertia = table.number("inertia_kg_m2", at_least_zero(config_.inertia, 1.0, 1.0),
                                   "moment of inertia of all rotating parts, referred to the bit");
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "spindle",
            .clock = Clock::simulation,
            .step = "speed under the cutting torque",
            .needs = "removal",
            .gives = "spin",
            .detail = fmt::format("{:.0f} rpm free, stalls at {:.3g} N m", context.config.tool.spin / kRevPerMinute, config_.stall_torque),
            .rate_hz = static_cast<double>(context.needs.simulation_hz),
            .bytes = sizeof(SpindleEffect)};
  }
  std::vector<Requirement> requirements(const Needs& needs) const override {
    constexpr const char* kWithout = "there is no cutting torque, so it does not slow";
    return {{.table = "contact", .met = needs.feels, .without = kWithout}, {.table = "erosion", .met = needs.removes, .without = kWithout}};
  }
  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    if (context.config.tool.spin <= 0.0) out.push_back("[spindle] the tool's spin is 0: there is no cutting torque, so it does not slow");
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    SpindleConfig config = config_;
    config.free_speed = std::max(stage.config.tool.spin, kSlowest);
    auto spindle = Spindle::create(config);
    if (!spindle) return spindle.error();
    if (stage.config.tool.spin <= 0.0) spindle->set_speed(0.0);
    return std::unique_ptr<Effect>(std::make_unique<SpindleEffect>(*spindle, config.free_speed));
  }

 private:
  static constexpr double kSlowest = 1e-3;  // [rev/s] a spindle needs a free speed above 0; at spin 0 it is never driven
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues&) {
  return std::make_unique<SpindlePlan>(table, stage);
}

}  // namespace

EffectEntry spindle_effect() {
  return {"spindle",
          "the spindle slows under load; without it the spin rate equals the command",
          read,
          {},
          {.figures = {{"slowest_rpm"}, {"breakthrough_s"}}}};
}

}  // namespace burrhole
