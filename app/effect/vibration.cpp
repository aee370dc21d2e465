// [vibration]: the vibration of a turning bit in the hand, and the force against which it moves through bone.

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "app/effect/passive_keys.h"
#include "app/effect/registry.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "core/config/rules.h"
#include "core/drill/balance_point.h"
#include "haptics/servo/chip_vibration.h"
#include "haptics/servo/drilling_force.h"
#include "haptics/servo/tip_vibration.h"

namespace burrhole {
namespace {

struct VibrationScene {
  bool by_chips = false;  ///< otherwise of fixed size
  TipVibrationConfig steady{};
  ChipVibrationConfig chips{};
  std::optional<DrillingForceConfig> drilling{};
};

/// In the tool frame; on the simulation clock, owned by [vibration].
const SlotKey<Vec3> kBalance{"balance_point"};
/// [m] world; on the contact clock, owned by [vibration].
const SlotKey<Vec3> kDrillAt{"drill_at"};

class VibrationEffect final : public Effect {
 public:
  VibrationEffect(const TipVibration& steady, std::optional<ChipVibration> chips, std::optional<DrillingForce> drilling, Stage& stage)
      : steady_(steady), chips_(chips), drilling_(drilling), stage_(&stage) {
    fit_tool();
  }

  Status bind(StepGraph& graph) override {
    auto step =
        graph.step(Clock::servo, "vibration", "vibration",
                   chips_ ? StepGraph::Run([](void* self, const Tick& tick) { static_cast<VibrationEffect*>(self)->follow_chips(tick); })
                          : StepGraph::Run([](void* self, const Tick& tick) { static_cast<VibrationEffect*>(self)->run(tick); }),
                   this);
    hand_ = step.now(slots::kHand);
    spin_ = step.latest(graph.is_written(slots::kDrillSpin.name) ? slots::kDrillSpin : slots::kSpin);
    force_ = step.add(slots::kAddedForce);
    if (chips_) {
      load_ = step.latest_if_written(slots::kChipLoad);
      step.column("vibration", "N", &size_);
    }
    return drilling_ ? bind_drilling(graph) : Status();
  }
  Status change_tool(Stage&) override {
    fit_tool();
    return {};
  }
  void place(const Pose&) noexcept override {
    if (chips_) chips_->clear();
    if (drilling_) drilling_->restart();
  }
  void report(Figures& out) const override {
    if (chips_) {
      out.add("largest_N", largest_);
      out.add("mean_N", vibrates_ > 0.0 ? sum_ / vibrates_ : 0.0);
      out.add("vibrates_s", vibrates_);
    }
    if (!drilling_) return;
    out.add("drilling_peak_N", drilling_->figures().peak);
    out.add("drilling_given_mJ", drilling_->figures().most_given * 1e3);
    out.add("drilling_limited_ticks", drilling_->figures().limited);
  }

 private:
  Status bind_drilling(StepGraph& graph) {
    auto ahead = graph.step(
        Clock::simulation, "vibration", "balance point", [](void* self, const Tick&) { static_cast<VibrationEffect*>(self)->look_ahead(); },
        this);
    cut_ = ahead.now(slots::kCut);
    balance_ = ahead.own(kBalance);
    auto push = graph.step(
        Clock::servo, "vibration", "drilling force", [](void* self, const Tick& tick) { static_cast<VibrationEffect*>(self)->push(tick); },
        this);
    pushed_ = push.now(slots::kHand);
    drive_ = push.latest(slots::kSpin);
    held_back_ = stage_->needs.feels;
    if (held_back_) {
      auto follow = graph.step(
          Clock::contact, "vibration", "place of the drill",
          [](void* self, const Tick&) noexcept { static_cast<VibrationEffect*>(self)->follow_drill(); }, this);
      contact_ = follow.now(slots::kContact);
      place_ = follow.own(kDrillAt);
      drill_ = push.latest(kDrillAt);
    }
    towards_ = push.latest(kBalance);
    drag_ = push.add(slots::kAddedForce);
    drilling_->restart();
    return {};
  }
  void fit_tool() {
    teeth_ = stage_->tool->teeth;
    if (drilling_) bone_ahead_.emplace(*stage_->tool);
  }

  void run(const Tick& tick) noexcept { *force_ += steady_(spin(), axis(), tick.dt); }
  void follow_chips(const Tick& tick) noexcept {
    *force_ += (*chips_)({load_->force, load_->thickness, teeth_}, spin(), axis(), tick.dt);
    size_ = chips_->size();
    if (!load_->cuts) return;
    largest_ = std::max(largest_, size_);
    sum_ += size_ * tick.dt;
    vibrates_ += tick.dt;
  }
  void look_ahead() noexcept { *balance_ = cut_->far ? Vec3(0.0) : bone_ahead_->measure(stage_->voxmap->window(), cut_->path.to).towards; }
  void follow_drill() noexcept { *place_ = contact_->world_from_tool.translation; }
  void push(const Tick& tick) noexcept {
    const Pose& hand = pushed_->world_from_hand;
    const Vec3& drill = held_back_ ? *drill_ : hand.translation;
    const bool turns = pushed_->spin > 0.0 && *drive_ > 0.0;
    *drag_ += (*drilling_)(hand.translation, drill, turns ? hand.rotate(*towards_) : Vec3(0.0), tick.dt);
  }
  [[nodiscard]] double spin() const noexcept { return hand_->spin > 0.0 ? *spin_ : 0.0; }
  [[nodiscard]] Vec3 axis() const noexcept { return hand_->world_from_hand.rotate(Vec3(0.0, 0.0, 1.0)); }

  TipVibration steady_;
  std::optional<ChipVibration> chips_;
  std::optional<DrillingForce> drilling_;
  std::optional<BalancePoint> bone_ahead_;  // with a drilling force
  Stage* stage_;
  int teeth_ = 0;
  double size_ = 0.0, largest_ = 0.0, sum_ = 0.0, vibrates_ = 0.0;  // [N], [N], [N s], [s]
  const HandState *hand_ = nullptr, *pushed_ = nullptr;             // one for each step that reads it
  const double *spin_ = nullptr, *drive_ = nullptr;                 // [rev/s] of the outer drill, of the drive
  bool held_back_ = false;                                          // otherwise the tool is where the hand is
  const ContactState* contact_ = nullptr;
  Vec3* place_ = nullptr;
  const Vec3* drill_ = nullptr;  // [m]
  const ChipLoad* load_ = nullptr;
  const Cut* cut_ = nullptr;
  Vec3 *force_ = nullptr, *drag_ = nullptr;
  Vec3* balance_ = nullptr;
  const Vec3* towards_ = nullptr;
};

DrillingForceConfig read_drilling(TableReader table) {
  DrillingForceConfig c;
  c.resistance =
      table.number("resistance_N_s_per_m", above_zero(c.resistance, 1.0, 1e5), "force over the speed of the drill (an assumption)");
  c.time = table.number("time_constant_ms", above_zero(c.time * 1e3, 1e-3, 1e3), "of the mean of the speed (an assumption)");
  read_passive_limit(table, "the force", c.limit);
  table.finish();
  return c;
}

class VibrationPlan final : public ConfigPlan<VibrationPlan, VibrationScene>, public RequiringPlan {
 public:
  explicit VibrationPlan(TableReader& table) {
    VibrationScene& c = config_;
    c.by_chips =
        table.choice("source", "steady", {"steady", "chips"},
                     "steady: a force of fixed size; chips: a force by what the teeth cut, which changes from layer to layer") == "chips";
    if (c.by_chips) {
      c.chips.fracture = table.number("fracture_um", above_zero(c.chips.fracture * 1e6, 1e-6, 1e4),
                                      "thickness of a chip at which half of the force on a tooth vibrates (an assumption)");
      c.chips.uneven = table.number("uneven", within(c.chips.uneven, 0.0, 1.0),
                                    "size of the force that turns with the bit, over that which turns with each tooth (an assumption)");
      c.chips.rise =
          table.number("rise_ms", above_zero(c.chips.rise * 1e3, 1e-3, 1e3), "time constant with which its size follows the chips");
    } else {
      c.steady.amplitude =
          table.number("amplitude_N", at_least_zero(c.steady.amplitude, 1.0, 10.0), "size of the force that turns with the bit");
      c.steady.cycles =
          table.number("cycles_per_rev", above_zero(c.steady.cycles, 1.0, 100.0),
                       "turns of the force in a turn of the bit, such as its number of teeth; above 0.4 servo_hz the frequency is "
                       "reduced to that");
    }
    if (const auto drilling = table.table("drilling_force", "resistance of bone to a turning drill that moves; absent: none"))
      c.drilling = read_drilling(*drilling);
  }

  void add_needs(const StageConfig&, Needs& needs) const override { needs.chip_load = needs.chip_load || config_.by_chips; }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "vibration",
            .clock = Clock::servo,
            .step = config_.drilling ? "force that turns with the bit, drilling force" : "force that turns with the bit",
            .needs = config_.by_chips ? "hand, spin, chip load" : "hand, spin",
            .gives = "added force",
            .detail = config_.by_chips
                          ? fmt::format("by chips, half at {:g} um, uneven {:g}", config_.chips.fracture * 1e6, config_.chips.uneven)
                          : fmt::format("{:g} N, {:g} cycles per revolution", config_.steady.amplitude, config_.steady.cycles),
            .rate_hz = static_cast<double>(context.config.servo_hz),
            .bytes = sizeof(VibrationEffect) + (config_.drilling ? BalancePoint::kMostPlaces * 2 * sizeof(Vec3) : 0)};
  }
  std::vector<Requirement> requirements(const Needs& needs) const override {
    std::vector<Requirement> out;
    if (config_.by_chips) out.push_back({"erosion", needs.removes, "no chips are cut, so nothing vibrates", "source = \"chips\""});
    if (config_.drilling)
      out.push_back({"erosion", needs.removes, "the bone before the drill is not known, so there is no force", "drilling_force"});
    return out;
  }
  std::string setting() const override {
    return (config_.by_chips ? std::string("vibration by chips") : fmt::format("vibration {:g} N", config_.steady.amplitude)) +
           (config_.drilling ? ", drilling force" : "");
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    auto steady = TipVibration::create(config_.steady);
    if (!steady) return steady.error();
    std::optional<ChipVibration> chips;
    if (config_.by_chips) {
      auto made = ChipVibration::create(config_.chips);
      if (!made) return made.error();
      chips = *made;
    }
    std::optional<DrillingForce> drilling;
    if (config_.drilling) {
      auto made = DrillingForce::create(*config_.drilling);
      if (!made) return made.error();
      drilling = *made;
    }
    return std::unique_ptr<Effect>(std::make_unique<VibrationEffect>(*steady, chips, drilling, stage));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<VibrationPlan>(table); }

}  // namespace

EffectEntry vibration_effect() {
  return {"vibration",
          "vibration of the turning bit in the hand; without it there is none",
          read,
          {"source = \"chips\"\n[vibration.drilling_force]"},
          {.figures = {{"mean_N"}, {"largest_N"}, {"drilling_peak_N"}}, .knobs = {}, .table = "source = \"chips\"\ndrilling_force = {}"}};
}

}  // namespace burrhole
