// [dura]: the dura under the hole: a sheet that the bit indents, tears and pushes off the bone, and the force that is felt of it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "app/effect/dura_picture.h"
#include "app/effect/passive_keys.h"
#include "app/effect/registry.h"
#include "app/stage/dura_state.h"
#include "app/stage/stage.h"
#include "core/base/bounds.h"
#include "core/base/portable_math.h"
#include "core/base/trilinear.h"
#include "core/base/units.h"
#include "core/config/rules.h"
#include "core/sheet/elastic_sheet.h"
#include "haptics/servo/passive_force.h"

namespace burrhole {
namespace {

struct DuraScene {
  SheetConfig sheet{};
  double radius = 12e-3;        ///< [m] from the axis to where it is held
  double spacing = 1e-3;        ///< [m] of its nodes
  double pulse = 130.0;         ///< [Pa] from least to largest, 1 mmHg (an assumption)
  double pulse_rate = 1.1;      ///< [1/s] 66 beats a minute (an assumption)
  double largest_force = 50.0;  ///< [N] of the force on the hand (an assumption)
  PassiveForceConfig limit{};
  std::string place{}, radius_place{};
};

constexpr const char* kLevelTexts[] = {"clear", "pressed", "torn"};  // of DuraState::level
constexpr double kAbove = 3e-3, kBelow = 8e-3;  // [m] from the inner end of the axis, between which the dura is searched
constexpr double kNear = 2e-3;                  // [m] of a point of the tool above the dura, beyond which the dura is left at rest
constexpr double kVoxelsAbove = 2.0;            // of the dura, where bone over it is sought: half of one lies in the ramp of its surface
constexpr double kLeastHeld = 0.75;             // [-] of the places of the rim, in noisy bone with holes
constexpr int kVoxelsDeep = 4;                  // of bone over the dura, one of which holds it
constexpr std::uint64_t kNodeBytes = 1700;      // of a node of the sheet: fields, and twice the matrices of its edges and of bending
// Of a node, at most, near a rent: 25 corners of 200 bytes with room for 10 more of its edge, 500 for what finds them and for copies, 150 triangles
// with 75 vertices, 3000, and the last ones in the driver, 4200.
constexpr std::uint64_t kPictureBytes = 15000;
constexpr double kAtRest = 1e-12;  // [J] of the sheet

/// Heights of the dura over the plane across the approach axis, from the soft tissue of the bone as loaded, or from its labels.
class DuraTop {
 public:
  DuraTop(const BoneModel& bone, const Pose& bone_from_sheet, double radius)
      : index_from_sheet_(bone.bone_from_index().inverse() * Affine::from_pose(bone_from_sheet)) {
    const auto [lo, hi] = bounds_under(index_from_sheet_, {Vec3(-radius, -radius, -kBelow), Vec3(radius, radius, kAbove)});
    box_ = {floor_int(lo) - 1, floor_int(hi) + 3};
    soft_.resize(box_.count());
    labels_.resize(box_.count());
    bone.read_soft(box_, soft_);
    bone.read_labels(box_, labels_);
    if (std::ranges::none_of(soft_, [](float value) { return value >= 0.5f; }))
      for (std::size_t n = 0; n < soft_.size(); ++n) soft_[n] = is_dura(labels_[n]) ? 1.0f : 0.0f;
    step_ = 0.25 * bone.bone_from_index().mean_edge();
  }
  /// @returns z of the dura's upper face; nothing if there is none.
  [[nodiscard]] std::optional<double> at(double x, double y) const {
    double before = soft(x, y, kAbove);
    for (double z = kAbove - step_; z > -kBelow; z -= step_) {
      const double now = soft(x, y, z);
      if (now >= 0.5 && before < 0.5) {
        const double height = z + step_ * (now - 0.5) / (now - before);
        return labelled(x, y, height) ? std::optional(height) : std::nullopt;
      }
      before = now;
    }
    return std::nullopt;
  }

 private:
  static bool is_dura(float label) {
    const auto at = static_cast<VoxelLabel>(static_cast<int>(label));
    return at == VoxelLabel::dura || at == VoxelLabel::brain;
  }
  [[nodiscard]] double soft(double x, double y, double z) const { return trilinear(box_, soft_.data(), index_from_sheet_ * Vec3(x, y, z)); }
  [[nodiscard]] bool labelled(double x, double y, double z) const {
    const Vec3i voxel = voxel_of(index_from_sheet_ * Vec3(x, y, z - 4.0 * step_));
    return box_.contains(voxel) && is_dura(labels_[box_.offset_of(voxel)]);
  }
  Affine index_from_sheet_;
  VoxelBox box_;
  std::vector<float> soft_, labels_;
  double step_ = 0.0;
};

class DuraEffect final : public Effect {
 public:
  DuraEffect(const DuraScene& scene, ElasticSheet sheet, const PassiveForce& passive, const Pose& bone_from_sheet, Stage& stage)
      : scene_(scene),
        whole_(sheet),
        sheet_(std::move(sheet)),
        passive_(passive),
        stage_(&stage),
        voxmap_(stage.voxmap.get()),
        listener_(voxmap_->add_listener()),
        growth_(voxmap_->growth_epoch()),
        bone_from_sheet_(bone_from_sheet),
        index_from_sheet_(voxmap_->bone().bone_from_index().inverse() * Affine::from_pose(bone_from_sheet)),
        picture_(sheet_, bone_from_sheet, scene.sheet.thickness, voxmap_->bone().bone_from_index().mean_edge()),
        at_rest_(stage.config.volume.world_from_bone),
        sees_bone_(stage.needs.reads_window) {
    for (std::size_t n = 0; n < sheet_.lattice().nodes(); ++n) highest_ = std::max(highest_, sheet_.rest(n).z);
    fit_tool();
    const double above = voxmap_->bone().bone_from_index().mean_edge() * kVoxelsAbove;
    for (std::size_t n = 0; n < sheet_.lattice().nodes(); ++n)
      over_.push_back(voxel_of(index_from_sheet_ * (sheet_.rest(n) + Vec3(0.0, 0.0, above))));
    covers_.resize(over_.size());
    look_at_bone(nullptr);
  }

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "dura", "dura", [](void* self, const Tick& tick) { static_cast<DuraEffect*>(self)->deform(tick); }, this);
    cut_ = step.now(slots::kCut);
    (void)step.now_if_written(slots::kRemoval);  // after the bone was cut
    dura_ = step.own(slots::kDura);
    step.column("dura_force", "N", &force_);
    step.column("dura_indentation", "m", &indentation_);
    step.column("dura_bulge", "m", &bulge_);
    auto push = graph.step(
        Clock::contact, "dura", "dura's force", [](void* self, const Tick&) { static_cast<DuraEffect*>(self)->push(); }, this);
    state_ = push.now(slots::kContact);
    if (sees_bone_) touch_ = push.now(slots::kTouch);
    seen_ = push.latest(slots::kDura);
    push_ = push.own(slots::kDuraPush);
    push.column("dura_level", {"dura", kLevelTexts}, &level_);
    auto servo = graph.step(
        Clock::servo, "dura", "dura felt", [](void* self, const Tick& tick) { static_cast<DuraEffect*>(self)->feel(tick); }, this);
    hand_ = servo.now(slots::kHand);
    wanted_ = servo.latest(slots::kDuraPush);
    added_ = servo.add(slots::kAddedForce);
    return {};
  }
  PictureSource* picture_source() noexcept override { return &picture_; }
  Status change_tool(Stage&) override {
    fit_tool();
    return {};
  }
  /// Bone that comes back brings back the dura under it, whole and at rest.
  void place(const Pose&) noexcept override {
    passive_.restart();
    points_.clear();
    if (voxmap_->growth_epoch() == growth_) return;
    growth_ = voxmap_->growth_epoch();
    iterations_ += sheet_.iterations();
    sheet_ = whole_;
    look_at_bone(nullptr);
  }
  void report(Figures& out) const override {
    out.add("indentation_mm", largest_indentation_ / kMillimetre);
    out.add("bulge_mm", largest_bulge_ / kMillimetre);
    out.add("pushed_mm", pushed_ / kMillimetre);
    out.add("peak_force_N", peak_);
    out.add("largest_strain", strain_);
    out.add("torn", ever_torn_);
    out.add("torn_edges", static_cast<std::uint64_t>(sheet_.state().torn));
    out.add("separated_mm2", sheet_.state().separated * 1e6);
    out.add("pressed_s", pressed_);
    out.add("felt_N", passive_.figures().peak);
    out.add("given_mJ", passive_.figures().most_given * 1e3);
    out.add("nodes", static_cast<std::uint64_t>(sheet_.lattice().nodes()));
    out.add("iterations", iterations_ + sheet_.iterations());
  }
  void warn(std::vector<std::string>& out) const override {
    if (ever_torn_)
      out.push_back(fmt::format("[dura] the dura tore: it was indented by {:.2f} mm, with up to {:.2g} N",
                                largest_indentation_ / kMillimetre, peak_));
    else if (largest_indentation_ > 0.0 && peak_ > 0.0)
      out.push_back(
          fmt::format("[dura] the bit indented the dura by {:.2f} mm, with up to {:.2g} N", largest_indentation_ / kMillimetre, peak_));
  }

 private:
  /// So that steps with the stage's tool do not allocate.
  void fit_tool() {
    const std::size_t count = stage_->tool->shell.positions.size();
    for (std::vector<Vec3>* points : {&points_, &from_}) {
      points->clear();
      points->reserve(count);
    }
    sheet_.reserve(count);
  }

  /// @param changed boxes of bone; null: all of it.
  void look_at_bone(const VoxelBoxes* changed) {
    open_ = false;
    for (std::size_t n = 0; n < over_.size(); ++n) {
      if (changed == nullptr || changed->contains(over_[n])) {
        float density = 0.0f;
        voxmap_->read_density({over_[n], over_[n] + 1}, std::span(&density, 1));
        covers_[n] = density >= 0.5f ? SheetCover::bone : SheetCover::open;
        sheet_.cover(n, covers_[n]);
      }
      open_ = open_ || covers_[n] == SheetCover::open;
    }
  }

  void deform(const Tick& tick) {
    time_ += tick.dt;
    if (const VoxelBoxes changed = voxmap_->take_dirty(listener_); !changed.empty()) look_at_bone(&changed);
    const Affine sheet_from_tool = index_from_sheet_.inverse() * cut_->path.to;
    const double depth = -sheet_from_tool.offset.z;
    double lowest = highest_ + kNear;
    from_.swap(points_);
    points_.clear();
    for (const Vec3& point : stage_->tool->shell.positions) {
      points_.push_back(sheet_from_tool * point);
      lowest = std::min(lowest, points_.back().z);
    }
    const bool near = lowest < highest_ + kNear;
    const bool pulses = scene_.pulse > 0.0 && open_;
    if (!near && !pulses && sheet_.state().energy < kAtRest) {
      *dura_ = {0.0, 0.0, depth, sheet_.state().torn > 0 ? kDuraTorn : kDuraClear};
      force_ = indentation_ = bulge_ = 0.0;
      return;
    }
    const double pressure = 0.5 * scene_.pulse * (1.0 - portable_cos(2.0 * std::numbers::pi * scene_.pulse_rate * time_));
    const SheetState& state = sheet_.step(tick.dt, {.pressure = pressure, .tool_points = points_, .tool_from = from_});
    force_ = state.force;
    indentation_ = state.indentation;
    bulge_ = state.bulge;
    largest_bulge_ = std::max(largest_bulge_, bulge_);
    ever_torn_ = ever_torn_ || state.torn > 0;
    if (state.force > 0.0) {
      pressed_ += tick.dt;
      pushed_ = std::max(pushed_, highest_under_tool() - lowest);
    }
    peak_ = std::max(peak_, state.peak);
    largest_indentation_ = std::max(largest_indentation_, state.deepest);
    strain_ = std::max(strain_, state.stretched);
    *dura_ = {state.force, state.stiffness, depth, state.torn > 0 ? kDuraTorn : state.force > 0.0 ? kDuraPressed : kDuraClear};
  }
  /// @returns z of the dura at rest under the tool's axis.
  [[nodiscard]] double highest_under_tool() const {
    const Vec3 tip = (index_from_sheet_.inverse() * cut_->path.to).offset;
    const auto place = sheet_.lattice().find(tip.x, tip.y);
    double out = 0.0;
    if (place)
      for (std::size_t k = 0; k < 3; ++k) out += place->weights[k] * sheet_.rest(place->nodes[k]).z;
    return out;
  }

  void push() noexcept {
    level_ = seen_->level;
    *push_ = Vec3(0.0);
    if (!(seen_->force > 0.0)) return;
    const Pose world_from_bone = sees_bone_ ? touch_->bone->world_from_bone : state_->bone.world_from_rest * at_rest_;
    const Pose world_from_sheet = world_from_bone * bone_from_sheet_;
    const double depth = -(world_from_sheet.inverse() * state_->world_from_tool.translation).z;
    const double force = seen_->force + seen_->stiffness * (depth - seen_->depth);
    *push_ = std::clamp(force, 0.0, scene_.largest_force) * world_from_sheet.rotate(Vec3(0.0, 0.0, 1.0));
  }
  void feel(const Tick& tick) noexcept { *added_ += passive_(hand_->world_from_hand.translation, *wanted_, tick.dt); }

  DuraScene scene_;
  ElasticSheet whole_, sheet_;
  PassiveForce passive_;
  Stage* stage_;
  Voxmap* voxmap_;
  std::size_t listener_;
  std::uint64_t growth_;
  Pose bone_from_sheet_;
  Affine index_from_sheet_;
  std::vector<Vec3i> over_;         // voxels over the nodes
  std::vector<SheetCover> covers_;  // of the nodes
  DuraPicture picture_;
  Pose at_rest_;
  bool sees_bone_;  // contact reads the bone, with its pose
  bool open_ = false, ever_torn_ = false;
  double highest_ = -kBelow;           // [m] of the dura at rest
  std::vector<Vec3> points_, from_;    // [m] of the tool, sheet frame; those of the step before
  double time_ = 0.0, pressed_ = 0.0;  // [s]
  double force_ = 0.0, indentation_ = 0.0, bulge_ = 0.0, largest_bulge_ = 0.0, level_ = kDuraClear;
  double peak_ = 0.0, largest_indentation_ = 0.0, pushed_ = 0.0, strain_ = 0.0;
  std::uint64_t iterations_ = 0;
  const Cut* cut_ = nullptr;
  DuraState* dura_ = nullptr;
  const ContactState* state_ = nullptr;
  const Touch* touch_ = nullptr;
  const DuraState* seen_ = nullptr;
  Vec3* push_ = nullptr;
  const HandState* hand_ = nullptr;
  const Vec3* wanted_ = nullptr;
  Vec3* added_ = nullptr;
};

/// [m] from its axis.
double widest(const std::vector<Vec3>& points) {
  double out = 0.0;
  for (const Vec3& point : points) out = std::max(out, std::hypot(point.x, point.y));
  return out;
}

/// @returns why the rim of a sheet has nothing to be held by; empty if bone as loaded lies over enough of it, at its radius.
std::string why_not_held(const DuraScene& scene, const SheetLattice& lattice, const std::vector<double>& heights, const BoneModel& bone,
                         const Pose& bone_from_sheet) {
  const Affine index_from_sheet = bone.bone_from_index().inverse() * Affine::from_pose(bone_from_sheet);
  double reached = scene.radius;
  std::size_t rim = 0, held = 0;
  const double edge = bone.bone_from_index().mean_edge();
  for (std::size_t n = 0; n < lattice.nodes(); ++n) {
    if (!lattice.on_rim(n)) continue;
    const double x = lattice.x(n), y = lattice.y(n);
    reached = std::min(reached, std::hypot(x, y) + lattice.spacing());
    ++rim;
    bool bones = false;
    for (int k = 0; k < kVoxelsDeep; ++k)
      bones = bones || bone.occupancy(voxel_of(index_from_sheet * Vec3(x, y, heights[n] + (kVoxelsAbove + k) * edge))) >= 0.5f;
    held += bones ? 1 : 0;
  }
  if (reached < scene.radius - 1e-9)
    return fmt::format("the dura reaches only {:.3g} mm from the drilled line, so it cannot be held at radius_mm = {:g}",
                       reached / kMillimetre, scene.radius / kMillimetre);
  if (static_cast<double>(held) < kLeastHeld * static_cast<double>(rim))
    return fmt::format("bone lies over the dura at {} of {} places at radius_mm = {:g}; {:g} % of them have to hold it", held, rim,
                       scene.radius / kMillimetre, 100.0 * kLeastHeld);
  return {};
}

class DuraPlan final : public ConfigPlan<DuraPlan, DuraScene> {
 public:
  explicit DuraPlan(TableReader& table) {
    DuraScene& c = config_;
    SheetConfig& s = c.sheet;
    constexpr double kMega = 1e6, kKilo = 1e3;
    c.place = table.place();
    c.radius_place = table.place_of("radius_mm");
    c.radius = table.number("radius_mm", above_zero(c.radius / kMillimetre, kMillimetre, 100.0),
                            "distance from the drilled line at which the dura is held");
    c.spacing = table.number("spacing_mm", {.fallback = c.spacing / kMillimetre, .min = 0.1, .max = 20.0, .to_si = kMillimetre},
                             "distance between nodes of the dura");
    if (c.radius < 3.0 * c.spacing) table.fault("spacing_mm", "must be at most a third of radius_mm");
    s.modulus = table.number("modulus_MPa", above_zero(s.modulus / kMega, kMega, 1e4), "Young's modulus of dura; 70 +- 44 in print");
    s.thickness = table.number("thickness_mm", above_zero(s.thickness / kMillimetre, kMillimetre, 5.0), "thickness of dura; 0.3 to 0.8");
    s.strain_limit = table.number("strain_limit", above_zero(s.strain_limit, 1.0, 10.0), "strain at which it tears; 0.11 +- 0.03 in print");
    s.support = table.number("support_kPa_per_mm", at_least_zero(s.support / 1e6, 1e6, 100.0),
                             "pressure of the brain below per displacement (an assumption)");
    s.resistance = table.number("resistance_kPa_s_per_mm", above_zero(s.resistance / 1e6, 1e6, 100.0),
                                "pressure per speed of what is moved aside (an assumption)");
    s.adhesion = table.number("adhesion_kPa", at_least_zero(s.adhesion / kKilo, kKilo, 1e4),
                              "strength of the bond of dura and bone (an assumption)");
    s.adhesion_way = table.number("adhesion_mm", above_zero(s.adhesion_way / kMillimetre, kMillimetre, 5.0),
                                  "displacement at which that bond breaks (an assumption)");
    s.tension = table.number("tension", at_least_zero(s.tension, 1.0, 0.1), "strain of the dura at rest");
    if (s.tension >= s.strain_limit) table.fault("tension", "must be below strain_limit");
    c.pulse = table.number("pulse_Pa", at_least_zero(c.pulse, 1.0, 1e5),
                           "pressure of the brain's pulse on the dura, from its least to its largest (an assumption)");
    c.pulse_rate = table.number("pulse_hz", above_zero(c.pulse_rate, 1.0, 10.0), "rate of that pulse (an assumption)");
    c.largest_force =
        table.number("largest_N", above_zero(c.largest_force, 1.0, 1e3), "largest force of the dura on the hand (an assumption)");
    read_passive_limit(table, "the dura", c.limit);
  }

  PlanRow row(const PlanContext& context) const override {
    const double across = config_.radius / config_.spacing;
    const auto nodes = static_cast<std::uint64_t>(3.63 * across * across);
    return {.table = "dura",
            .clock = Clock::simulation,
            .step = "sheet of dura under the hole, and its force on the tool",
            .needs = "cut, density under the hole",
            .gives = "added force",
            .detail = fmt::format("about {} nodes, {:g} mm apart, {:g} MPa, {:g} mm thick", nodes, config_.spacing / kMillimetre,
                                  config_.sheet.modulus * 1e-6, config_.sheet.thickness / kMillimetre),
            .rate_hz = static_cast<double>(context.needs.simulation_hz),
            .bytes = sizeof(DuraEffect) + nodes * (2 * kNodeBytes + kPictureBytes)};
  }
  std::string setting() const override { return fmt::format("dura of {:g} MPa", config_.sheet.modulus * 1e-6); }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    const Approach& approach = stage.approach;
    const Pose bone_from_sheet{approach.bone_from_approach.rotation, approach.bone_from_approach * Vec3(0.0, 0.0, -approach.thickness)};
    const DuraTop top(stage.voxmap->bone(), bone_from_sheet, config_.radius);
    const auto refuse = [this](const std::string& why) { return Error{ErrorCode::bad_input, "[dura] " + why, config_.place}; };
    const auto refuse_radius = [this](const std::string& why) {
      return Error{ErrorCode::bad_input, "[dura] " + why, config_.radius_place};
    };
    if (const double bit = widest(stage.tool->shell.positions), least = bit + 2.0 * config_.spacing; config_.radius < least)
      return refuse_radius(
          fmt::format("radius_mm = {:g} leaves no dura around the hole of a bit of {:.3g} mm radius; must be at least {:.3g}",
                      config_.radius / kMillimetre, bit / kMillimetre, least / kMillimetre));
    if (!top.at(0.0, 0.0))
      return refuse(
          "there is no dura under the bone: no voxel with the label dura or brain lies where the approach axis leaves it; use a volume "
          "with that label, such as phantom:skull_patch, or remove the table");
    std::vector<double> heights;
    auto lattice = SheetLattice::create(config_.radius, config_.spacing, [&](double x, double y) {
      const auto height = top.at(x, y);
      if (height) heights.push_back(*height);
      return height.has_value();
    });
    if (!lattice) return refuse_radius(lattice.error().message + "; change radius_mm or spacing_mm");
    if (const std::string why = why_not_held(config_, *lattice, heights, stage.voxmap->bone(), bone_from_sheet); !why.empty())
      return refuse_radius(why);
    auto sheet = ElasticSheet::create(config_.sheet, std::move(*lattice), heights);
    if (!sheet) return refuse(sheet.error().message);
    auto passive = PassiveForce::create(config_.limit);
    if (!passive) return refuse(passive.error().message);
    return std::unique_ptr<Effect>(std::make_unique<DuraEffect>(config_, std::move(*sheet), *passive, bone_from_sheet, stage));
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<DuraPlan>(table); }

}  // namespace

EffectEntry dura_effect() {
  return {"dura",
          "the dura under the hole is indented and torn, and felt; without it nothing lies under the bone",
          read,
          {},
          {.figures = {{"indentation_mm", 0.1}, {"peak_force_N", 0.1}, {"largest_strain", 0.01}},
           .knobs = {{"spacing_mm", {2, 1, 0.6}, 0.35}, {"radius_mm", {0.8, 1}, 1.2}}}};
}

}  // namespace burrhole
