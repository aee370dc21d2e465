// [dust]: chips and mist that drilling makes: they fly, settle and hide the hole, until saline or suction takes them away.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/effect/gravity_key.h"
#include "app/effect/registry.h"
#include "app/stage/coolant.h"
#include "app/stage/drill_clutch.h"
#include "app/stage/instruments.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "app/view/debris_mesh.h"
#include "core/base/random.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "core/debris/debris_field.h"

namespace burrhole {
namespace {

constexpr double kMicrometre = 1e-6, kPerMicrometre = 1e6;            // [m], [1/m]
constexpr double kCubicMillimetre = 1e-9, kPerCubicMillimetre = 1e9;  // [m^3], [1/m^3]
constexpr double kLitrePerMinute = 1e-3 / 60.0;                       // [m^3/s]

struct SuctionConfig {
  double flow = 20.0 * kLitrePerMinute;  ///< [m^3/s] of air (an assumption)
  double reach = 10e-3;                  ///< [m] (an assumption)
  double distance = 8e-3;                ///< [m] from the tip (an assumption)
  double from = 0.0;                     ///< [s] of the run
  bool by_switch = false;                ///< only while its switch is on
};

struct DustScene {
  DebrisConfig field{};
  double reach = 20e-3;       ///< [m] from the drilled line to the edge of the site
  double heap_cell = 0.6e-3;  ///< [m]
  std::optional<Vec3> down;   ///< [-] world frame; absent: along the drilled line, into bone
  std::optional<SuctionConfig> suction;
  std::string place;
};

/// @returns the box within reach of the drilled line, bone frame.
Bounds box_of(const DrillingWay& way, const Affine& bone_from_index, double reach) {
  const Vec3 entry = bone_from_index * way.index_from_tool.offset, end = bone_from_index * (way.index_from_tool.offset + way.along);
  return {glm::min(entry, end) - reach, glm::max(entry, end) + reach};
}

class DustEffect final : public Effect {
 public:
  DustEffect(const DustScene& scene, DebrisField field, Stage& stage)
      : scene_(scene),
        field_(std::move(field)),
        picture_(field_),
        stage_(&stage),
        voxmap_(stage.voxmap.get()),
        listener_(voxmap_->add_listener()),
        growth_(voxmap_->growth_epoch()),
        bone_from_index_(voxmap_->bone().bone_from_index()) {
    const Vec3i size = field_.site().voxels().size();
    density_.resize(static_cast<std::size_t>(std::max(0, size.x)) * static_cast<std::size_t>(std::max(0, size.y)));
    read_bone(field_.site().voxels(), nullptr);
    read_floor();
    measure_bit();
  }

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "dust", "dust", [](void* self, const Tick& tick) { static_cast<DustEffect*>(self)->run(tick); }, this);
    cut_ = step.now(slots::kCut);
    spin_ = step.now(graph.is_written(slots::kDrillSpin.name) ? slots::kDrillSpin : slots::kSpin);
    removal_ = step.now_if_written(slots::kRemoval);
    chips_ = step.now_if_written(slots::kChipLoad);
    coolant_ = step.now_if_written(slots::kCoolant);
    if (scene_.suction && scene_.suction->by_switch) hand_ = step.latest(slots::kHand);
    step.column("dust_flying", "m^3", &flying_);
    step.column("dust_settled", "m^3", &settled_);
    step.column("dust_hidden", "", &hidden_);
    return {};
  }
  PictureSource* picture_source() noexcept override { return &picture_; }
  Status change_tool(Stage&) override {
    measure_bit();
    return {};
  }
  /// Bone that comes back takes its chips with it.
  void place(const Pose&) noexcept override {
    for (const VoxelBox& box : voxmap_->take_dirty(listener_)) read_bone(box, nullptr);
    if (voxmap_->growth_epoch() == growth_) return;
    growth_ = voxmap_->growth_epoch();
    field_.bone_came_back();
    look();
  }
  void report(Figures& out) const override {
    const DebrisTotals& t = field_.totals();
    const auto add = [&out](const char* name, double volume) { out.add(name, volume * kPerCubicMillimetre); };
    add("removed_mm3", t.removed);
    add("held_mm3", field_.held());
    add("flying_mm3", field_.flying());
    add("mist_mm3", field_.mist());
    add("settled_mm3", field_.settled());
    add("rinsed_mm3", t.rinsed);
    add("sucked_mm3", t.sucked);
    add("lost_mm3", t.lost);
    add("undone_mm3", t.undone);
    out.add("balance_error", field_.balance_error());
    if (scene_.suction) out.add("suction_s", sucking_);
    out.add("hidden_share", hidden_);
    out.add("most_hidden_share", most_hidden_);
    out.add("mean_chip_um", field_.mean_diameter() * kPerMicrometre);
    out.add("particles", static_cast<std::uint64_t>(field_.particles().size()));
    out.add("most_particles", static_cast<std::uint64_t>(field_.most()));
    out.add("merged", field_.merged());
  }
  void warn(std::vector<std::string>& out) const override {
    if (field_.merged() > 0)
      out.push_back(
          fmt::format("[dust] {} particles were merged with others, which keeps the volume but coarsens the chips: increase "
                      "dust.most_particles or dust.particle_mm3",
                      field_.merged()));
    const DebrisTotals& t = field_.totals();
    if (t.lost > 0.5 * t.removed)
      out.push_back(fmt::format("[dust] {:.0f} % of the removed bone flew beyond dust.reach_mm", 100.0 * t.lost / t.removed));
  }

 private:
  void run(const Tick& tick) {
    time_ += tick.dt;
    const std::span<const DebrisBirth> births = follow_bone(tick.number);
    const Affine bone_from_tool = bone_from_index_ * cut_->path.to;
    DebrisStep now{.dt = tick.dt, .removed = removal_->mass, .thickness = chips_->thickness, .births = births};
    now.bit = {bone_from_tool.offset, glm::normalize(bone_from_tool.linear[2]), radius_, height_, *spin_};
    if (coolant_->flow > 0.0) now.rinse = {now.bit.tip, coolant_->reach, coolant_->flow};
    if (sucks()) {
      now.suction = {nozzle(*scene_.suction, now.bit.tip), scene_.suction->reach, scene_.suction->flow};
      sucking_ += tick.dt;
    }
    field_.step(now);
    look();
  }
  [[nodiscard]] bool sucks() const noexcept {
    if (!scene_.suction || time_ < scene_.suction->from) return false;
    return hand_ == nullptr || (hand_->switches & kSuctionSwitch) != 0;
  }
  /// Takes over what changed in the bone. @returns places of what was removed, in proportion to it.
  std::span<const DebrisBirth> follow_bone(std::uint64_t number) {
    const VoxelBoxes changed = voxmap_->take_dirty(listener_);
    double total = 0.0;
    if (removal_->mass > 0.0)
      for (const VoxelBox& box : changed)
        for_each_layer(box, [&](const VoxelBox& layer, std::span<const float> density) { total += field_.site().loss_of(layer, density); });
    sampler_.emplace(total, uniform01(scene_.field.seed + 1, number));
    for (const VoxelBox& box : changed) read_bone(box, total > 0.0 ? &*sampler_ : nullptr);
    return sampler_->births();
  }
  void read_bone(const VoxelBox& box, LossSampler* sampler) {
    for_each_layer(box, [&](const VoxelBox& layer, std::span<const float> density) { field_.site().set_bone(layer, density, sampler); });
  }
  /// Layer by layer: the densities of all voxels would take four times the memory of the site.
  template <class F>
  void for_each_layer(const VoxelBox& box, const F& f) {
    const VoxelBox part = box.intersect(field_.site().voxels());
    if (part.empty()) return;
    for (int k = part.lo.z; k < part.hi.z; ++k) {
      const VoxelBox layer{Vec3i(part.lo.x, part.lo.y, k), Vec3i(part.hi.x, part.hi.y, k + 1)};
      const std::span<float> density(density_.data(), layer.count());
      voxmap_->read_density(layer, density);
      f(layer, density);
    }
  }
  void read_floor() {
    const VoxelBox& all = field_.site().voxels();
    std::vector<std::uint8_t> soft(density_.size());
    for (int k = all.lo.z; k < all.hi.z; ++k) {
      const VoxelBox layer{Vec3i(all.lo.x, all.lo.y, k), Vec3i(all.hi.x, all.hi.y, k + 1)};
      voxmap_->read_labels(layer, density_);
      std::ranges::transform(density_, soft.begin(), [](float value) {
        const auto label = static_cast<VoxelLabel>(static_cast<int>(value));
        return label == VoxelLabel::dura || label == VoxelLabel::brain ? std::uint8_t{1} : std::uint8_t{0};
      });
      field_.site().set_floor(layer, soft);
    }
  }
  void measure_bit() {
    radius_ = height_ = 0.0;
    const ErosionPoints& points = stage_->tool->erosion;
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (!(points.factors[n] > 0.0f)) continue;
      radius_ = std::max(radius_, std::hypot(points.positions[n].x, points.positions[n].y));
      height_ = std::max(height_, points.positions[n].z);
    }
  }
  /// Beside and above the tip, raised along the drilled line until it is in the open.
  [[nodiscard]] Vec3 nozzle(const SuctionConfig& suction, const Vec3& tip) const noexcept {
    const Pose& approach = stage_->approach.bone_from_approach;
    Vec3 place = tip + suction.distance * approach.rotate(Vec3(std::sqrt(0.5), 0.0, std::sqrt(0.5)));
    const Vec3 up = 0.5 * field_.site().voxel() * approach.rotate(Vec3(0.0, 0.0, 1.0));
    for (int n = 0; n < kMostRaises && field_.site().is_solid(place); ++n) place += up;
    return place;
  }
  void look() noexcept {
    flying_ = field_.flying();
    settled_ = field_.settled();
    const Pose& approach = stage_->approach.bone_from_approach;
    hidden_ = radius_ > 0.0 ? field_.hidden_share(approach.translation, approach.rotate(Vec3(0.0, 0.0, 1.0)), radius_) : 0.0;
    most_hidden_ = std::max(most_hidden_, hidden_);
  }

  static constexpr int kMostRaises = 512;  // half voxels
  DustScene scene_;
  DebrisField field_;
  DebrisPicture picture_;
  Stage* stage_;
  Voxmap* voxmap_;
  std::size_t listener_;
  std::uint64_t growth_;
  Affine bone_from_index_;
  std::vector<float> density_;  // scratch of a layer
  std::optional<LossSampler> sampler_;
  double radius_ = 0.0, height_ = 0.0;  // [m] of the cutting part
  double time_ = 0.0, sucking_ = 0.0;   // [s]
  double flying_ = 0.0, settled_ = 0.0, hidden_ = 0.0, most_hidden_ = 0.0;
  const Cut* cut_ = nullptr;
  const double* spin_ = nullptr;  // [rev/s]
  const BoneRemoval* removal_ = nullptr;
  const ChipLoad* chips_ = nullptr;
  const Coolant* coolant_ = nullptr;
  const HandState* hand_ = nullptr;  // null: the suction has no switch
};

SuctionConfig read_suction(TableReader table) {
  SuctionConfig c;
  c.flow = table.number("flow_l_per_min", above_zero(c.flow / kLitrePerMinute, kLitrePerMinute, 1e3), "flow of air (an assumption)");
  c.reach = table.number("reach_mm", above_zero(c.reach / kMillimetre, kMillimetre, 200.0),
                         "distance from the nozzle beyond which it takes nothing (an assumption)");
  c.distance = table.number("distance_mm", at_least_zero(c.distance / kMillimetre, kMillimetre, 200.0),
                            "distance of the nozzle from the tip, beside and above it (an assumption)");
  c.from = table.number("from_s", at_least_zero(c.from), "time of the run at which it is switched on");
  c.by_switch = table.boolean("by_switch", c.by_switch, "true: it is on only while a person switches it on: U in the window, or an input");
  table.finish();
  return c;
}

class DustPlan final : public SwitchedPlan<DustPlan, DustScene>, public RequiringPlan {
 public:
  explicit DustPlan(TableReader& table) {
    DustScene& c = config_;
    DebrisConfig& f = c.field;
    c.place = table.place();
    f.most_particles = static_cast<std::size_t>(table.integer("most_particles", static_cast<std::int64_t>(f.most_particles), 1, 1'000'000,
                                                              "budget: more particles than this are merged, which keeps the volume"));
    f.particle = table.number("particle_mm3", above_zero(f.particle * kPerCubicMillimetre, kCubicMillimetre, 100.0),
                              "volume of bone of a particle, which stands for many chips");
    read_chips(table);
    read_mist(table);
    f.bulk = table.number("bulk", {.fallback = f.bulk, .min = 1.0, .max = 20.0},
                          "volume of loose chips over that of their bone (an assumption)");
    f.rinse_time =
        table.number("rinse_s", above_zero(f.rinse_time), "with [irrigation]: time in which saline takes wet chips (an assumption)");
    f.rinse_load = table.number("rinse_load", at_least_zero(f.rinse_load, 1.0, 1.0),
                                "with [irrigation]: most volume of chips that a volume of saline carries (an assumption)");
    c.reach = table.number("reach_mm", {.fallback = c.reach / kMillimetre, .min = 1.0, .max = 200.0, .to_si = kMillimetre},
                           "distance from the drilled line up to which chips are followed; beyond it they are lost");
    c.heap_cell = table.number("heap_cell_mm", {.fallback = c.heap_cell / kMillimetre, .min = 0.05, .max = 5.0, .to_si = kMillimetre},
                               "edge of the cells in which chips pile up");
    c.down = read_down(table);
    f.seed = static_cast<std::uint64_t>(table.integer("seed", static_cast<std::int64_t>(f.seed), 0, 1'000'000'000, "seed of the scatter"));
    if (const auto suction = table.table("suction", "a suction nozzle near the tip; absent: none")) c.suction = read_suction(*suction);
    if (c.suction && c.suction->by_switch) instruments_.switches = kSuctionSwitch;
  }

  void add_needs(const StageConfig&, Needs& needs) const override { needs.chip_load = true; }

  PlanRow row(const PlanContext& context) const override {
    const Affine& frame = context.bone.bone_from_index;
    const Bounds box = box_of(drilling_way(context.config, context.bone), frame, config_.reach);
    const std::uint64_t voxels = DebrisSite::voxels_in(box, frame, {Vec3i(0), context.bone.dims}).count();
    const Vec3 cells = glm::floor((box.hi - box.lo) / config_.heap_cell) + 1.0;
    const auto count = static_cast<std::uint64_t>(cells.x * cells.y * cells.z);
    return {.table = "dust",
            .clock = Clock::simulation,
            .step = "chips and mist: flight, heap, rinsing, suction",
            .needs = "removal, chip load, changed boxes, coolant",
            .gives = "particles",
            .detail = fmt::format("at most {} particles of {:g} mm3, {} voxels, {} cells of {:g} mm{}", config_.field.most_particles,
                                  config_.field.particle * kPerCubicMillimetre, voxels, count, config_.heap_cell / kMillimetre,
                                  config_.suction ? ", suction" : ""),
            .rate_hz = static_cast<double>(context.needs.simulation_hz),
            .bytes = sizeof(DustEffect) + voxels + count * sizeof(float) + DebrisField::bytes_of(config_.field, count)};
  }
  std::vector<Requirement> requirements(const Needs& needs) const override {
    return {{.table = "erosion", .met = needs.removes, .without = "no bone is cut, so there are no chips"}};
  }
  std::string setting() const override { return fmt::format("dust, at most {} particles", config_.field.most_particles); }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    const BoneModel& bone = stage.voxmap->bone();
    const BoneShape shape{.dims = bone.dims(), .bone_from_index = bone.bone_from_index(), .thickness = stage.approach.thickness};
    auto site = DebrisSite::create(box_of(drilling_way(stage.config, shape), shape.bone_from_index, config_.reach), shape.bone_from_index,
                                   {Vec3i(0), shape.dims}, config_.heap_cell, down_in_bone(stage, config_.down));
    if (!site)
      return Error{ErrorCode::bad_input, "[dust] " + site.error().message + ": reduce dust.reach_mm or increase dust.heap_cell_mm",
                   config_.place};
    auto field = DebrisField::create(config_.field, std::move(*site));
    if (!field) return Error{ErrorCode::bad_input, "[dust] " + field.error().message, config_.place};
    return std::unique_ptr<Effect>(std::make_unique<DustEffect>(config_, std::move(*field), stage));
  }

 private:
  void read_chips(TableReader& table) {
    DebrisConfig& f = config_.field;
    f.chip_ratio = table.number("chip_ratio", above_zero(f.chip_ratio, 1.0, 1e4),
                                "diameter of a chip over the mean uncut chip thickness (an assumption)");
    f.smallest = table.number("smallest_um", {.fallback = f.smallest * kPerMicrometre, .min = 1.0, .max = 5000.0, .to_si = kMicrometre},
                              "least mean diameter of chips (an assumption)");
    f.largest = table.number("largest_um", {.fallback = f.largest * kPerMicrometre, .min = 1.0, .max = 5000.0, .to_si = kMicrometre},
                             "largest mean diameter of chips (an assumption)");
    if (f.largest < f.smallest) table.fault("largest_um", "must be at least smallest_um");
    f.size_spread = table.number("size_spread", {.fallback = f.size_spread, .min = 1.0, .max = 10.0},
                                 "diameters lie between the mean over this and times this (an assumption)");
    f.air.chip_density = table.number("density_kg_per_m3", above_zero(f.air.chip_density, 1.0, 1e5), "density of bone");
    f.clearing = table.number("clearing_per_rev", above_zero(f.clearing, 1.0, 100.0),
                              "share of the chips that the bit holds which a revolution clears out (an assumption)");
    f.throw_share = table.number("throw_share", at_least_zero(f.throw_share, 1.0, 10.0),
                                 "mean speed of leaving chips over that of the bit's rim (an assumption)");
    f.spread = table.number("spread", at_least_zero(f.spread, 1.0, 10.0),
                            "spread of their directions, outwards and up, over along the rim (an assumption)");
  }
  void read_mist(TableReader& table) {
    DebrisConfig& f = config_.field;
    f.mist_share = table.number("mist_share", within(f.mist_share, 0.0, 1.0), "share of the volume that becomes mist (an assumption)");
    f.mist_diameter =
        table.number("mist_um", {.fallback = f.mist_diameter * kPerMicrometre, .min = 0.5, .max = 500.0, .to_si = kMicrometre},
                     "diameter of mist (an assumption)");
    f.mist_cloud = table.number("mist_cloud_mm", at_least_zero(f.mist_cloud / kMillimetre, kMillimetre, 100.0),
                                "distance to which the bit stirs mist (an assumption)");
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<DustPlan>(table); }

}  // namespace

EffectEntry dust_effect() {
  return {"dust",
          "chips and mist of the removed bone, which hide the hole; without it removed bone vanishes",
          read,
          {"down = [0, 0, -1]", "[dust.suction]"},
          {.figures = {{"settled_mm3"}, {"most_hidden_share", 0.05}, {"hidden_share", 0.05}},
           // Of half the size there are twice the particles; a cell of the heap holds a few of them.
           .knobs = {{.key = "particle_mm3", .multiples = {4, 2, 1, 0.5}, .reference = 0.125, .along = {{"dust.most_particles", -1.0}}},
                     {"most_particles", {0.125, 0.25, 0.5, 1}, 2},
                     {.key = "heap_cell_mm",
                      .multiples = {2, 1, 0.75},
                      .reference = 0.5,
                      .along = {{"dust.particle_mm3", 3.0}, {"dust.most_particles", -3.0}}},
                     {"reach_mm", {0.5, 1}, 2}}}};
}

}  // namespace burrhole
