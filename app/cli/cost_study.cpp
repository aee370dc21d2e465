#include "app/cli/cost_study.h"

#include <filesystem>

#include "app/job/run_folder.h"

namespace burrhole::cli {

namespace fs = std::filesystem;

std::string StudyFolder::file() const { return (fs::path(folder) / partial).string(); }

void add_study_options(CLI::App& command, StudyFolder& folder, const std::string& holds) {
  command.add_option("--out", folder.folder, "folder for " + holds)->type_name(kFolderValue)->capture_default_str();
  command.add_flag("--fresh", folder.fresh, "measure again what an interrupted call has done already");
}

Result<FolderLock> begin_study(const StudyFolder& folder) {
  auto lock = take_output_folder(folder.folder);
  std::error_code error;
  if (lock && folder.fresh) fs::remove(folder.file(), error);
  if (error)
    return bad_input("the results of an interrupted call cannot be removed: " + error.message() + "; give another folder by --out",
                     folder.file());
  return lock;
}

StudyRuns study_runs(const StudyFolder& folder, Progress& progress) {
  return {.partial = folder.file(),
          .progress = [&progress](double share, const std::string& trial) { progress.show(share, trial); },
          .say = [&progress](const std::string& line) { progress.say(line); },
          .now = {}};
}

void end_study(const StudyFolder& folder) {
  std::error_code ignored;
  fs::remove(folder.file(), ignored);
}

}  // namespace burrhole::cli
