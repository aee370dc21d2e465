// [erosion]: drilling. Erosion points, or the tool's field, remove bone along the tool's path.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "app/effect/registry.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "core/config/rules.h"
#include "core/drill/cut_face.h"
#include "core/drill/energy.h"
#include "core/drill/erosion_memory.h"
#include "core/drill/region_spin.h"
#include "core/tool/cutting_field.h"

namespace burrhole {
namespace {

constexpr std::array<std::pair<const char*, ErosionLaw>, 5> kLaws{{{"rate", ErosionLaw::rate},
                                                                   {"per-update", ErosionLaw::per_update},
                                                                   {"energy", ErosionLaw::energy},
                                                                   {"threshold", ErosionLaw::threshold},
                                                                   {"progressive", ErosionLaw::progressive}}};
/// [Pa] ultimate strength, [TellesONeill10] table 1.
constexpr std::array<std::pair<const char*, double>, 3> kMaterials{{{"bone", 170e6}, {"wood", 50e6}, {"steel", 400e6}}};

const char* name_of(ErosionLaw law) {
  for (const auto& [name, value] : kLaws)
    if (value == law) return name;
  return "";
}

/// @returns the number that the shortest decimal text of a float means: 0.05 of 0.05f.
double decimal_of(float value) { return std::stod(fmt::format("{}", value)); }

class ErosionEffect final : public Effect {
 public:
  ErosionEffect(Erosion erosion, const ErosionConfig& config, Stage& stage)
      : erosion_(std::move(erosion)),
        config_(config),
        stage_(&stage),
        voxmap_(stage.voxmap.get()),
        specific_energy_(config.law == ErosionLaw::progressive ? config.progressive.curve.toughness() / config.progressive.work_share
                                                               : config.energy.specific_energy),
        tool_radius_(rubbing_radius(stage.tool->erosion)) {}

  Status bind(StepGraph& graph) override {
    if (stage_->needs.chip_load) teeth_ = cutting_teeth(*stage_->tool);
    const bool clutched = graph.is_written(slots::kClutch.name);
    // Of three forms of the step, so that a scene in which nothing reads the chip load, or without a clutch, has no instruction of it.
    const StepGraph::Run call =
        clutched ? StepGraph::Run([](void* self, const Tick& tick) { static_cast<ErosionEffect*>(self)->run_clutched(tick); })
        : teeth_ ? StepGraph::Run([](void* self, const Tick& tick) { static_cast<ErosionEffect*>(self)->run_with_chips(tick); })
                 : StepGraph::Run([](void* self, const Tick& tick) { (void)static_cast<ErosionEffect*>(self)->run(tick); });
    auto step = graph.step(Clock::simulation, "erosion", "erosion", call, this);
    cut_ = step.now(slots::kCut);
    asked_ = step.now(slots::kSpinAsked);
    spin_ = step.last(slots::kSpin);
    removal_ = step.own(slots::kRemoval);
    if (teeth_) chips_ = step.own(slots::kChipLoad);
    if (clutched) {
      clutch_ = step.now(slots::kClutch);
      if (Status split = split_regions(); !split) return split;
    }
    step.column("removed_mass", "m^3", &removed_mass_, true);
    return {};
  }
  Status change_tool(Stage& stage) override {
    auto erosion = Erosion::create(config_, stage.tool->erosion, stage.tool->cutting);
    if (!erosion) return erosion.error();
    erosion_ = std::move(erosion).value();
    tool_radius_ = rubbing_radius(stage.tool->erosion);
    return {};
  }
  void report(Figures& out) const override {
    out.add("removed_mass_mm3", removed_mass_ * 1e9);
    out.add("points_outside", outside_);
    if (config_.law == ErosionLaw::threshold || config_.law == ErosionLaw::progressive) out.add("largest_stress_MPa", stress_ / 1e6);
    out.add("bytes", static_cast<std::uint64_t>(voxmap_->cut().bytes()));
  }
  std::vector<NamedTimer> timers() const override { return {{"gradient", &commit_timer_, true}}; }

 private:
  /// Gives the regions of a tool with a clutch a speed each.
  Status split_regions() {
    regions_.reset();
    if (!clutch_->has_regions) return {};
    regions_.emplace(*stage_->tool, clutch_->regions);
    auto erosion = Erosion::create(config_, stage_->tool->erosion, regions_->field());
    if (!erosion) return erosion.error();
    erosion_ = std::move(erosion).value();
    return {};
  }

  void run_clutched(const Tick& tick) {
    if (clutch_->inner == 0.0 && clutch_->outer == 0.0) {
      *removal_ = {};
      if (teeth_) *chips_ = {};
      return;
    }
    if (regions_) regions_->set(clutch_->inner, clutch_->outer, erosion_);
    if (teeth_)
      run_with_chips(tick);
    else
      (void)run(tick);
    removal_->torque *= clutch_->coupled;
    removal_->cutting = removal_->cutting && clutch_->coupled > 0.0;
  }

  ErosionOutcome run(const Tick& tick) {
    ErosionOutcome outcome;
    *removal_ = {};
    if (!(*asked_ > 0.0)) return outcome;
    if (!cut_->far) outcome = erosion_.step(*voxmap_, cut_->path, CuttingLoad{*spin_, cut_->thrust, cut_->reaction}, tick.dt);
    if (!outcome.changed.empty()) commit_timer_([&] { voxmap_->commit(outcome.changed); });
    removed_mass_ += outcome.removed_mass;
    outside_ += outcome.outside;
    stress_ = std::max(stress_, outcome.stress);
    const double radius = outcome.rubbing_radius > 0.0 ? outcome.rubbing_radius : tool_radius_;
    const double torque = cutting_torque(config_.energy.cutting_ratio, cut_->thrust, radius);
    const bool counts_work = config_.law == ErosionLaw::energy || config_.law == ErosionLaw::progressive;
    const double work = counts_work ? outcome.energy : 0.0;
    *removal_ = {outcome.removed_mass, work, torque, true, !outcome.changed.empty(), outcome.outside};
    return outcome;
  }

  void run_with_chips(const Tick& tick) {
    const double spin = *spin_;  // of the removal: that of the last step
    const ErosionOutcome outcome = run(tick);
    *chips_ = {};
    if (!removal_->cutting) return;
    *chips_ = chip_load(*teeth_, {.mass = outcome.removed_mass,
                                  .hardness = mean_hardness(outcome),
                                  .tangential = config_.energy.cutting_ratio * cut_->thrust,
                                  .torque = removal_->torque,
                                  .spin = spin,
                                  .dt = tick.dt});
  }

  /// @returns the mean hardness [-] of the removed bone, at least 0.1 as in the laws. Removal by whole voxels does not sum it, except with
  /// the laws that account work; else it is the mean of the changed boxes, weighted by occupancy.
  [[nodiscard]] double mean_hardness(const ErosionOutcome& outcome) const noexcept {
    if (!(outcome.removed_mass > 0.0)) return 0.0;
    if (outcome.energy > 0.0) return outcome.energy / (specific_energy_ * outcome.removed_mass);
    const MasterWindow& window = voxmap_->window();
    double sum = 0.0, weight = 0.0;
    for (const VoxelBox& box : outcome.changed)
      for (int k = box.lo.z; k < box.hi.z; ++k)
        for (int j = box.lo.y; j < box.hi.y; ++j)
          for (int i = box.lo.x; i < box.hi.x; ++i) {
            const std::size_t at = window.box.offset_of(Vec3i(i, j, k));
            sum += static_cast<double>(window.occupancy[at]) * static_cast<double>(std::max(window.hardness[at], CutFace::kLeastHardness));
            weight += static_cast<double>(window.occupancy[at]);
          }
    return weight > 0.0 ? sum / weight : 0.0;
  }

  Erosion erosion_;
  ErosionConfig config_;
  Stage* stage_;
  Voxmap* voxmap_;
  double specific_energy_;     // [J/m^3] of bone of hardness 1, in laws that account work
  double tool_radius_;         // [m] of the whole tool, for laws that do not determine the radius at which it cuts
  double removed_mass_ = 0.0;  // [m^3]
  std::uint64_t outside_ = 0;
  double stress_ = 0.0;  // [Pa] the largest so far
  StepTimer commit_timer_;
  const Cut* cut_ = nullptr;
  const double *asked_ = nullptr, *spin_ = nullptr;  // [rev/s]
  BoneRemoval* removal_ = nullptr;
  std::optional<CuttingTeeth> teeth_;  // only if the chip load is read
  ChipLoad* chips_ = nullptr;
  std::optional<RegionSpins> regions_;  // only with a clutch
  const DrillClutch* clutch_ = nullptr;
};

class ErosionPlan final : public ConfigPlan<ErosionPlan, ErosionConfig>, public RequiringPlan {
 public:
  ErosionPlan(TableReader& table, const StageConfig& stage) {
    ErosionConfig& c = config_;
    std::vector<std::string> words;
    for (const auto& [word, law] : kLaws) words.emplace_back(word);
    const std::string law = table.choice(
        "law", name_of(c.law), words,
        "erosion law; rate: removal in proportion to spin and time, over hardness; per-update: a factor per update, [AcostaLiu07] eq. 4; "
        "energy: by the cutting power of thrust and spin; threshold: whole voxels in a ball inside the bit, where the stress under it "
        "reaches the ultimate strength, [TellesONeill10] section 4.3.4; progressive: bone under the bit is damaged by the work of cutting, "
        "as "
        "far as the stress there gets on a stress-strain curve, and is gone after the work under the whole curve");
    for (const auto& [word, value] : kLaws)
      if (law == word) c.law = value;
    if (c.law == ErosionLaw::threshold) read_threshold(table);
    if (c.law == ErosionLaw::progressive) read_progressive(table);
    if (c.law == ErosionLaw::threshold || c.law == ErosionLaw::progressive) read_bearing(table);
    if (c.law == ErosionLaw::rate || c.law == ErosionLaw::energy)
      c.subvoxel = table.boolean("subvoxel", true,
                                 "true: bone recedes from its face, whose place inside a voxel is kept, and the hole follows the tool's "
                                 "surface; false: every voxel that contains erosion points loses density gradually, so walls are rough "
                                 "by a voxel");
    if (c.law == ErosionLaw::energy) {
      constexpr double kPerCubicMillimetre = 1e9;  // [J/m^3] of 1 J/mm^3
      c.energy.specific_energy =
          table.number("specific_energy_J_per_mm3", above_zero(c.energy.specific_energy / kPerCubicMillimetre, kPerCubicMillimetre, 1e3),
                       "energy to remove 1 mm^3 of bone of hardness 1; in proportion to the hardness, with a hardness of at least 0.1");
    }
    if (c.law == ErosionLaw::energy || c.law == ErosionLaw::progressive)
      c.energy.cutting_ratio =
          table.number("cutting_ratio", above_zero(c.energy.cutting_ratio, 1.0, 10.0), "tangential cutting force over normal force");
    c.minimum_density = static_cast<float>(
        table.number("minimum_density", {.fallback = decimal_of(c.minimum_density), .min = 0.0, .max = 0.5, .max_open = true},
                     "density below which a voxel becomes empty; not used with subvoxel = true"));
    c.longest_substep = table.number("substep_voxels", {.fallback = c.longest_substep, .min = 0.01, .max = 1.0},
                                     "longest path of the tool's points between two applications of the law");
    rate_hz_ = read_rate(table, stage, rate_hz_, 1, "rate of erosion steps; divides servo_hz");
    pitch_voxels_ = table.number("point_pitch_voxels", within(pitch_voxels_, 0.1, 1.0), "distance between the tool's erosion points");
  }

  void add_needs(const StageConfig&, Needs& needs) const override {
    needs.simulation_hz = rate_hz_;
    needs.erosion_pitch_voxels = pitch_voxels_;
    needs.cutting_field = config_.subvoxel;
    needs.removes = true;
  }

  PlanRow row(const PlanContext& context) const override {
    const Tool& tool = context.tool;
    return {.table = "erosion",
            .clock = Clock::simulation,
            .step = "erosion points along the tool's path",
            .needs = "window, contact state",
            .gives = "changed boxes",
            .detail = fmt::format("{} points, law {}{}", tool.erosion.size(), name_of(config_.law), config_.subvoxel ? ", sub-voxel" : ""),
            .rate_hz = static_cast<double>(rate_hz_),
            .bytes = erosion_bytes(config_, tool, drilling_way(context.config, context.bone), context.voxel_edge(), context.window_voxels)};
  }

  std::vector<Requirement> requirements(const Needs& needs) const override {
    if (config_.law == ErosionLaw::rate || config_.law == ErosionLaw::per_update) return {};
    return {{.table = "contact",
             .met = needs.feels,
             .without = "there is no thrust, so nothing is removed",
             .keys = fmt::format("law = \"{}\"", name_of(config_.law))}};
  }
  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    const bool keyless = config_.law != ErosionLaw::rate && config_.law != ErosionLaw::energy;  // without the key subvoxel
    if (context.needs.holds_back && context.config.tool.spin > 0.0 && !config_.subvoxel)
      out.push_back(fmt::format("{} leaves walls with a roughness of a voxel, on which the model \"surface\" may block the bit: {}",
                                keyless ? std::string("[erosion] law = \"") + name_of(config_.law) + "\"" : "[erosion] subvoxel = false",
                                keyless ? "use another law or a penalty model" : "set it to true"));
    if (context.needs.any_density && config_.subvoxel)
      out.push_back(
          "[erosion] subvoxel = true moves the face at a density of 0.5, but contact.mode = \"paper\" is in contact where density is above "
          "0, "
          "which is above that face: set erosion.subvoxel = false");
    if (!context.needs.feels) out.push_back("no [contact]: no force acts on the hand, and the tool follows the script through bone");
  }

  std::string setting() const override {
    return std::string("erosion law ") + name_of(config_.law) + (config_.subvoxel ? ", sub-voxel" : ", whole voxels");
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    auto erosion = Erosion::create(config_, stage.tool->erosion, stage.tool->cutting);
    if (!erosion) return erosion.error();
    return std::unique_ptr<Effect>(std::make_unique<ErosionEffect>(std::move(erosion).value(), config_, stage));
  }

 private:
  void read_threshold(TableReader& table) {
    constexpr double kMegapascal = 1e6;
    ThresholdConfig& c = config_.threshold;
    std::vector<std::string> words;
    for (const auto& [word, strength] : kMaterials) words.emplace_back(word);
    const std::string material =
        table.choice("material", "bone", words, "material, for its ultimate strength: bone 170 MPa, wood 50 MPa, steel 400 MPa");
    for (const auto& [word, strength] : kMaterials)
      if (material == word) c.ultimate_strength = strength;
    c.ultimate_strength = table.number("ultimate_strength_MPa", above_zero(c.ultimate_strength / kMegapascal, kMegapascal, 1e5),
                                       "largest stress that the material withstands; default: that of the material");
    c.reach = table.number("reach", {.fallback = c.reach, .min = 0.0, .max = 1.0, .min_open = true},
                           "radius of the ball in which voxels are removed over the radius of the bit");
  }

  void read_bearing(TableReader& table) {
    double& share = config_.law == ErosionLaw::threshold ? config_.threshold.bearing_share : config_.progressive.bearing_share;
    share = table.number("bearing_share", {.fallback = share, .min = 0.0, .max = 1.0, .min_open = true},
                         "share of the projected contact area on which cutting edges bear; the stress is thrust / (share x area)");
  }

  void read_progressive(TableReader& table) {
    ProgressiveConfig& c = config_.progressive;
    c.work_share = table.number("work_share", {.fallback = c.work_share, .min = 0.0, .max = 1.0, .min_open = true},
                                "share of the cutting work that deforms bone; the rest is friction. The default and the default curve give "
                                "0.1 J/mm3 of cutting work (an assumption)");
    std::vector<StressStrainPoint> points;
    std::vector<TableReader> rows = table.tables(
        "curve",
        "points of the stress-strain curve of bone of hardness 1, from (0, 0) through where it yields to where it breaks; stresses are "
        "in proportion to the hardness. Default: cortical bone in tension, yield at 115 MPa, fracture at 133 MPa (an assumption)");
    for (TableReader& row : rows) {
      const double strain =
          row.number("strain", {.fallback = std::nullopt, .min = 0.0, .max = 10.0, .min_open = true}, "strain at the point");
      const double stress = row.number("stress_MPa", {.fallback = std::nullopt, .min = 0.0, .max = 1e5, .min_open = true, .to_si = 1e6},
                                       "stress at the point");
      points.push_back({strain, stress});
      row.finish();
    }
    if (points.empty()) return;
    if (auto curve = StressStrainCurve::create(std::move(points)))
      c.curve = std::move(curve).value();
    else
      table.fault("curve", curve.error().message);
  }

  int rate_hz_ = 50;           // [Hz]
  double pitch_voxels_ = 0.5;  // [voxels] between erosion points
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig& stage, Issues&) {
  return std::make_unique<ErosionPlan>(table, stage);
}

}  // namespace

EffectEntry erosion_effect() {
  return {"erosion",
          "drilling; without it no bone is removed",
          read,
          {"law = \"per-update\"", "law = \"energy\"", "law = \"threshold\"", "law = \"threshold\"\nmaterial = \"wood\"",
           "law = \"threshold\"\nmaterial = \"steel\"",
           "law = \"progressive\"\n[[erosion.curve]]\nstrain = 0.01\nstress_MPa = 100\n[[erosion.curve]]\nstrain = 0.02\nstress_MPa = 110"},
          {.figures = {{"breakthrough_s"}, {"removed_mass_mm3"}, {"hole_diameter_mm"}},
           .knobs = {{"substep_voxels", {2, 1, 0.5}, 0.25},
                     {"point_pitch_voxels", {2, 1}, 0.5},
                     {.key = "rate_hz", .multiples = {0.5, 1, 2}, .reference = 4, .of_all = true}}}};
}

}  // namespace burrhole
