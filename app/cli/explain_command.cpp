#include <fmt/format.h>
#include <algorithm>

#include "app/cli/commands.h"
#include "app/cli/drilling.h"
#include "app/job/drill_job.h"

namespace burrhole::cli {
namespace {

std::string size_text(std::uint64_t bytes) {
  if (bytes >= 10'000'000) return fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6);
  if (bytes >= 10'000) return fmt::format("{:.1f} kB", static_cast<double>(bytes) * 1e-3);
  return fmt::format("{} B", bytes);
}

std::string table_text(const LoadedScene& loaded, const Plan& plan, const RunSummary* measured) {
  std::string out = fmt::format("{}: {}\n\n", loaded.scene.file, loaded.scene.title);
  out += fmt::format("{:<9} {:<11} {:>9}  {:>10}  {:>10}  {}\n", "effect", "clock", "rate", "bytes", measured != nullptr ? "time" : "",
                     "what");
  for (std::size_t n = 0; n < plan.rows.size(); ++n) {
    const PlanRow& row = plan.rows[n];
    const std::string rate = row.rate_hz > 0.0 ? fmt::format("{:.0f} Hz", row.rate_hz) : "events";
    const std::string time = measured != nullptr ? fmt::format("{:.2f} s", measured->effects[n].time_us * 1e-6) : "";
    out += fmt::format("{:<9} {:<11} {:>9}  {:>10}  {:>10}  {}; {}\n", row.table, name_of(row.clock), rate, size_text(row.bytes), time,
                       row.step, row.detail);
  }
  if (!plan.not_built.empty()) out += fmt::format("\nnot built, as this scene has no table for it: {}\n", fmt::join(plan.not_built, ", "));
  out += fmt::format("\nmemory at the peak, about {}\n", plan.memory.text());
  for (const std::string& warning : plan.warnings) out += "warning: " + warning + "\n";
  return out;
}

}  // namespace

void add_explain(CLI::App& app, int& exit_code) {
  struct Options {
    SceneOption scene;
    DrillingFiles files;
    bool json = false, measure = false, live = false;
  };
  CLI::App* command = add_command(
      app, "explain", kSceneGroup,
      {.summary = "Lists the steps of a scene with their rates and memory",
       .about = "Lists the effects that the scene's tables enable, in the order they run, and the effects that are not built. With "
                "--measure it also runs the scene, without writing files, and adds the computation time of each effect.",
       .examples = {"burrhole explain parietal", "burrhole explain my_scene.toml --measure --json", "burrhole explain parietal --live"},
       .exits = "Exit 130 if Ctrl-C ended a measured run."});
  auto option = std::make_shared<Options>();
  option->scene.add_to(*command);
  command->add_flag("--measure", option->measure, "run the scene without writing files, and add the time of each row");
  command->add_flag("--live", option->live, "of a run on threads in real time instead of in lockstep");
  command->add_option("--inputs", option->files.inputs, "of a run with this TOML file of timed inputs")->type_name(kFileValue);
  add_simd_option(*command);
  add_gl_option(*command, option->files.gl);
  command->add_flag("--json", option->json, "print only JSON on stdout");
  command->callback([option, &exit_code] {
    const auto loaded = load_or_report(option->scene, exit_code, false, option->live, option->files.inputs);
    if (!loaded) return;
    Issues issues;
    InputTools tools;
    if (!option->files.inputs.empty())
      if (const auto inputs = load_inputs(option->files.inputs, loaded->scene, scene_context(), issues)) tools = tools_of(*inputs);
    const Plan plan = make_run_plan(*loaded, option->live, tools, issues);
    if (!issues.empty()) {
      exit_code = report(issues);
      return;
    }
    std::optional<RunSummary> measured;
    if (option->measure) {
      catch_signals();
      auto summary = drill_scene(*loaded, option->files, false, {.live = option->live});
      if (!summary) {
        exit_code = report(summary.error());
        return;
      }
      measured = std::move(summary).value();
    }
    const RunSummary* figures = measured ? &*measured : nullptr;
    print(option->json ? plan_json(*loaded, plan, figures) : table_text(*loaded, plan, figures));
    exit_code = measured && measured->end == "stopped" ? kInterrupted : kDone;
  });
}

}  // namespace burrhole::cli
