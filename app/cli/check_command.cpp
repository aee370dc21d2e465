#include <fmt/format.h>

#include "app/cli/commands.h"
#include "app/job/plan.h"
#include "app/run/simulation.h"
#include "core/base/units.h"
#include "core/measure/approach_check.h"

namespace burrhole::cli {
namespace {

constexpr double kGrazing = 45.0;  // [deg] a drill is held at a right angle to the skull; beyond this it slips before it cuts

/// A run that was built and not started.
struct Built {
  std::unique_ptr<LoadedScene> loaded;  // the simulation points at its tool
  std::unique_ptr<Simulation> simulation;
};

/// Loads a scene and builds its run. That finds errors that depend on bone and tool together: a tool that is too large, an axis that misses
/// the bone or leaves the skull. @returns nothing where an issue was pushed.
std::optional<Built> build(const TomlDocument& document, const std::vector<std::string>& tool_sets, Issues& issues) {
  LoadOptions options;
  options.tool_sets = tool_sets;
  auto loaded = load_scene(document, scene_context(), issues, options);
  if (!loaded) return std::nullopt;
  Built out{std::make_unique<LoadedScene>(std::move(*loaded)), nullptr};
  out.simulation = Simulation::create(out.loaded->scene, out.loaded->bone, out.loaded->tool, {.runs = false}, issues);
  if (!out.simulation) return std::nullopt;
  if (const auto wrong = leaves_skull(*out.loaded->bone, out.simulation->approach())) {
    issues.push_back(bad_input(*wrong, out.loaded->scene.approach.place));
    return std::nullopt;
  }
  return out;
}

/// @returns whether the scene's approach meets bone from outside, at most `largest` [rad] off its normal.
bool is_valid_approach(const TomlDocument& document, double largest) {
  Issues ignored;
  const auto loaded = load_scene(document, scene_context(), ignored);
  if (!loaded) return false;
  const auto approach = make_approach(*loaded->bone, loaded->scene.approach);
  return approach && approach->angle <= largest && !leaves_skull(*loaded->bone, *approach);
}

std::string key_text(const char* key, const Vec3& v, double unit) {
  return fmt::format("{} = [{:.6g}, {:.6g}, {:.6g}]", key, v.x / unit + 0.0, v.y / unit + 0.0, v.z / unit + 0.0);  // no -0
}

/// For an approach that cannot be used: RAS and LPS differ by the signs of x and y, so that an approach that is valid with these signs
/// changed was probably given in RAS. @returns that as an error; nothing if no such change helps.
std::optional<Error> ras_error(const TomlDocument& document) {
  Issues ignored;
  TableReader root = document.root(ignored);
  const auto table = root.table("approach", "");
  const auto scene = read_scene(document, scene_context(), ignored);
  if (!scene || !table || !table->has("entry_mm")) return std::nullopt;
  if (is_valid_approach(document, 180.0 * kDegree)) return std::nullopt;  // the error is another one
  const ApproachScene& given = scene->approach;
  const Vec3 turn(-1.0, -1.0, 1.0);
  struct Change {
    bool entry, axis;
    const char* what;
  };
  for (const Change& change :
       {Change{true, true, "entry_mm and axis seem"}, Change{true, false, "entry_mm seems"}, Change{false, true, "axis seems"}}) {
    const Vec3 entry = change.entry ? given.entry * turn : given.entry, axis = change.axis ? given.axis * turn : given.axis;
    if ((change.entry && entry == given.entry) || (change.axis && axis == given.axis)) continue;
    const std::string entry_text = key_text("entry_mm", entry, kMillimetre), axis_text = key_text("axis", axis, 1.0);
    TomlDocument turned = document;
    if (!turned.set("approach." + entry_text) || !turned.set("approach." + axis_text) || !is_valid_approach(turned, kGrazing * kDegree))
      continue;
    return bad_input(fmt::format("{} to be RAS, and a scene is LPS: negate x and y; {}, {} is valid", change.what, entry_text, axis_text),
                     given.place);
  }
  return std::nullopt;
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "check", kSceneGroup,
      {.summary = "Validates a scene; prints every error as file:line:column",
       .about = "Reads scene and tool, generates or imports the bone and builds the run without starting it. Errors go to stderr, one line "
                "each, with the nearest known name for a misspelt one; for a valid scene one line goes to stdout. Needs no display and no "
                "device.",
       .examples = {"burrhole check my_scene.toml", "burrhole check parietal --unset clutch --set tool.name=round_burr_4mm"},
       .exits = "Exit 4 if the only errors are that a requested device or display is not available."});
  auto option = std::make_shared<SceneOption>();
  option->add_to(*command);
  command->callback([option, &exit_code] {
    warn_of_namesake(option->scene);
    const auto document = option->document();
    if (!document) {
      exit_code = report(document.error());
      return;
    }
    Issues issues;
    const auto built = build(*document, option->tool_sets, issues);
    if (!built)
      if (auto ras = ras_error(*document)) issues.push_back(std::move(*ras));
    exit_code = report(issues);
    if (!built) return;
    const LoadedScene& loaded = *built->loaded;
    for (const std::string& warning : make_plan(loaded).warnings) print_warning(loaded.scene.file, warning);
    if (loaded.scene.tool.spin == 0.0 && loaded.scene.effects.needs(loaded.scene).removes)
      print_warning(loaded.scene.file, "tool.spin_rpm = 0: the bit does not spin, so nothing is cut; set tool.spin_rpm above 0");
    const Approach& approach = built->simulation->approach();
    const double thickness_mm = approach.thickness / kMillimetre, angle_deg = approach.angle / kDegree;
    if (angle_deg > kGrazing)
      note(fmt::format("{}: warning: the axis meets the bone {:.0f} degrees off its normal\n", loaded.scene.file, angle_deg));
    print(fmt::format("{}: ok; {:.2f} mm of bone along the axis, {:.1f} degrees off its normal\n", loaded.scene.file, thickness_mm,
                      angle_deg));
  });
}

}  // namespace burrhole::cli
