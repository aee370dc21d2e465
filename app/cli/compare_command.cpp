#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/cli/commands.h"
#include "app/job/compare_runs.h"
#include "app/job/run_folder.h"
#include "app/stage/result_files.h"
#ifdef BH_WITH_RENDER
#include "app/cli/picture_difference.h"
#endif

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> runs;
  std::string folder;
  bool json = false;
};

#ifdef BH_WITH_RENDER
/// Compares one view of each run with that of the first, and draws the differences. @param issues receives the errors of pictures that
/// cannot be read, which are left out.
ComparedView compare_view(const std::vector<RunResults>& runs, const std::string& name, const std::string& folder, Issues& issues) {
  ComparedView out;
  std::vector<std::string> same;
  const std::string first = (fs::path(runs.front().folder) / (name + ".png")).string();
  for (std::size_t n = 1; n < runs.size(); ++n) {
    if (std::ranges::find(runs[n].pictures, name) == runs[n].pictures.end()) continue;
    const std::string other = (fs::path(runs[n].folder) / (name + ".png")).string();
    const std::string file =
        (fs::path(folder) / (runs.size() == 2 ? name + "_difference.png" : fmt::format("{}_difference_{}.png", name, n))).string();
    const auto difference = write_picture_difference(first, other, file);
    if (!difference) {
      issues.push_back(difference.error());
    } else if (difference->empty()) {
      note(fmt::format("{}: the pictures differ in size: not compared\n", name));
    } else if (*difference == kNoDifference) {
      same.push_back(runs[n].name);
    } else {
      out.pictures.push_back({other, fmt::format("{}: {}", name, runs[n].name)});
      out.pictures.push_back({file, fmt::format("{}: {}", runs[n].name, *difference)});
    }
  }
  if (out.pictures.empty() && same.empty()) return out;
  out.pictures.insert(out.pictures.begin(), {first, fmt::format("{}: {}", name, runs.front().name)});
  if (!same.empty()) out.same = fmt::format("{}: no difference between {} and {}.", name, runs.front().name, fmt::join(same, ", "));
  return out;
}
#endif

std::vector<ComparedView> compare_views(const std::vector<RunResults>& runs, const std::string& folder, Issues& issues) {
  std::vector<ComparedView> out;
#ifdef BH_WITH_RENDER
  for (const std::string& name : runs.front().pictures)
    if (ComparedView view = compare_view(runs, name, folder, issues); !view.pictures.empty()) out.push_back(std::move(view));
#else
  static_cast<void>(runs);
  static_cast<void>(folder);
  static_cast<void>(issues);
#endif
  return out;
}

bool has_results(const std::string& path) {
  std::error_code ignored;
  return fs::exists(fs::is_directory(path, ignored) ? fs::path(path) / kSummaryFile : fs::path(path), ignored);
}

int run_compare(const Options& option) {
  if (option.runs.size() < 2)
    return report(
        bad_input(fmt::format("compare needs two runs or more, as in burrhole compare {0} OTHER_FOLDER; figures of one run are in {0}/{1}",
                              option.runs.front(), kReportFile)));
  std::vector<RunResults> runs;
  Issues issues;
  bool all_there = true;  // a path without results is a mistake of the call, damaged results are not
  for (const std::string& path : option.runs) {
    all_there = all_there && has_results(path);
    auto run = read_run(path);
    if (run)
      runs.push_back(std::move(*run));
    else if (std::ranges::find(issues, run.error().text(), &Error::text) == issues.end())  // the same run given twice
      issues.push_back(run.error());
  }
  if (!issues.empty() && !all_there) return report(issues);
  if (runs.size() < 2) return report(issues);  // nothing is left to compare
  for (const RunResults& run : runs) {
    if (run.damaged)
      issues.push_back(bad_input(run.no_curves + "; its figures are those of summary.json, without curves", run.name));
    else if (!run.no_curves.empty())
      print_line(run.name + ": no curves: " + run.no_curves);
  }
  if (!option.folder.empty()) {
    const auto lock = take_output_folder(option.folder);
    if (!lock) return report(lock.error());
    const auto views = compare_views(runs, option.folder, issues);
    if (Status written = write_comparison(runs, views, option.folder); !written) return report(written.error());
    note(fmt::format("page: {}\n", (fs::path(option.folder) / "compare.html").string()));
  }
  print(option.json ? comparison_json(runs) : comparison_text(runs));
  return report(issues);  // of damaged files, which the rest does without
}

}  // namespace

void add_compare(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "compare", kDrillGroup,
      {.summary = "Lays the results of runs side by side: a table, curves, pictures",
       .about =
           "A RUN is a folder that drill wrote. Prints a table of their settings that differ, results and figures; a star marks the rows "
           "that differ, and of two runs the last column is the second minus the first. A setting that a run did not override is the "
           "scene's. feed_mm_per_s is depth_mm over breakthrough_s, the approach included. With --out it also writes compare.html with "
           "force and depth of all runs over each other (compare.svg), and for each picture of the first run those of the others that "
           "differ, with the place of their differences. A summary.json, session or picture that is damaged is left out: the exit code is "
           "then 2.",
       .examples = {"burrhole compare out/soft out/hard", "burrhole compare out/soft out/hard --out out/compared",
                    "burrhole compare out/* --json | jq '.runs[].figures.plunge_mm'"},
       .exits = {}});
  auto option = std::make_shared<Options>();
  command->add_option("run", option->runs, "folders of results, at least two")->type_name(kFolderValue)->required()->expected(1, 1000);
  command->add_option("--out", option->folder, "folder for compare.html, compare.svg and pictures; default: only the table")
      ->type_name(kFolderValue);
  command->add_flag("--json", option->json, "print the table as JSON on stdout");
  command->callback([option, &exit_code] { exit_code = run_compare(*option); });
}

}  // namespace burrhole::cli
