#include <fmt/format.h>

#include "app/cli/commands.h"
#include "app/job/plan.h"
#include "app/run/simulation.h"
#include "core/base/units.h"

namespace burrhole::cli {

void add_check(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "check", kSceneGroup,
      {.summary = "Validates a scene; prints every error as file:line:column",
       .about = "Reads scene and tool, generates or imports the bone and builds the run without starting it. Errors go to stderr, one line "
                "each, with the nearest known name for a misspelt one; for a valid scene one line goes to stdout. Needs no display and no "
                "device.",
       .examples = {"burrhole check my_scene.toml", "burrhole check parietal --set tool.name=round_burr_4mm"},
       .exits = "Exit 4 if the only errors are that a requested device or display is not available."});
  auto option = std::make_shared<SceneOption>();
  option->add_to(*command);
  command->callback([option, &exit_code] {
    const auto document = option->document();
    if (!document) {
      exit_code = report(document.error());
      return;
    }
    Issues issues;
    const auto loaded = load_scene(*document, scene_context(), issues);
    // Building the run finds errors that depend on bone and tool together: a tool that is too large, an axis that misses the bone.
    std::unique_ptr<Simulation> simulation;
    if (loaded) simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
    exit_code = report(issues);
    if (!issues.empty()) return;
    for (const std::string& warning : make_plan(*loaded).warnings) print_warning(loaded->scene.file, warning);
    const double thickness_mm = simulation->approach().thickness / kMillimetre, angle_deg = simulation->approach().angle / kDegree;
    constexpr double kGrazing = 45.0;  // [deg] a drill is held at a right angle to the skull; beyond this it slips before it cuts
    if (angle_deg > kGrazing)
      fmt::print(stderr, "{}: warning: the axis meets the bone {:.0f} degrees off its normal\n", loaded->scene.file, angle_deg);
    if (simulation->approach().from_inside)
      fmt::print(stderr, "{}: warning: the axis points out of the skull: it meets brain or dura before the entry\n", loaded->scene.file);
    print(fmt::format("{}: ok; {:.2f} mm of bone along the axis, {:.1f} degrees off its normal\n", loaded->scene.file, thickness_mm,
                      angle_deg));
  });
}

}  // namespace burrhole::cli
