/// app/stage/effect.h: interface of an effect. An effect exists if, and only if, its table is in the scene.
///   A file in app/effect defines it completely: a plan (table, needs, figures before the run) and the effect (steps, figures after the
///   run). The registry has one line for it.
///   Frame  world.   Units  SI.   Errors  bad_input with the scene's place, unless stated.
///   Threads  called while no clock runs; steps as in step_graph.h.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <variant>
#include <vector>

#include "app/stage/accuracy.h"
#include "app/stage/stage_config.h"
#include "app/stage/step_graph.h"
#include "core/base/value_map.h"
#include "core/config/toml.h"
#include "core/drill/erosion_memory.h"
#include "core/tool/tool.h"
#include "core/voxel/contact_window.h"
#include "haptics/servo/loop_stability.h"

namespace burrhole {

class PictureSource;
class Stage;

/// Combined requirements of a scene's effects. The stage creates only what is required.
struct Needs {
  ServoConfig servo;                                                                        ///< the scene's; effects may restrict it
  ContactFields fields{.density = true, .gradient = false, .words = false, .records = {}};  ///< of the window's copies
  bool reads_window = false;          ///< a step reads bone on the contact clock from a copy of the window; otherwise none is published
  bool paper_grids = false;           ///< bone is read on the contact clock from the paper's sparse grids
  int contact_hz = 0;                 ///< [Hz] 0: the servo's
  int simulation_hz = 0;              ///< [Hz] 0: a quarter of the servo's
  int latency_ticks = -1;             ///< [servo ticks] -1: one contact period
  double erosion_pitch_voxels = 0.5;  ///< [voxels] between erosion points
  bool cutting_field = false;         ///< the tool's field for sub-voxel removal
  bool feels = false;                 ///< bone exerts forces on the tool
  bool any_density = false;           ///< bone of any density above 0 collides: contact.mode = "paper"; otherwise from 0.5 on
  bool holds_back = false;            ///< contact has a constrained tool (model "surface"); otherwise a penalty model, or no contact
  bool removes = false;               ///< bone is removed
  bool warms = false;                 ///< the temperature of bone is computed
  /// A step reads what a tooth cuts, slots::kChipLoad; otherwise it is not computed. An effect may set it in make() as well.
  bool chip_load = false;
  double coupling_stiffness = 0.0;  ///< [N/m] from hand to constrained tool; 0 without one
  double coupling_damping = 0.0;    ///< [N s/m] from hand to constrained tool; 0 without one
  double felt_hardness = 0.0;       ///< [-] share by which that coupling is softer on bone of hardness 0 (core/contact/felt_hardness.h)
  double cutting_stiffness = 0.0;   ///< [N/m] K_cut, thrust over engaged depth of a constrained tool; 0 without one
  double plane_reach_voxels = std::numeric_limits<double>::infinity();  ///< [voxels] largest distance at which a plane is used
  double force_scale = 1.0;                                             ///< [-] force at the grip over force in the world
  bool through_device = false;                                          ///< a device lies between hand and drill
  ForceLoop grip{};            ///< of that device: body, reading delay, velocity and gain; the rest is not set
  double position_step = 0.0;  ///< [m] in the world, quantum of the positions that the servo reads
  std::string not_live{};      ///< why the scene cannot run on threads; empty: it can
};

/// The grid of a bone model, known from file headers before the bone is read.
struct BoneShape {
  Vec3i dims{0};                ///< [voxels]
  Affine bone_from_index;       ///< [m] from index coordinates
  std::uint64_t bytes = 0;      ///< [bytes] of the bone model; an upper bound before it is read
  double thickness = 0.0;       ///< [m] of bone along the approach axis; 0: not known before the bone is read
  std::uint64_t in_memory = 0;  ///< [bytes] as `bytes`, but what a paged bone would take in memory
};

/// Input of a plan: the scene with its bone and tool, before the run.
struct PlanContext {
  const StageConfig& config;
  const Needs& needs;
  const Tool& tool;
  const BoneShape& bone;
  std::uint64_t window_voxels = 0;                                                               ///< size of the master window at the entry
  bool live = false;                                                                             ///< steps run on several threads
  [[nodiscard]] double voxel_edge() const noexcept { return bone.bone_from_index.mean_edge(); }  ///< [m]
};

/// @returns the line along which a scene drills. It starts at the entry and ends at the smaller of two depths: the stop or reach of the
/// hand, and the thickness of the bone, or the end of the grid where the thickness is not known.
[[nodiscard]] DrillingWay drilling_way(const StageConfig& config, const BoneShape& bone);

/// A line of `burrhole explain`.
struct PlanRow {
  std::string table;
  Clock clock = Clock::simulation;
  std::string step;               ///< description of the computation, one line
  std::string needs, gives;       ///< grids and slots that it reads and writes
  std::string detail;             ///< figures of the settings, one line
  double rate_hz = 0.0;           ///< [Hz] 0: runs at events only
  std::uint64_t bytes = 0;        ///< predicted memory of the effect
  std::uint64_t start_bytes = 0;  ///< [bytes] predicted while the effect is made, before the window exists; 0: not above `bytes`
};

/// Figures of a run: a name that includes the unit, and a number or a text.
class Figures {
 public:
  using Value = std::variant<double, std::uint64_t, bool, std::string>;
  void add(std::string name, Value value) { rows_.emplace_back(std::move(name), std::move(value)); }
  [[nodiscard]] const std::vector<std::pair<std::string, Value>>& rows() const noexcept { return rows_; }

 private:
  std::vector<std::pair<std::string, Value>> rows_;
};

/// A timer of an effect in addition to those of its steps.
struct NamedTimer {
  std::string name;
  const StepTimer* timer = nullptr;
  bool within_step = false;  ///< its time is included in that of a step
};

class Effect {
 public:
  virtual ~Effect() = default;
  /// Declares steps, slot uses and columns. Called at the start and after a tool change, while no clock runs. May allocate.
  [[nodiscard]] virtual Status bind(StepGraph& graph) = 0;
  /// Sets the tool's pose (world from tool) without contact: at the start, after a tool change, and when bone was restored (undo, reset,
  /// checkpoint). Anything that an effect has stored about the bone round the tool is invalid then.
  virtual void place(const Pose&) noexcept {}
  /// Adds figures of the run for summary.json, explain --measure and the report.
  virtual void report(Figures&) const {}
  /// @returns sections for the report of a run that has ended.
  [[nodiscard]] virtual std::vector<ValueMap> maps() const { return {}; }
  /// Adds warnings of a run that has ended, one line each.
  virtual void warn(std::vector<std::string>&) const {}
  /// @returns timers in addition to those of its steps.
  [[nodiscard]] virtual std::vector<NamedTimer> timers() const { return {}; }
  /// @returns what the effect adds to pictures (app/view/added_mesh.h); null: nothing. Called once, after all effects are made.
  [[nodiscard]] virtual PictureSource* picture_source() noexcept { return nullptr; }
  /// Prepares for the stage's new tool; bind() is called afterwards.
  [[nodiscard]] virtual Status change_tool(Stage&) { return {}; }
};

class EffectPlan {
 public:
  virtual ~EffectPlan() = default;
  [[nodiscard]] virtual std::unique_ptr<EffectPlan> clone() const = 0;
  /// @returns the plan's config struct of a type; null if it has none of that type. For tools and tests that vary a scene.
  [[nodiscard]] virtual void* config(std::type_index) noexcept { return nullptr; }
  /// Adds the effect's requirements. Called in the order of the registry.
  virtual void add_needs(const StageConfig&, Needs&) const {}
  [[nodiscard]] virtual PlanRow row(const PlanContext& context) const = 0;
  virtual void warn(const PlanContext&, std::vector<std::string>&) const {}
  /// @returns a text for the report's line of settings; may be empty.
  [[nodiscard]] virtual std::string setting() const { return {}; }
  /// Creates the effect. Errors include the scene's place if there is one.
  [[nodiscard]] virtual Result<std::unique_ptr<Effect>> make(Stage& stage) const = 0;
};

/// Base of a plan that consists of one config struct.
template <class Self, class Config>
class ConfigPlan : public EffectPlan {
 public:
  [[nodiscard]] std::unique_ptr<EffectPlan> clone() const override { return std::make_unique<Self>(static_cast<const Self&>(*this)); }
  [[nodiscard]] void* config(std::type_index type) noexcept override { return type == typeid(Config) ? &config_ : nullptr; }

 protected:
  Config config_;
};

/// A line of the registry.
struct EffectEntry {
  const char* table;
  const char* about;
  std::unique_ptr<EffectPlan> (*read)(TableReader& table, const StageConfig& stage, Issues& issues);
  /// For the generated reference of scene files: texts of the table (TOML without the header line) that together cover the branches of
  /// `read`, so that every key appears. The empty table is always one of them and need not be listed.
  std::vector<std::string> samples = {};
  EffectAccuracy accuracy = {};  ///< nothing: no figure of it depends on a step or a grid of its own
};
/// Its order determines the order of plans, of sums, and of steps that do not depend on each other.
using EffectRegistry = std::vector<EffectEntry>;

/// The effects of one scene, in the order of the registry. A value: copies are deep.
class EffectPlans {
 public:
  EffectPlans() = default;
  EffectPlans(const EffectPlans& other) { *this = other; }
  EffectPlans(EffectPlans&&) noexcept = default;
  EffectPlans& operator=(const EffectPlans& other);
  EffectPlans& operator=(EffectPlans&&) noexcept = default;

  struct Item {
    std::string table;
    std::unique_ptr<EffectPlan> plan;
  };
  void add(std::string table, std::unique_ptr<EffectPlan> plan) { items_.push_back({std::move(table), std::move(plan)}); }
  /// @returns whether the effect was present.
  bool remove(std::string_view table);
  [[nodiscard]] const std::vector<Item>& items() const noexcept { return items_; }
  [[nodiscard]] bool has(std::string_view table) const noexcept;
  /// @returns the config struct of a type, of the first effect that has one; null if there is none.
  template <class Config>
  [[nodiscard]] Config* find() noexcept {
    for (Item& item : items_)
      if (void* config = item.plan->config(typeid(Config))) return static_cast<Config*>(config);
    return nullptr;
  }
  template <class Config>
  [[nodiscard]] const Config* find() const noexcept {
    return const_cast<EffectPlans*>(this)->find<Config>();
  }
  /// @returns the combined requirements of all effects.
  [[nodiscard]] Needs needs(const StageConfig& config) const;

 private:
  std::vector<Item> items_;
};

/// Reads an integer key of a rate [Hz]. Pushes an issue unless it divides the servo rate.
[[nodiscard]] int read_rate(TableReader& table, const StageConfig& stage, int fallback, int least, const char* about);

}  // namespace burrhole
