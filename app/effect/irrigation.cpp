// [irrigation]: saline flows onto the bone at the tip while the drill turns. It cools the bone that [heat] warms.

#include <fmt/format.h>

#include "app/effect/registry.h"
#include "app/stage/coolant.h"
#include "app/stage/instruments.h"
#include "app/stage/stage.h"
#include "core/config/rules.h"

namespace burrhole {
namespace {

constexpr double kMillilitrePerMinute = 1e-6 / 60.0;  // [m^3/s]

struct IrrigationConfig {
  double flow = 30.0 * kMillilitrePerMinute;  ///< [m^3/s] (an assumption)
  double celsius = 20.0;                      ///< [C] saline at the temperature of the room
  double film = 2000.0;                       ///< [W/(m^2 K)] a film of flowing water (an assumption)
  double reach = 0.01;                        ///< [m] (an assumption)
  bool always = false;                        ///< it flows also while the drill stands
  bool by_switch = false;                     ///< it flows only while its switch is on
};

class IrrigationEffect final : public Effect {
 public:
  explicit IrrigationEffect(const IrrigationConfig& config) : config_(config) {}

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "irrigation", "irrigation",
        [](void* self, const Tick& tick) { static_cast<IrrigationEffect*>(self)->run(tick); }, this);
    asked_ = step.now(slots::kSpinAsked);
    if (config_.by_switch) hand_ = step.latest(slots::kHand);
    coolant_ = step.own(slots::kCoolant);
    return {};
  }
  void report(Figures& out) const override {
    out.add("delivered_ml", delivered_ * 1e6);
    out.add("on_s", on_);
  }

 private:
  void run(const Tick& tick) noexcept {
    const bool flows = hand_ != nullptr ? (hand_->switches & kIrrigationSwitch) != 0 : config_.always || *asked_ > 0.0;
    *coolant_ = {flows ? config_.flow : 0.0, config_.celsius, config_.film, config_.reach};
    if (!flows) return;
    on_ += tick.dt;
    delivered_ += config_.flow * tick.dt;
  }

  IrrigationConfig config_;
  double delivered_ = 0.0, on_ = 0.0;  // [m^3], [s]
  const double* asked_ = nullptr;      // [rev/s]
  const HandState* hand_ = nullptr;    // null: it has no switch
  Coolant* coolant_ = nullptr;
};

class IrrigationPlan final : public SwitchedPlan<IrrigationPlan, IrrigationConfig> {
 public:
  explicit IrrigationPlan(TableReader& table) {
    IrrigationConfig& c = config_;
    c.flow = table.number("flow_ml_per_min", above_zero(c.flow / kMillilitrePerMinute, kMillilitrePerMinute, 1e4), "flow of saline");
    c.celsius = table.number("temperature_C", within(c.celsius, 0.0, 60.0), "temperature of the saline where it reaches bone");
    c.film = table.number("film_W_per_m2_K", above_zero(c.film, 1.0, 1e6), "heat transfer coefficient from wet bone to saline");
    c.reach = table.number("reach_mm", above_zero(c.reach * 1e3, 1e-3, 200.0),
                           "distance from the tip up to which the free surface of bone is wet");
    c.always = table.boolean("always", c.always, "true: it also flows while the drill does not turn");
    c.by_switch =
        table.boolean("by_switch", c.by_switch, "true: it flows only while a person switches it on: I in the window, or an input");
    if (c.by_switch && c.always) table.fault("by_switch", "and always exclude each other");
    if (c.by_switch) instruments_.switches = kIrrigationSwitch;
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "irrigation",
            .clock = Clock::simulation,
            .step = "flow of saline",
            .needs = "spin",
            .gives = "coolant",
            .detail = fmt::format("{:g} ml/min at {:g} C", config_.flow / kMillilitrePerMinute, config_.celsius),
            .rate_hz = static_cast<double>(context.needs.simulation_hz),
            .bytes = sizeof(IrrigationEffect)};
  }
  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    if (!context.needs.warms) out.push_back("[irrigation] without [heat] it cools nothing; with [dust] it rinses chips");
  }
  std::string setting() const override { return fmt::format("irrigation {:g} ml/min", config_.flow / kMillilitrePerMinute); }

  Result<std::unique_ptr<Effect>> make(Stage&) const override {
    return std::unique_ptr<Effect>(std::make_unique<IrrigationEffect>(config_));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<IrrigationPlan>(table); }

}  // namespace

EffectEntry irrigation_effect() { return {"irrigation", "saline that cools the bone at the tip; without it there is none", read}; }

}  // namespace burrhole
