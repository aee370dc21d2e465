#include "app/job/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/view/assumed_brain.h"
#include "app/view/display_config.h"
#include "core/base/units.h"
#include "core/measure/approach.h"
#include "core/tool/buried_cutters.h"
#include "core/tool/finest_feature.h"
#include "core/tool/make_tool.h"
#include "core/tool/mesh_spec.h"
#include "haptics/servo/realtime.h"
#include "volumes/read/mesh_file.h"

namespace burrhole {
namespace {

PlanRow volume_row(const LoadedScene& loaded, std::uint64_t window) {
  const Vec3i d = loaded.bone->dims();
  const auto file = loaded.bone->file_bytes();
  return {.table = "volume",
          .clock = Clock::simulation,
          .step = "master window: slide, write back",
          .needs = "bone model",
          .gives = "window, bone grids",
          .detail = fmt::format("{} x {} x {} voxels of {:.3g} mm{}", d.x, d.y, d.z, 1e3 * loaded.bone->bone_from_index().mean_edge(),
                                file ? fmt::format(", as loaded in a file of {:.1f} MB", static_cast<double>(*file) * 1e-6) : ""),
          .bytes = volume_bytes(shape_of(*loaded.bone, loaded.scene.approach), window)};
}

/// The row of publishing; nothing in a scene in which no step reads a copy of bone.
std::optional<PlanRow> publish_row(const PlanContext& context) {
  const Needs& needs = context.needs;
  if (!needs.reads_window && !needs.paper_grids) return std::nullopt;
  return PlanRow{.table = "publish",
                 .clock = Clock::simulation,
                 .step = needs.paper_grids ? "the paper's grids follow the changed boxes"
                         : context.live    ? "changed boxes to one of three window copies"
                                           : "changed boxes to the window copy",
                 .needs = "window, changed boxes",
                 .gives = needs.paper_grids ? "density and gradient grids" : "window copy",
                 .detail = needs.paper_grids ? std::string("the whole bone")
                                             : fmt::format("{} voxels of {} bytes{}", context.window_voxels, bytes_a_voxel(needs.fields),
                                                           needs.fields.triangles != nullptr ? ", mesh of the surface in them" : ""),
                 .rate_hz = needs.simulation_hz > 0 ? static_cast<double>(needs.simulation_hz) : 0.25 * context.config.servo_hz,
                 .bytes = publish_bytes(context)};
}

PlanRow hand_row(const LoadedScene& loaded) {
  const HandConfig& hand = loaded.scene.hand;
  const auto detail = [&] {
    if (const auto& feed = loaded.scene.feed_hand)
      return fmt::format("{}, stop at {:.3g} mm",
                         feed->push ? fmt::format("{:.0f} N", *feed->push) : fmt::format("{:.3g} mm/s", 1e3 * feed->feed),
                         1e3 * feed->stop);
    if (loaded.scene.goal_hand)
      return fmt::format("a user, at most {:.0f} N, {:.2f} kg, {:.0f} N/m", hand.push, hand.dynamics.mass, hand.dynamics.stiffness);
    return fmt::format("{:.0f} N, {:.2f} kg, {:.0f} N/m", hand.push, hand.dynamics.mass, hand.dynamics.stiffness);
  };
  return {.table = "hand",
          .clock = Clock::servo,
          .step = "hand motion, integrated exactly over a tick under the latest force",
          .needs = "contact state",
          .gives = "hand motion",
          .detail = detail(),
          .rate_hz = static_cast<double>(loaded.scene.servo_hz)};
}

/// Names what is repaired in the mesh of a tool.
void warn_of_repair(const ToolText& tool, std::vector<std::string>& out) {
  const auto document = TomlDocument::parse(tool.text, tool.name);
  if (!document) return;
  if (const std::string repair = find_tool_repair(*document, {.read_mesh = read_mesh}); !repair.empty())
    out.push_back(fmt::format("tool \"{}\": {}", tool.name, repair));
}

/// Warns of cutting regions that meet no bone.
void warn_of_buried(const ToolText& tool, std::vector<std::string>& out) {
  Issues ignored;
  const auto document = TomlDocument::parse(tool.text, tool.name);
  if (!document || has_tool_mesh(*document)) return;
  const auto spec = read_tool_spec(*document, ignored);
  if (!spec) return;
  for (const BuriedCutter& cutter : find_buried_cutters(*spec))
    out.push_back(fmt::format("tool \"{}\": {}", tool.name, buried_text(cutter)));
}

/// Warns of a bit whose finest cutting feature the voxels do not resolve: under two voxels, an edge is rounded as far as it is thick.
void warn_of_features(const LoadedScene& loaded, const ToolText& tool, std::vector<std::string>& out) {
  constexpr double kLeastVoxels = 2.0;
  if (!loaded.scene.effects.needs(loaded.scene).removes) return;
  Issues ignored;
  const auto document = TomlDocument::parse(tool.text, tool.name);
  if (!document || has_tool_mesh(*document)) return;
  const auto spec = read_tool_spec(*document, ignored);
  const auto feature = spec ? finest_cutting_feature(*spec) : std::nullopt;
  const double edge = loaded.bone->bone_from_index().mean_edge();
  if (!feature || feature->thickness >= kLeastVoxels * edge * (1.0 - 1e-9)) return;
  // Rounded down to two digits, so that the spacing named here gives no warning.
  const double fits = feature->thickness / kLeastVoxels / kMillimetre, unit = std::pow(10.0, std::floor(std::log10(fits)) - 1.0);
  out.push_back(
      fmt::format("{}: voxels of {:.3g} mm do not resolve \"{}\": the {} of its region \"{}\", {:.3g} mm, is under two voxels; set "
                  "volume.spacing_mm to {:.3g} or less",
                  loaded.scene.volume.spacing_place, edge / kMillimetre, tool.name, feature->kind, feature->region,
                  feature->thickness / kMillimetre, std::floor(fits / unit * (1.0 + 1e-9)) * unit));
}

/// @returns a warning where pictures show dura and brain under bone that does not close round the site as a skull does.
std::optional<std::string> assumed_layers_warning(const LoadedScene& loaded) {
  const auto* display = loaded.scene.find<DisplayConfig>();
  if (display == nullptr || !display->assumed_brain || !loaded.import) return std::nullopt;
  const auto& enclosure = loaded.import->enclosure;
  if (!enclosure || enclosure->is_closed()) return std::nullopt;
  const auto approach = make_approach(*loaded.bone, loaded.scene.approach);
  if (!approach || approach->thickness >= AssumedBrain::kThickest) return std::nullopt;  // none are drawn
  // A saved phantom has layers of its own.
  if (std::ranges::any_of(approach->layers, [](const Approach::Layer& l) { return l.label >= VoxelLabel::outer_table; }))
    return std::nullopt;
  const std::string why = enclosure->depth < Enclosure::kProbeDepth
                              ? fmt::format("bone begins again {:.0f} mm below it", enclosure->depth / kMillimetre)
                              : fmt::format(
                                    "of the directions from {:g} mm below it {:.0f} % meet bone, nine tenths of them within {:.0f} mm; in "
                                    "a skull at least {:.0f} % "
                                    "do, and within no less than {:.0f} mm",
                                    Enclosure::kProbeDepth / kMillimetre, 100.0 * enclosure->share, enclosure->reach / kMillimetre,
                                    100.0 * Enclosure::kLeastShare, Enclosure::kLeastReach / kMillimetre);
  return fmt::format(
      "[display] layers under the bone are assumed: dura and brain are drawn though the scan does not show them, and its bone does not "
      "close round the site as a skull does: {}; --set display.assumed_brain=false draws none",
      why);
}

}  // namespace

Plan make_plan(const LoadedScene& loaded, const EffectRegistry& registry, const MemoryRun& run) {
  const Needs needs = loaded.scene.effects.needs(loaded.scene);
  const BoneShape bone = shape_of(*loaded.bone, loaded.scene.approach);
  const PlanContext context{loaded.scene, needs, loaded.tool, bone, window_voxels(loaded.scene, needs, loaded.tool, bone.bone_from_index),
                            run.live};
  Plan plan;
  plan.rows = {volume_row(loaded, context.window_voxels)};
  if (auto publishing = publish_row(context)) plan.rows.push_back(std::move(*publishing));
  plan.rows.push_back(hand_row(loaded));
  for (const EffectPlans::Item& item : loaded.scene.effects.items()) {
    plan.rows.push_back(item.plan->row(context));
    item.plan->warn(context, plan.warnings);
  }
  for (const EffectEntry& effect : registry)
    if (!loaded.scene.effects.has(effect.table)) plan.not_built.emplace_back(effect.table);
  if (loaded.import)
    for (const std::string& line : loaded.import->scan.assumed) plan.warnings.push_back("[volume] assumed: " + line);
  if (auto layers = assumed_layers_warning(loaded)) plan.warnings.push_back(std::move(*layers));
  if (!loaded.paged_note.empty()) plan.warnings.push_back("[limits] " + loaded.paged_note);
  warn_of_features(loaded, {loaded.tool.name, loaded.tool_text}, plan.warnings);
  warn_of_buried({loaded.tool.name, loaded.tool_text}, plan.warnings);
  warn_of_repair({loaded.tool.name, loaded.tool_text}, plan.warnings);
  plan.scene_warnings = plan.warnings.size();
  plan.memory = plan_memory(loaded.scene, loaded.tool, bone, loaded.scan_bytes, run);
  return plan;
}

Plan make_run_plan(const LoadedScene& loaded, bool live, const InputTools& tools, Issues& issues) {
  const std::vector<Tool> others = load_tools(tools.texts, loaded.scene, loaded.bone->bone_from_index().mean_edge(), issues);
  MemoryRun run{.live = live, .locked = live && may_lock_memory(), .inputs = tools.inputs};
  for (const Tool& other : others) run.tools.push_back(&other);
  Plan plan = make_plan(loaded, shipped_effects(), run);
  for (const ToolText& one : tools.texts) {
    warn_of_features(loaded, one, plan.warnings);
    warn_of_buried(one, plan.warnings);
    warn_of_repair(one, plan.warnings);
  }
  return plan;
}

}  // namespace burrhole
