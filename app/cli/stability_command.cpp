#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/cli/front.h"
#include "app/cli/frontier_option.h"
#include "app/cli/progress.h"
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

/// Whether each case that was broken on purpose was caught by the measure that it names.
std::vector<std::string> uncaught(const std::vector<StabilityOutcome>& outcomes) {
  std::vector<std::string> out;
  for (const StabilityCase& one : stability_cases())
    for (const StabilityOutcome& outcome : outcomes) {
      if (outcome.subject != one.name) continue;
      bool caught = false;
      for (const StabilityRow& row : outcome.rows) caught |= !row.pass && row.measure == name_of(one.sabotage.must_fail);
      if (!caught) out.push_back(fmt::format("{}: \"{}\" is not seen by {}", one.name, one.sabotage.what, name_of(one.sabotage.must_fail)));
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
  // What was broken on purpose never lies where the figures of the program do.
  if (command.options.sabotage) return write_stability_csv(outcomes, command.folder + "/sabotage.csv");
  if (Status csv = write_stability_csv(outcomes, command.folder + "/stability.csv"); !csv) return csv;
  if (Status table = write_file(command.folder + "/stability.md", stability_markdown(outcomes)); !table) return table;
  return write_stability_page(outcomes, command.folder + "/stability.html");
}

int run(const StabilityCommand& command) {
  Progress progress(command.json);
  const auto outcomes = run_stability(command.options, [&](double share, const std::string& text) { progress.show(share, text); });
  if (!outcomes) return report(outcomes.error());
  if (Status written = write_files(*outcomes, command); !written) return report(written.error());
  if (command.options.sabotage) {
    const std::vector<std::string> missed = uncaught(*outcomes);
    for (const std::string& line : missed) print(line + "\n");
    print(fmt::format("{} cases broken on purpose, {} of them not seen\n", outcomes->size(), missed.size()));
    return missed.empty() ? kDone : kCheckFailed;
  }
  const bool failed = default_model_failed(*outcomes);
  if (command.json) {
    print(json_of(*outcomes, failed));
  } else {
    print_failures(*outcomes);
    print(fmt::format("{} runs in {}/stability.csv and stability.html; the default model {}\n", outcomes->size(), command.folder,
                      failed ? "fails" : "holds"));
  }
  return failed ? kCheckFailed : kDone;
}

}  // namespace

void add_stability(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "stability", kMeasureGroup,
      {.summary = "Hard cases of contact, for each contact model; the measured frontier",
       .about =
           "Runs cases that shake a force loop - edges, pits, thin shells, jumps, stalls, numbers that are none - through the "
           "shipped servo, contact and erosion, and holds each against its bounds: as CSV, as a table and as a page. --map instead finds "
           "the largest stable stiffness by device, hand, damping, contact rate and scheme, beside the lines of theory.",
       .examples = {"burrhole stability --out out/stability", "burrhole stability --case rest --model surface",
                    "burrhole stability --map --out out/stability"},
       .exits = "3 when a case of the default model fails."});
  auto option = std::make_shared<StabilityCommand>();
  command->add_option("--out", option->folder, "folder for stability.csv, stability.md and stability.html")
      ->type_name(kFolderValue)
      ->capture_default_str();
  CLI::Option* map = command->add_flag("--map", option->map, "measure the frontier instead: frontier.csv, its plots and frontier.html");
  command->add_option("--case", option->options.only_case, "this case alone")->excludes(map);
  command->add_option("--model", option->options.only_model, "this model alone")->excludes(map);
  command
      ->add_option("--threads", option->options.threads, "cases, or points of the map, that run at once; 0 for as many as there are cores")
      ->capture_default_str();
  command->add_flag("--long", option->options.long_runs, "the longest case runs for ten million ticks")->excludes(map);
  CLI::Option* sabotage = command
                              ->add_flag("--sabotage", option->options.sabotage,
                                         "breaks each case on purpose, into sabotage.csv; exit 3 when one is not caught")
                              ->excludes(map);
  command->add_flag("--json", option->json, "print the rows as JSON on stdout, and nothing else there")->excludes(map)->excludes(sabotage);
  add_simd_option(*command);
  command->callback(
      [option, &exit_code] { exit_code = option->map ? run_frontier(option->folder, option->options.threads, false) : run(*option); });
}

}  // namespace burrhole::cli
