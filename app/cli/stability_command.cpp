#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/cli/frontier_option.h"
#include "app/cli/progress.h"
#include "app/job/run_folder.h"
#include "app/lab/stability_report.h"
#include "app/lab/stability_run.h"
#include "app/report/file.h"

namespace burrhole::cli {
namespace {

struct StabilityCommand {
  StabilityOptions options;
  std::string folder = "out/stability";
  bool json = false, map = false;
};

std::string json_of(const std::vector<StabilityOutcome>& outcomes, bool failed) {
  nlohmann::ordered_json out{{"schema", "burrhole.stability/1"}, {"failed", failed}, {"rows", nlohmann::ordered_json::array()}};
  for (const StabilityOutcome& outcome : outcomes)
    for (const StabilityRow& row : outcome.rows)
      out["rows"].push_back({{"case", row.subject},
                             {"model", row.model},
                             {"measure", row.measure},
                             {"value", row.value},
                             {"bound", row.bound},
                             {"pass", row.pass}});
  return out.dump(2) + "\n";
}

/// @returns one line for each sabotaged case that its measure did not detect.
std::vector<std::string> uncaught(const std::vector<StabilityOutcome>& outcomes) {
  std::vector<std::string> out;
  for (const StabilityCase& one : stability_cases())
    for (const StabilityOutcome& outcome : outcomes) {
      if (outcome.subject != one.name) continue;
      bool caught = false;
      for (const StabilityRow& row : outcome.rows) caught |= !row.pass && row.measure == name_of(one.sabotage.must_fail);
      if (!caught)
        out.push_back(fmt::format("{}: \"{}\" is not detected by {}", one.name, one.sabotage.what, name_of(one.sabotage.must_fail)));
    }
  return out;
}

void print_failures(const std::vector<StabilityOutcome>& outcomes) {
  for (const StabilityOutcome& outcome : outcomes) {
    if (!outcome.error.empty()) print(fmt::format("{}, {}: {}\n", outcome.subject, outcome.model, outcome.error));
    for (const StabilityRow& row : outcome.rows)
      if (!row.pass) print(fmt::format("{}, {}: {} is {:.4g}, bound {:.4g}\n", row.subject, row.model, row.measure, row.value, row.bound));
  }
}

Status write_files(const std::vector<StabilityOutcome>& outcomes, const StabilityCommand& command) {
  // Sabotaged results go to another file than real ones.
  if (command.options.sabotage) return write_stability_csv(outcomes, command.folder + "/sabotage.csv");
  if (Status csv = write_stability_csv(outcomes, command.folder + "/stability.csv"); !csv) return csv;
  if (Status table = write_file(command.folder + "/stability.md", stability_markdown(outcomes)); !table) return table;
  return write_stability_page(outcomes, command.folder + "/stability.html");
}

int run(const StabilityCommand& command) {
  const auto lock = take_output_folder(command.folder);
  if (!lock) return report(lock.error());
  Progress progress(command.json);
  const auto outcomes = run_stability(command.options, [&](double share, const std::string& text) { progress.show(share, text); });
  if (!outcomes) return report(outcomes.error());
  if (Status written = write_files(*outcomes, command); !written) return report(written.error());
  if (command.options.sabotage) {
    const std::vector<std::string> missed = uncaught(*outcomes);
    for (const std::string& line : missed) print(line + "\n");
    print(fmt::format("{} sabotaged cases, {} of them not detected\n", outcomes->size(), missed.size()));
    return missed.empty() ? kDone : kCheckFailed;
  }
  const bool failed = default_model_failed(*outcomes);
  if (command.json) {
    print(json_of(*outcomes, failed));
  } else {
    print_failures(*outcomes);
    print(fmt::format("{} runs in {}/stability.csv and stability.html; the default model {}\n", outcomes->size(), command.folder,
                      failed ? "fails" : "passes"));
  }
  return failed ? kCheckFailed : kDone;
}

}  // namespace

void add_stability(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "stability", kMeasureGroup,
      {.summary = "Runs the stability cases of each contact model, or maps the maximum stable stiffness",
       .about =
           "Runs cases that are difficult for a force loop (edges, pits, thin shells, jumps, stalls, values that are not finite) through "
           "the shipped servo, contact and erosion, and compares each with its bounds; writes CSV, a table and a page. --map instead "
           "measures the maximum stable stiffness by device, hand, damping, contact rate and scheme, with the theoretical limits.",
       .examples = {"burrhole stability --out out/stability", "burrhole stability --case rest --model surface",
                    "burrhole stability --map --out out/stability"},
       .exits = "Exit 3 if a case of the default model fails."});
  auto option = std::make_shared<StabilityCommand>();
  command->add_option("--out", option->folder, "folder for stability.csv, stability.md and stability.html")
      ->type_name(kFolderValue)
      ->capture_default_str();
  CLI::Option* map =
      command->add_flag("--map", option->map, "map the maximum stable stiffness instead: frontier.csv, its plots and frontier.html");
  command->add_option("--case", option->options.only_case, "run only this case")->excludes(map);
  command->add_option("--model", option->options.only_model, "run only this model")->excludes(map);
  command->add_option("--threads", option->options.threads, "number of cases, or points of the map, that run in parallel; 0: one per core")
      ->capture_default_str();
  command->add_flag("--long", option->options.long_runs, "run the longest case for ten million ticks")->excludes(map);
  CLI::Option* sabotage =
      command->add_flag("--sabotage", option->options.sabotage, "sabotage each case and write sabotage.csv; exit 3 if one is not detected")
          ->excludes(map);
  command->add_flag("--json", option->json, "print only the rows on stdout, as JSON")->excludes(map)->excludes(sabotage);
  add_simd_option(*command);
  command->callback(
      [option, &exit_code] { exit_code = option->map ? run_frontier(option->folder, option->options.threads, false) : run(*option); });
}

}  // namespace burrhole::cli
