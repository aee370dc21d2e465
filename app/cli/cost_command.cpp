#include <fmt/format.h>

#include <filesystem>

#include "app/cli/front.h"
#include "app/lab/contact_accuracy.h"

namespace burrhole::cli {

void add_cost(CLI::App& app, int& exit_code) {
  CLI::App* command =
      add_command(app, "cost", kMeasureGroup,
                  {.summary = "Accuracy against time of one subject",
                   .about = "Measures a part of the simulator against closed forms and tables its errors beside what it costs: "
                            "as CSV, and as plots where gnuplot is installed.",
                   .examples = {"burrhole cost contact --out out/cost"},
                   .exits = {}});
  command->require_subcommand(1);
  CLI::App* contact =
      add_command(*command, "contact", "Subjects",
                  {.summary = "Error of the contact force on plate, sphere and wedge",
                   .about = "Presses balls into generated bone, clean and noisy, and compares the force with its closed form.",
                   .examples = {"burrhole cost contact --out out/cost"},
                   .exits = {}});
  auto folder = std::make_shared<std::string>("out/cost");
  contact->add_option("--out", *folder, "folder for cost.csv and the plots")->type_name(kFolderValue)->capture_default_str();
  contact->callback([folder, &exit_code] {
    ContactAccuracyOptions options;
    options.tool_folder = (std::filesystem::path(share_folder()) / "tools").string();
    const auto rows = measure_contact_accuracy(options);
    if (!rows) {
      exit_code = report(rows.error());
      return;
    }
    const auto curves = measure_force_curves(options);
    if (!curves) {
      exit_code = report(curves.error());
      return;
    }
    const Status written = write_contact_accuracy(*rows, *curves, *folder);
    exit_code = written ? kDone : report(written.error());
    if (written)
      print(fmt::format("{} rows in {}/cost.csv, plots contact_error.svg and contact_force.svg beside it\n", rows->size(), *folder));
  });
}

}  // namespace burrhole::cli
