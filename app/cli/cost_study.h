/// app/cli/cost_study.h: what the commands of `burrhole cost` share: the folder of a study, its partial results, and progress.
///   Errors  bad_input: the folder cannot be made, or another process has it.   Thread  main.
#pragma once

#include <string>

#include "app/cli/command_text.h"
#include "app/cli/progress.h"
#include "app/job/folder_lock.h"
#include "app/lab/study.h"

namespace burrhole::cli {

struct StudyFolder {
  std::string folder;                   ///< value of --out
  std::string partial = "partial.txt";  ///< name of the file of partial results in it
  bool fresh = false;                   ///< value of --fresh
  [[nodiscard]] std::string file() const;
};

/// Adds `--out` and `--fresh`. @param holds what the folder is for.
void add_study_options(CLI::App& command, StudyFolder& folder, const std::string& holds);

/// Makes the folder; with --fresh removes the partial results in it. @returns the lock of the folder, for as long as the study lasts.
[[nodiscard]] Result<FolderLock> begin_study(const StudyFolder& folder);
/// @returns callbacks that print on stderr, and the file of partial results.
[[nodiscard]] StudyRuns study_runs(const StudyFolder& folder, Progress& progress);
/// Removes the partial results of a study that is done and written.
void end_study(const StudyFolder& folder);

}  // namespace burrhole::cli
