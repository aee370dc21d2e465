#include "app/bench/bench_scene.h"

#include "core/tool/make_tool.h"

namespace burrhole {
namespace {

const std::string kScene = BH_APP_DIR "/scenes/parietal.toml";
const std::string kTools = BH_APP_DIR "/tools";
constexpr double kShippedVoxel = 0.25e-3;  // [m] of the scene

Error first_of(const Issues& issues) { return issues.empty() ? Error{ErrorCode::internal, "no reason was given", {}} : issues.front(); }

Result<std::unique_ptr<LoadedScene>> load_document(const TomlDocument& document) {
  Issues issues;
  auto loaded = load_scene(document, {.tool_folders = {kTools}}, issues);
  if (!loaded) return first_of(issues);
  return std::make_unique<LoadedScene>(std::move(*loaded));
}

}  // namespace

Result<std::unique_ptr<LoadedScene>> load_parietal_scene(const std::vector<std::string>& overrides) {
  auto document = TomlDocument::load(kScene);
  if (!document) return document.error();
  for (const std::string& assignment : overrides)
    if (Status set = document->set(assignment); !set) return set.error();
  // Not every bit has a clutch, and rows of earlier versions are without one.
  if (Status unset = document->unset("clutch"); !unset) return unset.error();
  return load_document(*document);
}

Result<std::unique_ptr<LoadedScene>> load_scene_text(const std::string& text, const std::string& name) {
  auto document = TomlDocument::parse(text, name);
  if (!document) return document.error();
  return load_document(*document);
}

Result<Tool> load_shipped_tool(const std::string& name, double erosion_pitch) {
  Issues issues;
  auto tool = load_tool(kTools + "/" + name + ".toml", {.erosion_pitch = erosion_pitch, .cutting_voxel = kShippedVoxel}, issues);
  if (!tool) return first_of(issues);
  return std::move(*tool);
}

Result<DrilledScene> drill_parietal_half_way(bool quick) {
  auto loaded = load_parietal_scene(quick ? std::vector<std::string>{"tool.erosion_scale=10"} : std::vector<std::string>{});
  if (!loaded) return loaded.error();
  DrilledScene out;
  out.loaded = std::move(loaded).value();
  const Scene& scene = out.loaded->scene;
  auto approach = make_approach(*out.loaded->bone, scene.approach);
  if (!approach) return approach.error();
  auto hand = SimulatedHand::create(
      hand_config(scene, scene.effects.needs(scene), out.loaded->tool, out.loaded->bone->bone_from_index().mean_edge()),
      scene.volume.world_from_bone * approach->bone_from_approach, 1.0 / scene.servo_hz);
  if (!hand) return hand.error();
  out.hand = std::make_unique<RecordingHand>(std::move(hand).value());

  out.stop = std::make_unique<std::atomic<bool>>(false);
  const double half = 0.5 * approach->thickness;
  SimulationOptions options;
  options.hand = out.hand.get();
  options.stop = out.stop.get();
  options.progress = [stop = out.stop.get(), half](double, const DrillProgress& progress) { *stop = progress.depth >= half; };
  Issues issues;
  out.simulation = Simulation::create(scene, out.loaded->bone, out.loaded->tool, options, issues);
  if (!out.simulation) return first_of(issues);
  if (Status run = out.simulation->run(); !run) return run.error();
  if (out.simulation->end() != RunEnd::stopped) return Error{ErrorCode::internal, "the shipped scene was not drilled half way", kScene};
  return out;
}

}  // namespace burrhole
