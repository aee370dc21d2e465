#include "app/cli/cost_drilling.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "app/cli/commands.h"
#include "app/cli/cost_study.h"
#include "app/lab/drilling_convergence.h"
#include "app/lab/drilling_cost.h"

namespace burrhole::cli {
namespace {

struct DrillingCostArguments {
  StudyFolder folder{.folder = "out/cost_drilling"};
  DrillingCostOptions options;
  bool convergence = false;
};

DrillingRuns runs_of(const DrillingCostArguments& arguments, Progress& progress) {
  DrillingRuns runs = arguments.options.runs;
  runs.tool_folder = (std::filesystem::path(share_folder()) / "tools").string();
  StudyRuns study = study_runs(arguments.folder, progress);
  runs.partial = study.partial;
  runs.progress = std::move(study.progress);
  runs.say = std::move(study.say);
  return runs;
}

/// Finds a bit that is not one of the study: a shipped tool, or a tool file. @returns null for one of the study.
Result<std::shared_ptr<const DrillingBit>> find_own_bit(const std::string& given) {
  if (find_drilling_bit(given) != nullptr) return std::shared_ptr<const DrillingBit>();
  const std::string ending = std::filesystem::path(given).extension().string();
  if (ending == ".stl" || ending == ".ply" || ending == ".obj")
    return bad_input("--bit: is a mesh, and the study compares a hole with its closed form: give a tool file with regions", given);
  const SceneContext context = scene_context();
  const auto text = read_tool_text(given, {}, context);
  std::error_code ignored;
  if (!text && !std::filesystem::exists(given, ignored))
    return bad_input(fmt::format("--bit \"{}\" is no bit of the study ({}), no shipped tool (burrhole tools lists them) and no tool file",
                                 given, drilling_bit_names()));
  if (!text) return text.error();
  auto bit = own_drilling_bit(given, *text);
  if (!bit) return bit.error();
  return std::shared_ptr<const DrillingBit>(std::make_shared<DrillingBit>(std::move(bit).value()));
}

int run_cost(const DrillingCostArguments& arguments) {
  const auto own = find_own_bit(arguments.options.bit);
  if (!own) return report(own.error());
  const auto lock = begin_study(arguments.folder);
  if (!lock) return report(lock.error());
  Progress progress(false, {}, true);
  DrillingCostOptions options = arguments.options;
  options.runs = runs_of(arguments, progress);
  options.own = *own;
  const auto points = measure_drilling_cost(options);
  if (!points) return report(points.error());
  if (const Status written = write_drilling_cost(*points, options.bit, arguments.folder.folder); !written) return report(written.error());
  end_study(arguments.folder);
  for (const std::string& sentence : drilling_sentences(*points)) print(sentence + "\n");
  print(fmt::format("{} points in {}/cost.csv, drilling.md, drilling.svg and drilling.html beside it\n", points->size(),
                    arguments.folder.folder));
  return kDone;
}

int run_convergence(const DrillingCostArguments& arguments) {
  const auto lock = begin_study(arguments.folder);
  if (!lock) return report(lock.error());
  Progress progress(false, {}, true);
  ConvergenceOptions options;
  options.runs = runs_of(arguments, progress);
  options.quick = arguments.options.quick;
  const auto rows = measure_convergence(options);
  if (!rows) return report(rows.error());
  if (const Status written = write_convergence(*rows, arguments.folder.folder); !written) return report(written.error());
  end_study(arguments.folder);
  for (const StabilityRow& row : *rows)
    if (!row.pass) print(fmt::format("{}: {} is {:.4g}, bound {:.4g}\n", row.subject, row.measure, row.value, row.bound));
  const bool failed = convergence_failed(*rows);
  print(fmt::format("{} figures in {}/convergence.csv, convergence.md and convergence.html beside it; {}\n", rows->size(),
                    arguments.folder.folder, failed ? "bounds failed" : "all within their bounds"));
  return failed ? kCheckFailed : kDone;
}

}  // namespace

void add_drilling_cost(CLI::App& cost, int& exit_code) {
  CLI::App* command = add_command(
      cost, "drilling", "Subjects",
      {.summary = "Accuracy of a drilled hole against time, by the settings of a scene",
       .about =
           "Drills holes in lockstep, as drill does, with one setting at a time varied round its default: voxel edge, erosion rate, "
           "sub-steps, pitch of erosion points and of the point shell, contact rate, latency, coupling, cutting stiffness and bits of the "
           "surface records. Tables errors of volume, mass, diameters, depth, time to breakthrough, plunge, feed and wall against the "
           "closed "
           "form or a finer run, with CPU time, wall time and memory. --convergence instead checks that holes of several bits in several "
           "bones, by both laws, do not depend on voxel edge and erosion rate. Each hole is kept when it is done, and a call that was "
           "interrupted goes on from there.",
       .examples = {"burrhole cost drilling --quick --out out/cost_drilling", "burrhole cost drilling --knob erosion.rate_hz",
                    "burrhole cost drilling --quick --bit my_bit.toml", "burrhole cost drilling --convergence"},
       .exits = "Exit 3 if a bound of --convergence fails."});
  auto arguments = std::make_shared<DrillingCostArguments>();
  add_study_options(*command, arguments->folder, "the tables, the plot and the page");
  CLI::Option* convergence = command->add_flag("--convergence", arguments->convergence, "check the bounds of holes by voxel edge and rate");
  command
      ->add_option("--bit", arguments->options.bit,
                   "bit that drills the hole: one of the study, a shipped tool, or a tool file of your own")
      ->type_name(kToolValue)
      ->capture_default_str()
      ->excludes(convergence);
  command->add_option("--knob", arguments->options.only_knob, "vary only this setting")->type_name("KEY")->excludes(convergence);
  command->add_flag("--quick", arguments->options.quick, "a subset that takes minutes");
  command->add_option("--threads", arguments->options.runs.threads, "number of holes that are drilled in parallel; 0: one per core")
      ->capture_default_str();
  add_simd_option(*command);
  command->callback([arguments, &exit_code] {
    arguments->folder.partial = arguments->convergence ? "partial_convergence.txt" : "partial_cost.txt";
    exit_code = arguments->convergence ? run_convergence(*arguments) : run_cost(*arguments);
  });
}

}  // namespace burrhole::cli
