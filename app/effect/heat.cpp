// [heat]: cutting warms the bone. The heat spreads in cells of some voxels round the hole; the thermal dose shows what bone dies.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "app/effect/registry.h"
#include "app/stage/coolant.h"
#include "app/stage/requirement.h"
#include "app/stage/stage.h"
#include "app/view/heat_mesh.h"
#include "core/config/rules.h"
#include "core/heat/bone_cells.h"
#include "core/heat/heat_field.h"
#include "core/heat/heat_figures.h"

namespace burrhole {
namespace {

struct HeatScene {
  HeatConfig field{};
  double specific_energy = EnergyConfig{}.specific_energy;  ///< [J/m^3] of the laws that state no work
  double share = 0.5;         ///< [-] of the work that enters the bone; the chips take the rest (an assumption)
  double reach = 0.02;        ///< [m] from the drilled line to the edge of the domain
  int cell_voxels = 2;        ///< [voxels] edge of a cell
  double damage_dose = 16.0;  ///< [min] dose that kills bone: 47 C for 1 min
  std::optional<HeatPictureConfig> picture{};
  std::string place{};
};

constexpr double kSevereDose = 64.0;     // [min] 50 C for 30 s
constexpr double kHottestVolume = 1e-9;  // [m^3] about what the bead of a thermocouple of 1 mm measures (an assumption)
constexpr double kBrainDose = 1.3;       // [min] opens the blood-brain barrier of rats
constexpr double kMostSteps = 100.0;     // [-] of conduction in a step of bone: seconds for each second of a run

class HeatEffect final : public Effect {
 public:
  HeatEffect(const HeatScene& scene, HeatField field, Stage& stage)
      : scene_(scene),
        field_(std::move(field)),
        cells_(scene.cell_voxels),
        voxmap_(stage.voxmap.get()),
        listener_(voxmap_->add_listener()),
        index_from_approach_(stage.voxmap->bone().bone_from_index().inverse() * Affine::from_pose(stage.approach.bone_from_approach)),
        depth_(stage.approach.thickness) {
    const VoxelBox& all = field_.domain();
    if (scene_.picture)
      picture_.emplace(field_, cells_, cells_.voxels_of(all), voxmap_->bone().bone_from_index(), scene_.field.body, *scene_.picture);
    for (int k = all.lo.z; k < all.hi.z; ++k)  // layer by layer: the densities of all voxels would take more memory than the field
      read_bone({Vec3i(all.lo.x, all.lo.y, k), Vec3i(all.hi.x, all.hi.y, k + 1)});
    field_.forget_losses();
  }

  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "heat", "heat", [](void* self, const Tick& tick) { static_cast<HeatEffect*>(self)->run(tick); }, this);
    removal_ = step.now_if_written(slots::kRemoval);
    cut_ = step.now(slots::kCut);
    coolant_ = step.now_if_written(slots::kCoolant);
    step.column("hottest", "C", &hottest_);
    return {};
  }
  /// Bone was brought back or taken away outside of a step: no cutting.
  void place(const Pose&) noexcept override {
    read_bone(voxmap_->take_dirty(listener_));
    field_.forget_losses();
  }
  void report(Figures& out) const override {
    const HeatBalance& b = field_.balance();
    const double in_bone = field_.in_bone();
    out.add("hottest_C", scene_.field.body + highest_);
    out.add("hottest_mm3_C", scene_.field.body + hottest_mean(field_, kHottestVolume));
    out.add("bone_at_most_C", scene_.field.body + field_.highest_peak());
    out.add("dead_bone_mm3", volume_with_dose(field_, scene_.damage_dose) * 1e9);
    out.add("dead_bone_64_mm3", volume_with_dose(field_, kSevereDose) * 1e9);
    out.add("dose_inner_face_min", inner_face_dose());
    out.add("work_J", work_);
    out.add("released_J", b.input);
    out.add("in_bone_J", in_bone);
    out.add("chips_J", b.chips);
    out.add("coolant_J", b.cooled);
    out.add("edge_J", b.edge);
    out.add("unplaced_J", b.unplaced);
    out.add("balance_error", balance_error(b, in_bone));
    out.add("cells", static_cast<std::uint64_t>(field_.domain().count()));
    out.add("steps", field_.steps());
  }
  PictureSource* picture_source() noexcept override { return picture_ ? &*picture_ : nullptr; }
  void warn(std::vector<std::string>& out) const override {
    const double dead = volume_with_dose(field_, scene_.damage_dose) * 1e9;
    if (dead > 0.0)
      out.push_back(
          fmt::format("[heat] {:.3g} mm3 of the bone that is left had a dose of {:g} min at 43 C and more, up to {:.0f} C: it dies", dead,
                      scene_.damage_dose, scene_.field.body + field_.highest_peak()));
    if (const double dose = inner_face_dose(); dose >= kBrainDose)
      out.push_back(
          fmt::format("[heat] bone at the inner face had a dose of {:.3g} min at 43 C; {:g} min opens the blood-brain barrier of rats",
                      dose, kBrainDose));
    const HeatBalance& b = field_.balance();
    if (b.edge + b.unplaced > 0.05 * b.input)
      out.push_back(fmt::format("[heat] {:.0f} % of the heat left the box in which it is computed: increase heat.reach_mm",
                                100.0 * (b.edge + b.unplaced) / b.input));
  }

  /// The highest temperature on a plane through the drilled line.
  std::vector<ValueMap> maps() const override {
    constexpr double kMm = 1e3;
    const double pitch = std::min({field_.edges().x, field_.edges().y, field_.edges().z});
    const double side = std::min(scene_.reach, kMapSide), top = -0.1 * depth_ - pitch, bottom = depth_ + kMapBelow;
    ValueMap map{
        .title = "Highest temperature of the bone that is left",
        .caption = fmt::format("Section through the drilled line. {:.3g} mm³ of the bone that is left had at least {:g} equivalent "
                               "minutes at 43 °C, which kill it. {:.3g} J were released in bone, of {:.3g} J of cutting work.",
                               volume_with_dose(field_, scene_.damage_dose) * 1e9, scene_.damage_dose, field_.balance().input, work_),
        .x_label = "Distance from the axis (mm)",
        .y_label = "Depth (mm)",
        .unit = "Temperature (°C)",
        .x = -side * kMm,
        .y = top * kMm,
        .pitch = pitch * kMm,
        .columns = static_cast<std::size_t>(2.0 * side / pitch) + 1,
        .rows = static_cast<std::size_t>((bottom - top) / pitch) + 1,
        .values = {}};
    for (std::size_t row = 0; row < map.rows; ++row)
      for (std::size_t column = 0; column < map.columns; ++column) {
        const Vec3 at(-side + pitch * static_cast<double>(column), 0.0, -(top + pitch * static_cast<double>(row)));
        const Vec3i cell = cells_.cell_of(voxel_of(index_from_approach_ * at));
        map.values.push_back(field_.share(cell) >= 0.5f ? static_cast<float>(scene_.field.body) + field_.peak(cell)
                                                        : std::numeric_limits<float>::quiet_NaN());
      }
    return {std::move(map)};
  }

 private:
  static constexpr double kMapSide = 0.014, kMapBelow = 2e-3;  // [m] from the axis; below the inner surface

  /// @returns what the sum leaves unexplained over the largest of its terms [-]: with a coolant, more can leave than was released.
  static double balance_error(const HeatBalance& b, double in_bone) noexcept {
    const double rest = std::abs(b.input - in_bone - b.chips - b.cooled - b.edge - b.unplaced);
    const double largest =
        std::max({b.input, std::abs(in_bone), std::abs(b.chips), std::abs(b.cooled), std::abs(b.edge), std::abs(b.unplaced)});
    return largest > 0.0 ? rest / largest : 0.0;
  }
  /// @returns the largest dose [min] of the inner face, below the cells with bone, next to the depth of the inner surface at
  /// the drilled line, up to kMapSide from it. The tissue below has at most that dose, since heat reaches it through the face.
  double inner_face_dose() const noexcept {
    const Vec3 up = index_from_approach_.linear[2];
    const int axis =
        std::abs(up.x) > std::abs(up.y) ? (std::abs(up.x) > std::abs(up.z) ? 0 : 2) : (std::abs(up.y) > std::abs(up.z) ? 1 : 2);
    Vec3i inwards(0);
    inwards[axis] = up[axis] > 0.0 ? 1 : -1;
    const double pitch = std::min({field_.edges().x, field_.edges().y, field_.edges().z});
    double most = 0.0;
    for (double x = -kMapSide; x <= kMapSide; x += pitch)
      for (double y = -kMapSide; y <= kMapSide; y += pitch)
        for (double z = -depth_ - kMapBelow; z <= -depth_ + 2.0 * pitch; z += 0.5 * pitch) {  // from below: the first bone is the face
          const Vec3i cell = cells_.cell_of(voxel_of(index_from_approach_ * Vec3(x, y, z)));
          if (field_.share(cell) < HeatField::kLeastShare) continue;
          most = std::max(most, dose_at_face(field_, cell, inwards));
          break;
        }
    return most;
  }

  void run(const Tick& tick) {
    read_bone(voxmap_->take_dirty(listener_));
    if (removal_->mass > 0.0) {
      const double work = removal_->work > 0.0 ? removal_->work : scene_.specific_energy * removal_->mass;
      work_ += work;
      field_.release(scene_.share * work);
    }
    if (coolant_->flow > 0.0) {
      const Cooling cooling{.centre = cells_.place_of(cut_->path.to.offset),
                            .up = glm::normalize(cut_->path.to.linear[2] * field_.edges()),
                            .radius = coolant_->reach,
                            .film = coolant_->film,
                            .rise = coolant_->celsius - scene_.field.body,
                            .arriving = kWaterCapacity * coolant_->flow};
      field_.advance(tick.dt, &cooling);
    } else {
      field_.advance(tick.dt);
    }
    highest_ = std::max(highest_, field_.hottest());
    hottest_ = scene_.field.body + field_.hottest();
  }

  void read_bone(const VoxelBoxes& changed) {
    for (const VoxelBox& box : changed) read_bone(cells_.cells_of(box).intersect(field_.domain()));
  }
  void read_bone(const VoxelBox& cells) {
    if (cells.empty()) return;
    const VoxelBox voxels = cells_.voxels_of(cells);
    density_.resize(voxels.count());
    shares_.resize(cells.count());
    voxmap_->read_density(voxels, density_);
    cells_.mean(cells, density_, shares_);
    field_.set_bone(cells, shares_);
    if (picture_) picture_->set_bone(voxels, density_);
  }

  HeatScene scene_;
  HeatField field_;
  BoneCells cells_;
  std::optional<HeatPicture> picture_;  // absent: pictures do not show the heat
  Voxmap* voxmap_;
  std::size_t listener_;
  Affine index_from_approach_;
  double depth_;                         // [m] of bone along the axis
  std::vector<float> density_, shares_;  // scratch
  double work_ = 0.0;                    // [J]
  double highest_ = 0.0;                 // [K] of all steps
  double hottest_ = 0.0;                 // [C] now
  const BoneRemoval* removal_ = nullptr;
  const Cut* cut_ = nullptr;
  const Coolant* coolant_ = nullptr;
};

class HeatPlan final : public ConfigPlan<HeatPlan, HeatScene>, public RequiringPlan {
 public:
  explicit HeatPlan(TableReader& table) {
    HeatScene& c = config_;
    c.place = table.place();
    constexpr double kMm = 1e-3, kPerCubicMillimetre = 1e9;
    c.share = table.number("share", within(c.share, 0.0, 1.0), "share of the cutting work that enters the bone; chips take the rest");
    c.specific_energy =
        table.number("specific_energy_J_per_mm3", above_zero(c.specific_energy / kPerCubicMillimetre, kPerCubicMillimetre, 1e3),
                     "work to remove 1 mm^3 of bone, with laws that state none (all but energy)");
    c.field.conductivity =
        table.number("conductivity_W_per_m_K", above_zero(c.field.conductivity, 1.0, 1e3), "conductivity of bone; 0.31 to 0.80");
    c.field.density = table.number("density_kg_per_m3", above_zero(c.field.density, 1.0, 1e5), "density of bone");
    c.field.capacity = table.number("capacity_J_per_kg_K", above_zero(c.field.capacity, 1.0, 1e5), "specific heat capacity of bone");
    c.field.body = table.number("body_C", within(c.field.body, 0.0, 60.0), "temperature of bone before the run");
    c.damage_dose = table.number("damage_dose_min", above_zero(c.damage_dose, 1.0, 1e6),
                                 "equivalent minutes at 43 C that kill bone; 16: 47 C for 1 min; 64: 50 C for 30 s");
    c.cell_voxels = static_cast<int>(table.integer("cell_voxels", c.cell_voxels, 1, 16, "edge of a cell of the temperature, in voxels"));
    c.reach =
        table.number("reach_mm", above_zero(c.reach / kMm, kMm, 200.0), "distance from the drilled line up to which heat is computed");
    c.field.fourier =
        table.number("fourier", above_zero(c.field.fourier, 1.0, 1e3),
                     "length of a step of conduction: diffusivity x time / (edge of a cell)^2; above 1/3 with a larger error");
    if (const auto picture = table.table("picture", "pictures show the heat as the colour of bone; absent: they do not"))
      read_picture(*picture);
  }
  /// As ConfigPlan, and the scale of the pictures.
  void* config(std::type_index type) noexcept override {
    if (type == typeid(ColorBar)) return bar_ ? &*bar_ : nullptr;
    return ConfigPlan::config(type);
  }

  void add_needs(const StageConfig&, Needs& needs) const override { needs.warms = true; }

  PlanRow row(const PlanContext& context) const override {
    const VoxelBox domain = domain_of(drilling_way(context.config, context.bone), context.bone.bone_from_index, context.bone.dims);
    return {
        .table = "heat",
        .clock = Clock::simulation,
        .step = "heat of cutting, conduction, thermal dose",
        .needs = "removal, changed boxes",
        .gives = "temperature, dose",
        .detail = fmt::format("{} cells of {:.3g} mm, {:g} of the work", domain.count(), context.voxel_edge() * config_.cell_voxels * 1e3,
                              config_.share),
        .rate_hz = static_cast<double>(context.needs.simulation_hz),
        .bytes = sizeof(HeatEffect) + HeatField::bytes_of(domain.count()) +
                 (config_.picture ? HeatPicture::bytes_of(domain.count(), BoneCells(config_.cell_voxels).voxels_of(domain).count()) : 0)};
  }
  std::vector<Requirement> requirements(const Needs& needs) const override {
    return {{.table = "erosion", .met = needs.removes, .without = "no bone is cut, so nothing is warmed"}};
  }
  std::string setting() const override { return fmt::format("heat, {:g} of the work into bone", config_.share); }

  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    const BoneModel& bone = stage.voxmap->bone();
    const BoneShape shape{.dims = bone.dims(), .bone_from_index = bone.bone_from_index(), .thickness = stage.approach.thickness};
    const Affine& frame = shape.bone_from_index;
    const Vec3 edges = Vec3(glm::length(frame.linear[0]), glm::length(frame.linear[1]), glm::length(frame.linear[2])) *
                       static_cast<double>(config_.cell_voxels);
    auto field = HeatField::create(config_.field, edges, domain_of(drilling_way(stage.config, shape), frame, shape.dims));
    if (!field) return field.error();
    if (const double steps = stage.bone_period / field->longest_step(); !(steps <= kMostSteps))
      return Error{ErrorCode::bad_input,
                   fmt::format("[heat] spreads so fast that a step of bone needs {:.3g} steps of conduction, at most {:g}: increase "
                               "heat.density_kg_per_m3, heat.capacity_J_per_kg_K, heat.fourier or heat.cell_voxels",
                               steps, kMostSteps),
                   config_.place};
    return std::unique_ptr<Effect>(std::make_unique<HeatEffect>(config_, std::move(field).value(), stage));
  }

 private:
  void read_picture(TableReader table) {
    HeatPictureConfig c{.damage_dose = config_.damage_dose};
    const std::string shown = table.choice("quantity", "temperature", {"temperature", "peak", "dose"},
                                           "the present temperature, the highest so far, or the thermal dose, from damage_dose_min / 16 to "
                                           "damage_dose_min x 16");
    c.quantity = shown == "dose" ? HeatQuantity::dose : shown == "peak" ? HeatQuantity::peak : HeatQuantity::temperature;
    if (c.quantity != HeatQuantity::dose) {
      c.lowest =
          table.number("lowest_C", within(c.lowest, 0.0, 1000.0), "lower end of the scale; colder bone is drawn as bone (an assumption)");
      c.highest = table.number("highest_C", within(c.highest, 0.0, 1000.0), "upper end of the scale (an assumption)");
      if (!(c.highest > c.lowest)) table.fault("highest_C", "must be above lowest_C");
    }
    table.finish();
    config_.picture = c;
    bar_ = color_bar(c);
  }
  /// @returns the cells within reach of the drilled line, inside the grid.
  [[nodiscard]] VoxelBox domain_of(const DrillingWay& way, const Affine& bone_from_index, const Vec3i& dims) const {
    const Vec3 entry = way.index_from_tool.offset, end = entry + way.along;
    const Vec3 margin = Vec3(config_.reach) / Vec3(glm::length(bone_from_index.linear[0]), glm::length(bone_from_index.linear[1]),
                                                   glm::length(bone_from_index.linear[2]));
    VoxelBox voxels{floor_int(glm::min(entry, end) - margin), floor_int(glm::max(entry, end) + margin) + 1};
    voxels = voxels.intersect({Vec3i(0), dims});
    if (voxels.empty()) voxels = {Vec3i(0), Vec3i(1)};
    return BoneCells(config_.cell_voxels).cells_of(voxels);
  }

  std::optional<ColorBar> bar_;  // of the pictures
};

std::unique_ptr<EffectPlan> read(TableReader& table, const StageConfig&, Issues&) { return std::make_unique<HeatPlan>(table); }

}  // namespace

EffectEntry heat_effect() {
  return {"heat",
          "heat of cutting, its spread and the bone that dies of it; without it there is none",
          read,
          {"[heat.picture]", "picture.quantity = \"peak\"", "picture.quantity = \"dose\""},
          {.figures = {{"in_bone_J"}, {"dead_bone_mm3", 1.0}, {"hottest_mm3_C", 1.0, HeatConfig{}.body}},
           .knobs = {{"cell_voxels", {4, 2, 1}, 0.5}, {"fourier", {4, 2, 1, 0.5}, 0.125}, {"reach_mm", {0.25, 0.5, 1}, 2}}}};
}

}  // namespace burrhole
