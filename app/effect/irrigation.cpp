// [irrigation]: saline flows onto the bone at the tip while the drill turns. It cools the bone that [heat] warms.

#include <fmt/format.h>

#include <optional>

#include "app/effect/registry.h"
#include "app/stage/coolant.h"
#include "app/stage/instruments.h"
#include "app/stage/stage.h"
#include "app/view/saline_mesh.h"
#include "app/view/tissue_texels.h"
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
  bool drawn = false;                         ///< pictures show what is wet
};

/// @returns the voxels within reach of the drilled line.
VoxelBox voxels_near(const DrillingWay& way, const BoneShape& bone, double reach) {
  const Vec3 entry = bone.bone_from_index * way.index_from_tool.offset,
             end = bone.bone_from_index * (way.index_from_tool.offset + way.along);
  const Bounds near = bounds_under(bone.bone_from_index.inverse(), {glm::min(entry, end) - reach, glm::max(entry, end) + reach});
  return VoxelBox{floor_int(near.lo), floor_int(near.hi) + 2}.intersect({Vec3i(0), bone.dims});
}

/// What is wet, kept up to date for pictures.
class WetBone {
 public:
  WetBone(const VoxelBox& voxels, Stage& stage)
      : voxels_(voxels),
        voxmap_(stage.voxmap.get()),
        listener_(voxmap_->add_listener()),
        picture_(voxels, make_colors(voxmap_->bone(), voxels), voxmap_->bone().bone_from_index()) {
    for (int k = voxels.lo.z; k < voxels.hi.z; ++k)  // layer by layer, as the densities of all voxels would take more memory
      read({Vec3i(voxels.lo.x, voxels.lo.y, k), Vec3i(voxels.hi.x, voxels.hi.y, k + 1)});
  }
  void follow() {
    for (const VoxelBox& box : voxmap_->take_dirty(listener_)) read(box.intersect(voxels_));
  }
  void wet(const Affine& index_from_tool, double reach) noexcept {
    const Affine bone_from_tool = voxmap_->bone().bone_from_index() * index_from_tool;
    picture_.set_film({.tip = bone_from_tool.offset,
                       .up = glm::normalize(bone_from_tool.linear[2]),
                       .reach = reach,
                       .below = voxmap_->bone().bone_from_index().mean_edge()});
  }
  void dry() noexcept { picture_.set_film({}); }
  [[nodiscard]] SalinePicture& picture() noexcept { return picture_; }

 private:
  void read(const VoxelBox& box) {
    if (box.empty()) return;
    density_.resize(box.count());
    voxmap_->read_density(box, density_);
    picture_.set_bone(box, density_);
  }

  VoxelBox voxels_;
  Voxmap* voxmap_;
  std::size_t listener_;
  std::vector<float> density_;  // scratch
  SalinePicture picture_;
};

class IrrigationEffect final : public Effect {
 public:
  /// @param voxels in which pictures show what is wet; empty: nowhere.
  IrrigationEffect(const IrrigationConfig& config, const VoxelBox& voxels, Stage& stage) : config_(config) {
    if (!voxels.empty()) wet_.emplace(voxels, stage);
  }

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "irrigation", "irrigation",
        [](void* self, const Tick& tick) { static_cast<IrrigationEffect*>(self)->run(tick); }, this);
    asked_ = step.now(slots::kSpinAsked);
    if (config_.by_switch) hand_ = step.latest(slots::kHand);
    coolant_ = step.own(slots::kCoolant);
    if (wet_) cut_ = step.now(slots::kCut);
    return {};
  }
  /// Bone was brought back or taken away outside of a step.
  void place(const Pose&) noexcept override {
    if (wet_) wet_->follow();
  }
  PictureSource* picture_source() noexcept override { return wet_ ? &wet_->picture() : nullptr; }
  void report(Figures& out) const override {
    out.add("delivered_ml", delivered_ * 1e6);
    out.add("on_s", on_);
  }

 private:
  void run(const Tick& tick) {
    const bool flows = hand_ != nullptr ? (hand_->switches & kIrrigationSwitch) != 0 : config_.always || *asked_ > 0.0;
    *coolant_ = {flows ? config_.flow : 0.0, config_.celsius, config_.film, config_.reach};
    if (wet_) {
      wet_->follow();
      flows ? wet_->wet(cut_->path.to, config_.reach) : wet_->dry();
    }
    if (!flows) return;
    on_ += tick.dt;
    delivered_ += config_.flow * tick.dt;
  }

  IrrigationConfig config_;
  double delivered_ = 0.0, on_ = 0.0;  // [m^3], [s]
  const double* asked_ = nullptr;      // [rev/s]
  const HandState* hand_ = nullptr;    // null: it has no switch
  Coolant* coolant_ = nullptr;
  const Cut* cut_ = nullptr;  // null unless it is drawn
  std::optional<WetBone> wet_;
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
    c.drawn =
        table.boolean("drawn", c.drawn, "true: pictures show bone within reach_mm of the tip, and not below it, as wet while saline flows");
  }

  PlanRow row(const PlanContext& context) const override {
    return {.table = "irrigation",
            .clock = Clock::simulation,
            .step = "flow of saline",
            .needs = "spin",
            .gives = "coolant",
            .detail = fmt::format("{:g} ml/min at {:g} C", config_.flow / kMillilitrePerMinute, config_.celsius),
            .rate_hz = static_cast<double>(context.needs.simulation_hz),
            .bytes = sizeof(IrrigationEffect) + SalinePicture::bytes_of(voxels_of(context.config, context.bone).count())};
  }
  void warn(const PlanContext& context, std::vector<std::string>& out) const override {
    if (!context.needs.warms) out.push_back("[irrigation] without [heat] it cools nothing; with [dust] it rinses chips");
  }
  std::string setting() const override { return fmt::format("irrigation {:g} ml/min", config_.flow / kMillilitrePerMinute); }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    const BoneModel& bone = stage.voxmap->bone();
    const BoneShape shape{.dims = bone.dims(), .bone_from_index = bone.bone_from_index(), .thickness = stage.approach.thickness};
    return std::unique_ptr<Effect>(std::make_unique<IrrigationEffect>(config_, voxels_of(stage.config, shape), stage));
  }

 private:
  [[nodiscard]] VoxelBox voxels_of(const StageConfig& config, const BoneShape& bone) const {
    return config_.drawn ? voxels_near(drilling_way(config, bone), bone, config_.reach) : VoxelBox{};
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<IrrigationPlan>(table); }

}  // namespace

EffectEntry irrigation_effect() { return {"irrigation", "saline that cools the bone at the tip; without it there is none", read}; }

}  // namespace burrhole
