// [clutch]: the clutch of a cranial perforator. It stops the drill when bone no longer supports the tip of the inner drill.

#include "core/drill/clutch.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "app/effect/registry.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "core/drill/tip_support.h"
#include "core/tool/cutting_field.h"
#include "core/tool/tool_surface.h"

namespace burrhole {
namespace {

struct ClutchScene {
  ClutchConfig clutch{};
  double soft_hardness = 0.0;            ///< [-] failure: bone of less hardness gives the tip no reaction
  std::string inner = "inner drill";     ///< region of the tool
  std::string outer = "outer drill";     ///< region of the tool
  std::string inner_place, outer_place;  ///< of these keys, for errors
};

/// @returns the regions of a tool; nothing if it does not have both, once each.
std::optional<DrillRegions> regions_of(const Tool& tool, const ClutchScene& scene) {
  if (tool.surface == nullptr) return std::nullopt;
  const auto inner = tool.surface->find_region(scene.inner), outer = tool.surface->find_region(scene.outer);
  if (!inner || !outer) return std::nullopt;
  return DrillRegions{*inner, *outer};
}

class ClutchEffect final : public Effect {
 public:
  ClutchEffect(const ClutchScene& scene, const Clutch& clutch, Stage& stage) : scene_(scene), clutch_(clutch), stage_(&stage) {
    fit_tool();
  }

  Status bind(StepGraph& graph) override {
    auto contact = graph.step(
        Clock::contact, "clutch", "thrust on the drill",
        [](void* self, const Tick&) noexcept { static_cast<ClutchEffect*>(self)->press(); }, this);
    touched_ = contact.now_if_written(slots::kContact);
    thrust_out_ = contact.own(slots::kDrillThrust);
    *thrust_out_ = thrust_sum_;
    auto step = graph.step(
        Clock::simulation, "clutch", "clutch", [](void* self, const Tick& tick) { static_cast<ClutchEffect*>(self)->run(tick); }, this);
    cut_ = step.now(slots::kCut);
    asked_ = step.now(slots::kSpinAsked);
    spin_ = step.last(slots::kSpin);
    thrust_ = step.latest(slots::kDrillThrust);
    state_ = step.own(slots::kClutch);
    drill_spin_ = step.own(slots::kDrillSpin);
    step.column(kEngagedColumn, "", &engaged_, true)
        .column("tip_reaction", "N", &reaction_, true)
        .column("tip_pushed_back", "m", &pushed_back_);
    publish({});
    auto tally = graph.step(
        Clock::simulation, "clutch", "torque on the clutch", [](void* self, const Tick&) { static_cast<ClutchEffect*>(self)->count(); },
        this);
    seen_ = tally.now(slots::kClutch);
    removal_ = tally.now_if_written(slots::kRemoval);
    auto servo = graph.step(
        Clock::servo, "clutch", "stop of the drill", [](void* self, const Tick&) noexcept { static_cast<ClutchEffect*>(self)->feel(); },
        this);
    felt_ = servo.latest(slots::kClutch);
    return {};
  }
  /// Bone was brought back or taken away outside of a step, or the tool moved: nothing presses the tip.
  void place(const Pose&) noexcept override {
    clutch_.reset();
    reaction_ = load_.supported = 0.0;
    publish({});
  }
  Status change_tool(Stage&) override {
    clutch_.reset();
    fit_tool();
    return {};
  }
  void report(Figures& out) const override {
    out.add("engaged", has_regions_ ? clutch_.engaged() : true);
    out.add("engagements", clutch_.engagements());
    out.add("releases", clutch_.releases());
    if (clutch_.engaged_at()) out.add("engaged_s", *clutch_.engaged_at());
    if (clutch_.released_at()) {
      out.add("released_s", *clutch_.released_at());
      out.add("release_took_ms", clutch_.release_took() * 1e3);
      out.add("thrust_at_release_N", thrust_at_release_);
      out.add("torque_after_release_Nm", torque_after_);
      out.add("inner_turns_after_release", inner_turns_);
      out.add("outer_turns_after_release", outer_turns_);
    }
    out.add("tip_supported", load_.supported);
    out.add("tip_reaction_N", reaction_);
    out.add("tip_forward_mm", (scene_.clutch.travel - clutch_.pushed_back()) * 1e3);
  }
  void warn(std::vector<std::string>& out) const override {
    if (!has_regions_)
      out.push_back(
          fmt::format("[clutch] the tool has no regions \"{}\" and \"{}\": it turned with its drive", scene_.inner, scene_.outer));
    else if (clutch_.engagements() == 0 && thrust_most_ > 0.0)
      out.push_back(fmt::format("[clutch] never engaged: the tip had at most {:.3g} N of the {:.3g} N that it takes", reaction_most_,
                                clutch_.engage_force()));
  }

 private:
  void fit_tool() {
    const auto found = regions_of(*stage_->tool, scene_);
    has_regions_ = found.has_value();
    if (!found) return;
    regions_ = *found;
    support_.emplace(*stage_->tool, *found, stage_->voxel_edge());
  }

  void press() noexcept {
    const double along = glm::dot(touched_->on_hand.force, touched_->world_from_tool.rotate(Vec3(0.0, 0.0, 1.0)));
    thrust_sum_.sum += std::max(0.0, along);
    ++thrust_sum_.number;
    *thrust_out_ = thrust_sum_;
  }

  void run(const Tick& tick) noexcept {
    if (!has_regions_) {
      *drill_spin_ = *spin_;
      publish({1.0, 1.0, 1.0});
      return;
    }
    if (thrust_->number > before_.number) {  // after a tool change the first message is that of the start
      force_ = (thrust_->sum - before_.sum) / static_cast<double>(thrust_->number - before_.number);
      before_ = *thrust_;
    }
    load_ = {};
    if (!cut_->far && force_ > 0.0) {
      const double k = stage_->needs.cutting_stiffness, engaged = clutch_.turns() && *asked_ > 0.0 && k > 0.0 ? force_ / k : 0.0;
      load_ = support_->measure(stage_->voxmap->window(), cut_->path.to, engaged, static_cast<float>(scene_.soft_hardness));
    }
    reaction_ = force_ * load_.share;
    thrust_most_ = std::max(thrust_most_, force_);
    reaction_most_ = std::max(reaction_most_, reaction_);
    const std::uint64_t releases = clutch_.releases();
    const ClutchDrive drive = clutch_.step(reaction_, *spin_, tick.dt);
    if (clutch_.releases() != releases) {
      thrust_at_release_ = force_;
      torque_after_ = inner_turns_ = outer_turns_ = 0.0;
    }
    inner_turns_ += (drive.inner - drive.coupled) * *spin_ * tick.dt;
    outer_turns_ += (drive.outer - drive.coupled) * *spin_ * tick.dt;
    *drill_spin_ = *spin_ * drive.outer;
    publish(drive);
  }

  void publish(const ClutchDrive& drive) noexcept {
    engaged_ = clutch_.engaged() || !has_regions_ ? 1.0 : 0.0;
    pushed_back_ = clutch_.pushed_back();
    *state_ = {.regions = regions_,
               .has_regions = has_regions_,
               .turns = clutch_.turns() || !has_regions_,
               .engaged = engaged_ > 0.0,
               .inner = drive.inner,
               .outer = drive.outer,
               .coupled = drive.coupled,
               .engagements = clutch_.engagements(),
               .releases = clutch_.releases()};
  }

  void count() noexcept {
    if (seen_->coupled == 0.0) torque_after_ = std::max(torque_after_, removal_->torque);
  }

  void feel() noexcept {
    if (felt_->engagements != felt_engagements_) stage_->hand->drive_changed();
    if (felt_->releases != felt_releases_) stage_->hand->drill_stopped();
    felt_engagements_ = felt_->engagements;
    felt_releases_ = felt_->releases;
  }

  ClutchScene scene_;
  Clutch clutch_;
  Stage* stage_;
  bool has_regions_ = false;
  DrillRegions regions_;
  std::optional<TipSupport> support_;
  TipLoad load_;
  DrillThrust thrust_sum_;                                  // contact clock
  DrillThrust before_;                                      // of the last simulation step
  std::uint64_t felt_engagements_ = 0, felt_releases_ = 0;  // servo clock
  double force_ = 0.0, reaction_ = 0.0;                     // [N] along the shaft; of the tip
  double thrust_most_ = 0.0, reaction_most_ = 0.0;          // [N] of all steps
  double thrust_at_release_ = 0.0;                          // [N]
  double torque_after_ = 0.0;                               // [N m] the largest since the last release while released
  double inner_turns_ = 0.0, outer_turns_ = 0.0;            // [rev] since the last release, not driven
  double engaged_ = 0.0, pushed_back_ = 0.0;                // for the columns
  const ContactState* touched_ = nullptr;
  DrillThrust* thrust_out_ = nullptr;
  const Cut* cut_ = nullptr;
  const double *asked_ = nullptr, *spin_ = nullptr;  // [rev/s]
  const DrillThrust* thrust_ = nullptr;
  DrillClutch* state_ = nullptr;
  double* drill_spin_ = nullptr;
  const DrillClutch *seen_ = nullptr, *felt_ = nullptr;
  const BoneRemoval* removal_ = nullptr;
};

class ClutchPlan final : public ConfigPlan<ClutchPlan, ClutchScene>, public RequiringPlan {
 public:
  explicit ClutchPlan(TableReader& table) {
    ClutchConfig& c = config_.clutch;
    constexpr double kPerMillimetre = 1e3;  // [N/m] of 1 N/mm
    c.engage_force = table.number("engage_N", above_zero(c.engage_force, 1.0, 1e4),
                                  "least reaction of bone on the tip of the inner drill that engages the clutch (an assumption)");
    c.stiffness = table.number("spring_N_per_mm", above_zero(c.stiffness / kPerMillimetre, kPerMillimetre, 1e4),
                               "stiffness of the spring that holds the inner drill forward (an assumption)");
    c.travel = table.number("travel_mm", above_zero(c.travel / kMillimetre, kMillimetre, 20.0),
                            "way of the inner drill from forward to engaged; times the stiffness at most engage_N (an assumption)");
    c.teeth = table.number("teeth_mm", above_zero(c.teeth / kMillimetre, kMillimetre, 20.0),
                           "depth to which the teeth engage, less than travel_mm; the clutch releases at engage_N - spring x teeth (an "
                           "assumption)");
    c.damping = table.number("damping_N_s_per_m", at_least_zero(c.damping, 1.0, 1e6),
                             "resistance of the inner drill to moving along the shaft (an assumption)");
    c.inner_stop = table.number("inner_stop_s", at_least_zero(c.inner_stop, 1.0, 60.0),
                                "time in which the inner drill runs down once it is released (an assumption)");
    c.outer_stop = table.number("outer_stop_s", at_least_zero(c.outer_stop, 1.0, 60.0),
                                "time in which the outer drill runs down once it is released (an assumption)");
    c.release_delay = table.number("release_delay_s", at_least_zero(c.release_delay, 1.0, 3600.0),
                                   "failure, late release: time for which the teeth hold after they should have parted; 0: none");
    c.least_spin = table.number("least_spin_rpm", at_least_zero(c.least_spin / kRevPerMinute, kRevPerMinute, 1e6),
                                "failure, no release at low speed: below this speed the clutch neither releases nor engages; 0: none");
    c.wear = table.number("wear", within(c.wear, 0.0, 1.0), "failure, worn spring: share of its force that the spring has lost; 0: none");
    config_.soft_hardness = table.number("soft_hardness", within(config_.soft_hardness, 0.0, 1.0),
                                         "failure, early release: bone of less hardness gives the tip no reaction; 0: none");
    config_.inner = table.text("inner", config_.inner, "name of the region of the tool that is the inner drill");
    config_.outer = table.text("outer", config_.outer, "name of the region of the tool that is the outer drill");
    config_.inner_place = table.place_of("inner");
    config_.outer_place = table.place_of("outer");
    if (c.teeth >= c.travel) table.fault("teeth_mm", "must be less than travel_mm");
    if (c.stiffness * c.travel > c.engage_force)
      table.fault("engage_N", fmt::format("must be at least spring_N_per_mm x travel_mm = {:.3g}: the spring holds the inner drill forward",
                                          c.stiffness * c.travel));
    if (config_.inner == config_.outer) table.fault("outer", "must not be the same region as inner");
  }

  PlanRow row(const PlanContext& context) const override {
    const Clutch clutch = Clutch::create(config_.clutch).value();
    const Tool& tool = context.tool;
    const std::uint64_t nodes = tool.cutting ? tool.cutting->factor.size() : 0, points = tool.erosion.size();
    return {.table = "clutch",
            .clock = Clock::simulation,
            .step = "reaction of bone on the tip, state of the clutch",
            .needs = "thrust, window, spin",
            .gives = "speeds of inner and outer drill",
            .detail = fmt::format("engages at {:.3g} N on the tip, releases at {:.3g} N", clutch.engage_force(), clutch.release_force()),
            .rate_hz = static_cast<double>(context.needs.simulation_hz),
            .bytes = sizeof(ClutchEffect) + points * (2 * sizeof(float) + 1) + nodes * (3 * sizeof(float) + 1)};
  }
  std::vector<Requirement> requirements(const Needs& needs) const override {
    return {{.table = "contact", .met = needs.feels, .without = "nothing presses the tip, so the clutch never engages"},
            {.table = "erosion", .met = needs.removes, .without = "no bone is cut, so the tip never loses its support"}};
  }
  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    if (context.config.hand.push <= config_.clutch.engage_force * (1.0 - config_.clutch.wear) && !context.config.feed_hand &&
        !context.config.goal_hand)
      out.push_back(fmt::format("[clutch] hand.push_N = {:.3g} does not engage it: the tip takes {:.3g} N", context.config.hand.push,
                                config_.clutch.engage_force * (1.0 - config_.clutch.wear)));
  }
  std::string setting() const override { return fmt::format("clutch {:.3g} N", config_.clutch.engage_force); }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    auto clutch = Clutch::create(config_.clutch);
    if (!clutch) return clutch.error();
    if (!regions_of(*stage.tool, config_)) {
      const bool lacks_inner = stage.tool->surface == nullptr || !stage.tool->surface->find_region(config_.inner);
      return Error{
          ErrorCode::bad_input,
          fmt::format("[clutch] the tool \"{}\" has not exactly one region \"{}\": use a tool with an inner and an outer drill, as "
                      "perforator_14_11, name its regions in clutch.inner and clutch.outer, or leave [clutch] out (--unset clutch)",
                      stage.tool->name, lacks_inner ? config_.inner : config_.outer),
          lacks_inner ? config_.inner_place : config_.outer_place};
    }
    return std::unique_ptr<Effect>(std::make_unique<ClutchEffect>(config_, *clutch, stage));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<ClutchPlan>(table); }

}  // namespace

EffectEntry clutch_effect() {
  return {"clutch",
          "the clutch of a perforator, which stops it when its tip loses the bone; without it the drill turns with its drive",
          read,
          {},
          {.figures = {{"released_s"}, {"release_took_ms", 1.0}, {"thrust_at_release_N", 1.0}}}};
}

}  // namespace burrhole
