#include "app/bench/step_recorder.h"

#include <atomic>
#include <utility>

#include "app/bench/bench_scene.h"

namespace burrhole {
namespace {

/// What the effect records, and when it ends the run.
struct Recording {
  RecordedSteps* out = nullptr;
  std::size_t steps = 0;
  std::atomic<bool> stop = false;
  bool complete = false;
  Status status{};
};

/// Runs before erosion on the simulation clock, and changes nothing.
class RecorderEffect final : public Effect {
 public:
  RecorderEffect(Stage& stage, Recording& to) : stage_(&stage), to_(&to) {}
  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        Clock::simulation, "recorder", "recorder", [](void* self, const Tick& tick) { static_cast<RecorderEffect*>(self)->run(tick); },
        this);
    cut_ = step.now(slots::kCut);
    spin_ = step.last(slots::kSpin);
    (void)step.last(slots::kRemoval);
    return {};
  }

 private:
  void run(const Tick& tick) {
    RecordedSteps& out = *to_->out;
    if (to_->stop || (out.inputs.empty() && stage_->contact->progress().depth < 0.5 * stage_->approach.thickness)) return;
    const MasterWindow& window = stage_->voxmap->window();
    if (out.inputs.size() == to_->steps) {
      out.after_box = window.box;
      out.after = window.remaining;
      to_->stop = to_->complete = true;
      return;
    }
    if (out.inputs.empty()) {
      auto copy = copy_of_bone(out.loaded->bone, *stage_->voxmap, window.box);
      if (!copy) {
        to_->status = copy.error();
        to_->stop = true;
        return;
      }
      out.before = std::make_unique<Voxmap>(std::move(copy).value());
    }
    out.inputs.push_back({*cut_, *spin_, tick.dt});
    out.window = out.window.unite(window.box);
  }

  Stage* stage_;
  Recording* to_;
  const Cut* cut_ = nullptr;
  const double* spin_ = nullptr;  // [rev/s]
};

class RecorderPlan final : public ConfigPlan<RecorderPlan, Recording*> {
 public:
  explicit RecorderPlan(Recording& to) { config_ = &to; }
  PlanRow row(const PlanContext&) const override { return {.table = "recorder", .step = "", .needs = "", .gives = "", .detail = ""}; }
  Result<std::unique_ptr<Effect>> make(Stage& stage) const override {
    return std::unique_ptr<Effect>(std::make_unique<RecorderEffect>(stage, *config_));
  }
};

}  // namespace

Result<RecordedSteps> record_bone_steps(const std::string& tool, std::size_t steps, bool quick) {
  std::vector<std::string> sets{"tool.name=" + tool};
  if (quick) sets.emplace_back("tool.erosion_scale=10");
  auto loaded = load_parietal_scene(sets);
  if (!loaded) return loaded.error();
  RecordedSteps out;
  out.loaded = std::move(loaded).value();
  Recording recording{.out = &out, .steps = steps};
  Scene scene = out.loaded->scene;
  scene.effects.add("recorder", std::make_unique<RecorderPlan>(recording));
  SimulationOptions options;
  options.stop = &recording.stop;
  Issues issues;
  const auto simulation = Simulation::create(scene, out.loaded->bone, out.loaded->tool, options, issues);
  if (!simulation) return issues.front();
  if (Status run = simulation->run(); !run) return run.error();
  if (!recording.status) return recording.status.error();
  if (!recording.complete) return Error{ErrorCode::internal, tool + ": the run ended before the last step was recorded", {}};
  return out;
}

Result<Voxmap> copy_of_bone(const std::shared_ptr<const BoneModel>& model, Voxmap& bone, const VoxelBox& window) {
  auto out = Voxmap::create(model, bone.config());
  if (!out) return out;
  if (Status placed = out->place_window(window); !placed) return placed.error();
  bone.write_back();
  std::vector<BlockChange> changes;
  bone.blocks().for_each_block([&](const Vec3i& block, const BlockValues& values) { changes.push_back({block, &values}); });
  out->put_blocks(changes);
  for_each_voxel(blocks_of(bone.cut().box()), [&](const Vec3i& block) {
    if (const auto* nodes = std::as_const(bone).cut().find(block)) out->cut().add(block) = *nodes;
  });
  return out;
}

}  // namespace burrhole
