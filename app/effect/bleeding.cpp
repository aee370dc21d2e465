// [bleeding]: blood from the opened pores of the diploe. It pools in the hole, overflows, is rinsed and sucked away; wax stops it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "app/effect/gravity_key.h"
#include "app/effect/registry.h"
#include "app/stage/bleeding_state.h"
#include "app/stage/coolant.h"
#include "app/stage/instruments.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "app/view/blood_mesh.h"
#include "core/base/units.h"
#include "core/blood/blood_pool.h"
#include "core/config/rules.h"

namespace burrhole {
namespace {

constexpr const char *kBleedingTexts[] = {"stopped", "started", "stopped by wax"},
                     *kFloorTexts[] = {"seen", "hidden by blood"};  // of BleedingState
constexpr double kMillilitre = 1e-6;                                // [m^3]
constexpr double kMillilitrePerMinute = kMillilitre / 60.0;         // [m^3/s]
constexpr double kLeastFlow = 0.01 * kMillilitrePerMinute;          // below which it has stopped
constexpr double kBeyond = 2e-3;                                    // [m] beyond the ends of the drilled line, in which bone is read
const Vec3 kTiny(0.0, 0.0, -1e-30);                                 // [m] so that a line without a length has a direction

constexpr double kWetFilm = 1e-3;                       // [m] of blood on the opened pores that is drawn as full beads
constexpr double kSeenLevel = 1e-5, kSeenShare = 0.02;  // [m], [-] changes that are drawn

// Of a voxel: BloodPicture, and while its mesh is made the density, what is gone, and the pores under a film.
constexpr std::uint64_t kPictureBytes = sizeof(float) + sizeof(std::uint16_t) + 1 + 3 * sizeof(float);

enum class Wax { none, after, drilled, by_switch };

struct BleedingScene {
  BloodConfig blood{};
  double solid = 0.6;  ///< [-] hardness from which bone has no open pores (an assumption)
  Wax wax = Wax::none;
  double wax_time = 5.0;    ///< [s] (an assumption)
  double wax_depth = 5e-4;  ///< [m] (an assumption)
  bool sucks_by_switch = false;
  double hide = 3e-4;          ///< [m] (an assumption)
  double reach = 10e-3;        ///< [m]
  std::optional<Vec3> down{};  ///< [-] world frame
};

class BleedingEffect final : public Effect, public PictureSource {
 public:
  BleedingEffect(const BleedingScene& scene, BloodSite site, Stage& stage)
      : scene_(scene),
        site_(std::move(site)),
        pool_(scene.blood),
        voxmap_(stage.voxmap.get()),
        listener_(voxmap_->add_listener()),
        growth_(voxmap_->growth_epoch()),
        bone_from_index_(voxmap_->bone().bone_from_index()),
        approach_from_bone_(stage.approach.bone_from_approach.inverse()),
        thickness_(stage.approach.thickness) {
    density_.resize(site_.box().grown(1).count());
    read_bone(site_.box());
  }

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "bleeding", "bleeding", [](void* self, const Tick& tick) { static_cast<BleedingEffect*>(self)->run(tick); },
        this);
    cut_ = step.now(slots::kCut);
    removal_ = step.now_if_written(slots::kRemoval);
    coolant_ = step.now_if_written(slots::kCoolant);
    if (scene_.sucks_by_switch || scene_.wax == Wax::by_switch) hand_ = step.latest(slots::kHand);
    state_ = step.own(slots::kBleeding);
    step.column("blood_flow", "m3/s", &flow_);
    step.column("blood_bled", "m3", &bled_);
    step.column("blood_in_hole", "m3", &in_hole_);
    step.column("blood_level", "m", &level_);
    auto publish = graph.step(
        Clock::contact, "bleeding", "bleeding seen", [](void* self, const Tick&) { static_cast<BleedingEffect*>(self)->publish(); }, this);
    seen_ = publish.latest(slots::kBleeding);
    publish.column("bleeding", {"bleeding", kBleedingTexts}, &seen_level_);
    publish.column("floor_hidden", {"floor", kFloorTexts}, &seen_hidden_);
    return {};
  }
  /// Bone that comes back closes its pores and takes the wax away; blood for which the hole has no room overflows in the next step.
  void place(const Pose&) noexcept override {
    if (voxmap_->growth_epoch() == growth_) return;
    growth_ = voxmap_->growth_epoch();
    site_.unwax(time_, scene_.blood.coagulation);
    read_bone(voxmap_->take_dirty(listener_));
  }
  void report(Figures& out) const override {
    const BloodVolumes& v = pool_.volumes();
    out.add("bled_ml", v.bled / kMillilitre);
    out.add("pooled_ml", v.hole / kMillilitre);
    out.add("film_ml", v.film / kMillilitre);
    out.add("rinsed_ml", v.rinsed / kMillilitre);
    out.add("sucked_ml", v.sucked / kMillilitre);
    out.add("overflowed_ml", v.overflowed / kMillilitre);
    out.add("balance_error", v.bled > 0.0 ? std::abs(v.missing()) / v.bled : 0.0);
    out.add("saline_in_hole_ml", v.saline / kMillilitre);
    out.add("flow_ml_per_min", flow_ / kMillilitrePerMinute);
    out.add("peak_ml_per_min", peak_ / kMillilitrePerMinute);
    out.add("level_mm", level_ / kMillimetre);
    out.add("highest_level_mm", highest_ / kMillimetre);
    out.add("hole_ml", site_.capacity() / kMillilitre);
    out.add("cut_spongy_mm2", site_.cut_spongy() * 1e6);
    out.add("opened_pores_mm2", site_.open_pores() * 1e6);
    out.add("waxed_pores_mm2", site_.waxed_pores() * 1e6);
    out.add("bleeding_s", bleeding_);
    out.add("floor_hidden_s", hidden_);
    out.add("waxings", waxings_);
  }
  void warn(std::vector<std::string>& out) const override {
    if (!site_.has_pores())
      out.push_back(
          fmt::format("[bleeding] within {:g} mm of the drilled line there is no spongy bone (hardness below {:g}, no table): "
                      "nothing bleeds",
                      scene_.reach / kMillimetre, scene_.solid));
    else if (hidden_ > 0.0)
      out.push_back(fmt::format("[bleeding] blood hid the floor of the hole for {:.1f} s; {:.2g} ml bled", hidden_,
                                pool_.volumes().bled / kMillilitre));
  }
  PictureSource* picture_source() noexcept override { return this; }
  bool copy_for_picture(bool exactly) override {
    const BloodVolumes& v = pool_.volumes();
    const double blood = v.hole > 0.0 ? v.hole / v.in_hole() : 0.0;
    const double pores = site_.open_pores() + site_.waxed_pores();
    const double wetness = pores > 0.0 ? std::min(1.0, v.film / (pores * kWetFilm)) : 0.0;
    const double seen_level = exactly ? 0.0 : kSeenLevel, seen_share = exactly ? 0.0 : kSeenShare;
    const bool moved = std::abs(pool_.level() - picture_.level) > seen_level || std::abs(blood - picture_.blood) > seen_share ||
                       std::abs(wetness - picture_.wetness) > seen_share;
    if (!bone_moved_ && !moved) return false;
    if (bone_moved_) {
      picture_.removed.assign(site_.removed().begin(), site_.removed().end());
      picture_.pore_area.assign(site_.pore_area().begin(), site_.pore_area().end());
      picture_.waxed.assign(site_.waxed().begin(), site_.waxed().end());
    }
    bone_moved_ = false;
    picture_.level = pool_.level();
    picture_.blood = blood;
    picture_.wetness = wetness;
    picture_.hide = scene_.hide;
    return true;
  }
  void append_mesh(AddedMesh& out) const override { append_blood(site_.bone(), picture_, out); }

 private:
  void run(const Tick& tick) noexcept {
    read_bone(voxmap_->take_dirty(listener_));
    wax(tick.dt);
    if (scene_.sucks_by_switch) pool_.set_suction(is_on(kSuctionSwitch) ? scene_.blood.suction : 0.0);
    pool_.step(site_, saline(), tick.dt);
    time_ += tick.dt;
    const BloodVolumes& v = pool_.volumes();
    flow_ = pool_.flow();
    bled_ = v.bled;
    in_hole_ = v.hole;
    level_ = pool_.level() - site_.floor();
    peak_ = std::max(peak_, flow_);
    highest_ = std::max(highest_, level_);
    const bool bleeds = flow_ >= kLeastFlow, hides = v.hole > 0.0 && pool_.blood_depth(site_) >= scene_.hide;
    bleeding_ += bleeds ? tick.dt : 0.0;
    hidden_ += hides ? tick.dt : 0.0;
    *state_ = {bleeds ? kBleedingStarted : site_.waxed_pores() > 0.0 ? kBleedingWaxed : kBleedingNone, hides ? 1.0 : 0.0};
  }
  [[nodiscard]] bool is_on(InstrumentSwitch instrument) const noexcept { return (hand_->switches & instrument) != 0; }
  void wax(double dt) noexcept {
    if (scene_.wax == Wax::none) return;
    if (scene_.wax == Wax::after) {
      if (waxings_ > 0 || time_ < scene_.wax_time) return;
    } else if (scene_.wax == Wax::by_switch) {
      const bool had_wax = std::exchange(has_wax_, is_on(kWaxSwitch));
      if (had_wax || !has_wax_) return;
    } else {
      idle_ = removal_->mass > 0.0 ? 0.0 : idle_ + dt;
      if (idle_ < scene_.wax_time || !(site_.open_pores() > 0.0)) return;
    }
    (void)site_.wax(scene_.wax_depth);
    bone_moved_ = true;
    ++waxings_;
  }
  /// @returns the saline [m^3/s] that flows into the hole: all of it, if the tip is near enough to the drilled line.
  [[nodiscard]] double saline() const noexcept {
    if (!(coolant_->flow > 0.0)) return 0.0;
    const Vec3 tip = approach_from_bone_ * (bone_from_index_ * cut_->path.to.offset);
    const Vec3 nearest(0.0, 0.0, std::clamp(tip.z, -thickness_, 0.0));
    return glm::length(tip - nearest) <= coolant_->reach ? coolant_->flow : 0.0;
  }
  void publish() noexcept {
    seen_level_ = seen_->level;
    seen_hidden_ = seen_->hidden;
  }
  void read_bone(const VoxelBoxes& changed) {
    for (const VoxelBox& box : changed) read_bone(box.intersect(site_.box()));
  }
  void read_bone(const VoxelBox& box) {
    if (box.empty()) return;
    bone_moved_ = true;
    const auto density = std::span(density_).first(box.grown(1).count());
    voxmap_->read_density(box.grown(1), density);
    site_.update(box, density, time_, scene_.blood.coagulation);
  }

  BleedingScene scene_;
  BloodSite site_;
  BloodPool pool_;
  Voxmap* voxmap_;
  std::size_t listener_;
  std::uint64_t growth_;
  Affine bone_from_index_;
  Pose approach_from_bone_;
  double thickness_;                // [m] of bone along the axis
  std::vector<float> density_;      // scratch
  double time_ = 0.0, idle_ = 0.0;  // [s] of bone steps; since bone was last removed
  double flow_ = 0.0, bled_ = 0.0, in_hole_ = 0.0, level_ = 0.0;
  double peak_ = 0.0, highest_ = 0.0;     // [m^3/s], [m]
  double bleeding_ = 0.0, hidden_ = 0.0;  // [s]
  std::uint64_t waxings_ = 0;
  bool has_wax_ = false;    // its switch was on in the last step
  BloodPicture picture_;    // the last copy
  bool bone_moved_ = true;  // or its wax, since that copy
  double seen_level_ = 0.0, seen_hidden_ = 0.0;
  const Cut* cut_ = nullptr;
  const BoneRemoval* removal_ = nullptr;
  const Coolant* coolant_ = nullptr;
  const HandState* hand_ = nullptr;  // null: no instrument has a switch
  BleedingState* state_ = nullptr;
  const BleedingState* seen_ = nullptr;
};

constexpr std::pair<const char*, Wax> kWaxWords[] = {
    {"none", Wax::none}, {"after", Wax::after}, {"drilled", Wax::drilled}, {"switch", Wax::by_switch}};

class BleedingPlan final : public SwitchedPlan<BleedingPlan, BleedingScene>, public RequiringPlan {
 public:
  explicit BleedingPlan(TableReader& table) {
    BleedingScene& c = config_;
    BloodConfig& b = c.blood;
    constexpr double kKilo = 1e3, kConductance = 1e-6;  // [Pa]; [m/(s Pa)] of 1 mm/(s kPa)
    b.pressure = table.number("pressure_kPa", at_least_zero(b.pressure / kKilo, kKilo, 100.0),
                              "pressure of blood in the diploe, over that outside; 1.3: 10 mmHg (an assumption)");
    b.conductance = table.number("conductance_mm_per_s_kPa", at_least_zero(b.conductance / kConductance, kConductance, 1e4),
                                 "speed of blood in an opened pore per pressure (an assumption)");
    b.coagulation = table.number("coagulation_s", above_zero(b.coagulation, 1.0, 1e6),
                                 "time constant with which an opened pore closes by itself (an assumption)");
    c.solid = table.number("solid_hardness", {.fallback = c.solid, .min = 0.0, .max = 1.0, .min_open = true},
                           "hardness from which bone has no open pores; their share grows from 0 there to 1 at hardness 0 (an assumption)");
    read_wax(table);
    b.suction = table.number("suction_ml_per_min", at_least_zero(b.suction / kMillilitrePerMinute, kMillilitrePerMinute, 1e5),
                             "what a sucker takes from the hole; 0: there is none");
    c.sucks_by_switch =
        table.boolean("suction_by_switch", false, "true: it is on only while a person switches it on: U in the window, or an input");
    if (c.sucks_by_switch && !(b.suction > 0.0)) table.fault("suction_by_switch", "needs suction_ml_per_min above 0");
    if (c.sucks_by_switch) instruments_.switches |= kSuctionSwitch;
    if (c.wax == Wax::by_switch) instruments_.switches |= kWaxSwitch;
    b.film_time = table.number("film_s", above_zero(b.film_time, 1.0, 1e4),
                               "time constant with which blood on the bone runs down into the hole (an assumption)");
    b.wash_time = table.number("wash_s", above_zero(b.wash_time, 1.0, 1e4),
                               "time constant with which saline of [irrigation] washes it there (an assumption)");
    c.hide = table.number("hide_mm", above_zero(c.hide / kMillimetre, kMillimetre, 20.0),
                          "depth of blood that hides the floor of the hole (an assumption)");
    c.reach = table.number("reach_mm", above_zero(c.reach / kMillimetre, kMillimetre, 100.0),
                           "distance from the drilled line up to which bone bleeds");
    c.down = read_down(table);
  }

  PlanRow row(const PlanContext& context) const override {
    const VoxelBox box = box_of(drilling_way(context.config, context.bone), context.bone.bone_from_index, context.bone.dims);
    const std::uint64_t voxels = box.count();
    const std::uint64_t bytes =
        sizeof(BleedingEffect) + BloodSite::bytes_of(box) + box.grown(1).count() * sizeof(float) + voxels * kPictureBytes;
    return {
        .table = "bleeding",
        .clock = Clock::simulation,
        .step = "blood from opened pores, and where it goes",
        .needs = "cut, changed boxes, coolant",
        .gives = "level of blood in the hole",
        .detail = fmt::format("{} voxels, {:g} kPa, {:g} s to coagulate", voxels, config_.blood.pressure * 1e-3, config_.blood.coagulation),
        .rate_hz = static_cast<double>(context.needs.simulation_hz),
        .bytes = bytes,
        .start_bytes = bytes + voxels * 2 * sizeof(float)};
  }
  std::vector<Requirement> requirements(const Needs& needs) const override {
    return {{.table = "erosion", .met = needs.removes, .without = "no bone is opened, so nothing bleeds"}};
  }
  std::string setting() const override {
    return fmt::format("bleeding at {:g} kPa{}", config_.blood.pressure * 1e-3, config_.wax == Wax::none ? "" : ", wax");
  }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    const BoneModel& bone = stage.voxmap->bone();
    const BoneShape shape{.dims = bone.dims(), .bone_from_index = bone.bone_from_index(), .thickness = stage.approach.thickness};
    SiteBone site{.box = box_of(drilling_way(stage.config, shape), shape.bone_from_index, shape.dims),
                  .bone_from_index = shape.bone_from_index};
    site.down = down_in_bone(stage, config_.down);
    const std::size_t count = site.box.count();
    std::vector<float> labels(count), hardness(count);
    site.whole.resize(count);
    site.start.resize(count);
    bone.read_occupancy(site.box, site.whole);
    stage.voxmap->read_start(site.box, site.start);
    bone.read_labels(site.box, labels);
    bone.read_hardness(site.box, hardness);
    site.pores.resize(count);
    site.outside.resize(count);
    const Affine approach_from_index = Affine::from_pose(stage.approach.bone_from_approach.inverse()) * shape.bone_from_index;
    for_each_voxel(site.box, [&](const Vec3i& voxel) {
      const std::size_t at = site.box.offset_of(voxel);
      const auto label = static_cast<VoxelLabel>(static_cast<int>(labels[at]));
      const bool is_bone = site.whole[at] >= 0.5f;
      const bool is_table = label == VoxelLabel::outer_table || label == VoxelLabel::inner_table;
      if (is_bone && is_felt(label) && !is_table) site.pores[at] = std::max(0.0f, 1.0f - hardness[at] / static_cast<float>(config_.solid));
      const bool soft = label == VoxelLabel::dura || label == VoxelLabel::brain;
      site.outside[at] = !is_bone && !soft && (approach_from_index * Vec3(voxel)).z > -0.5 * stage.approach.thickness ? 1 : 0;
    });
    return std::unique_ptr<Effect>(std::make_unique<BleedingEffect>(config_, BloodSite(std::move(site)), stage));
  }

 private:
  void read_wax(TableReader& table) {
    BleedingScene& c = config_;
    std::vector<std::string> words;
    for (const auto& [word, wax] : kWaxWords) words.emplace_back(word);
    const std::string word =
        table.choice("wax", words.front(), words,
                     "wax on the opened pores: none; after: once, wax_s after the start; drilled: wax_s after bone was "
                     "last removed; switch: when a person applies it: M in the window, or an input");
    c.wax = std::ranges::find(kWaxWords, word, [](const auto& one) { return std::string(one.first); })->second;
    if ((c.wax == Wax::none || c.wax == Wax::by_switch) && table.has("wax_s")) table.fault("wax_s", "needs wax = \"after\" or \"drilled\"");
    if (c.wax == Wax::none) {
      if (table.has("wax_mm")) table.fault("wax_mm", "needs wax other than \"none\"");
      return;
    }
    if (c.wax != Wax::by_switch)
      c.wax_time =
          table.number("wax_s", at_least_zero(c.wax_time, 1.0, 1e6), "time at which wax is applied; only with wax (an assumption)");
    c.wax_depth = table.number("wax_mm", {.fallback = c.wax_depth / kMillimetre, .min = 0.0, .max = 2.0, .to_si = kMillimetre},
                               "depth to which wax fills the pores: drilling deeper opens new ones; only with wax (an assumption)");
  }
  /// @returns the voxels within reach of the drilled line, and some beyond its ends, in the grid and one beside it.
  [[nodiscard]] VoxelBox box_of(const DrillingWay& way, const Affine& bone_from_index, const Vec3i& dims) const {
    const Vec3 entry = way.index_from_tool.offset, end = entry + way.along;
    Vec3 margin;
    for (int axis = 0; axis < 3; ++axis) {
      const Mat3& linear = bone_from_index.linear;
      const Vec3 across = glm::normalize(glm::cross(linear[(axis + 1) % 3], linear[(axis + 2) % 3]));  // to the planes of this index
      const double cosine = std::abs(glm::dot(across, glm::normalize(linear * way.along + kTiny)));
      margin[axis] =
          (config_.reach * std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) + kBeyond * cosine) / std::abs(glm::dot(across, linear[axis]));
    }
    const VoxelBox box =
        VoxelBox{floor_int(glm::min(entry, end) - margin), floor_int(glm::max(entry, end) + margin) + 2}.intersect({Vec3i(-1), dims + 1});
    return box.empty() ? VoxelBox{Vec3i(0), Vec3i(1)} : box;
  }
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<BleedingPlan>(table); }

}  // namespace

EffectEntry bleeding_effect() {
  return {"bleeding",
          "blood from opened diploe, its pool in the hole, wax and suction; without it bone does not bleed",
          read,
          {"wax = \"after\"", "wax = \"drilled\"", "wax = \"switch\""},
          {.figures = {{"bled_ml"}, {"opened_pores_mm2"}, {"peak_ml_per_min"}, {"floor_hidden_s", 1.0}},
           .knobs = {{"reach_mm", {0.5, 0.75, 1}, 1.5}}}};
}

}  // namespace burrhole
