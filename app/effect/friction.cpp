// [friction]: Coulomb friction with stiction between tool and bone, in the contact step and in the forces that the servo computes between
// two contact results.

#include "core/contact/friction.h"

#include <fmt/format.h>

#include <numbers>

#include "app/effect/registry.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "core/config/rules.h"

namespace burrhole {
namespace {

class FrictionEffect final : public Effect {
 public:
  FrictionEffect(const Friction& law, Stage& stage) : at_contact_(law), at_servo_(law), stage_(&stage) {}

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::contact, "friction", "friction", [](void* self, const Tick&) { static_cast<FrictionEffect*>(self)->run(); }, this);
    spin_ = step.latest(graph.is_written(slots::kDrillSpin.name) ? slots::kDrillSpin : slots::kSpin);
    tangential_ = step.own(slots::kTangential);
    stage_->servo->use_tangential_law(&at_servo_);
    return {};
  }
  void place(const Pose&) noexcept override {
    at_contact_.clear();
    at_servo_.clear();
  }
  void report(Figures& out) const override { out.add("sliding_ticks", sliding_); }

 private:
  void run() noexcept {
    sliding_ += at_contact_.sliding() ? 1 : 0;  // in the step before
    // Bits cut clockwise seen from above: about -z of the tool.
    *tangential_ = {&at_contact_, -2.0 * std::numbers::pi * *spin_};
  }

  Friction at_contact_, at_servo_;  // one law each: they step at their own rates
  Stage* stage_;
  const double* spin_ = nullptr;  // [rev/s]
  Tangential* tangential_ = nullptr;
  std::uint64_t sliding_ = 0;
};

class FrictionPlan final : public ConfigPlan<FrictionPlan, FrictionConfig>, public RequiringPlan {
 public:
  FrictionPlan(TableReader& table, const StageConfig&) {
    config_.static_coefficient = table.number("static_coefficient", within(config_.static_coefficient, 0.0, 2.0),
                                              "largest ratio of tangential to normal force of a sticking point");
    config_.kinetic_coefficient = table.number("kinetic_coefficient", within(config_.kinetic_coefficient, 0.0, 2.0),
                                               "ratio of tangential to normal force of a sliding point; at most the static coefficient");
    if (config_.kinetic_coefficient > config_.static_coefficient) table.fault("kinetic_coefficient", "must be at most static_coefficient");
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "friction",
            .clock = Clock::contact,
            .step = "tangential loads of the points that press on bone",
            .needs = "spin",
            .gives = "tangential law",
            .detail = fmt::format("Coulomb, {:g} static, {:g} kinetic", config_.static_coefficient, config_.kinetic_coefficient),
            .rate_hz = static_cast<double>(context.needs.contact_hz > 0 ? context.needs.contact_hz : context.config.servo_hz),
            .bytes = sizeof(FrictionEffect)};
  }
  std::vector<Requirement> requirements(const Needs& needs) const override {
    return {{.table = "contact", .met = needs.feels, .without = "there is no normal force, so there is no friction"}};
  }
  std::string setting() const override {
    return fmt::format("friction {:g}/{:g}", config_.static_coefficient, config_.kinetic_coefficient);
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    auto law = Friction::create(config_);
    if (!law) return law.error();
    return std::unique_ptr<Effect>(std::make_unique<FrictionEffect>(*law, stage));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues&) {
  return std::make_unique<FrictionPlan>(table, stage);
}

}  // namespace

EffectEntry friction_effect() {
  return {"friction",
          "Coulomb friction with stiction between tool and bone; without it contact is frictionless",
          read,
          {},
          {.figures = {{"breakthrough_s"}, {"peak_force_N"}, {"hole_diameter_mm"}}}};
}

}  // namespace burrhole
