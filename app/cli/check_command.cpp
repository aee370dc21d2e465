#include <fmt/format.h>

#include "app/cli/front.h"
#include "app/engine/plan.h"
#include "app/engine/simulation.h"

namespace burrhole::cli {

void add_check(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("check", "Is a scene valid? Prints every fault as file:line:column; needs no display and no device.");
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
    // Putting the run together finds what needs bone and tool side by side: a tool too large, an axis that misses.
    if (loaded) (void)Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
    exit_code = report(issues);
    if (!issues.empty()) return;
    for (const std::string& warning : make_plan(*loaded).warnings) fmt::print(stderr, "{}: warning: {}\n", loaded->scene.file, warning);
    print(loaded->scene.file + ": ok\n");
  });
}

}  // namespace burrhole::cli
