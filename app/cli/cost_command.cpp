#include <fmt/format.h>

#include <filesystem>

#include "app/cli/front.h"
#include "app/lab/contact_accuracy.h"

namespace burrhole::cli {

void add_cost(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("cost", "Accuracy against time: CSV and plots of a subject's errors beside what it costs.");
  command->require_subcommand(1);
  CLI::App* contact =
      command->add_subcommand("contact", "Error of the contact force on plate, sphere and wedge, clean and noisy, against closed forms.");
  auto folder = std::make_shared<std::string>("out/cost");
  contact->add_option("--out", *folder, "folder for cost.csv and the plots")->capture_default_str();
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
