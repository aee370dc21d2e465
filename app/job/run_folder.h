/// app/job/run_folder.h: the output folder of a run: that it can be written, and what becomes of the results of an earlier run.
///   Results of two runs never lie side by side: those of the earlier run are set aside before the first file of this one, and deleted when
///   this one starts. If it does not start, they are put back, by the next run if this one was killed. The bone is kept until this run has
///   written its own. A result that is a symbolic link is set aside and deleted as the link: the file that it leads to stays.
///   Errors  bad_input.   Thread  one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/job/folder_lock.h"
#include "app/scene/load.h"
#include "core/base/result.h"

namespace burrhole {

/// Makes the folder, checks that a file can be written there, and takes it for this process while the lock lives. An empty name: nothing.
/// @param option that names the folder, for errors.
[[nodiscard]] Result<FolderLock> take_output_folder(const std::string& folder, const char* option = "--out");

/// @returns bad_input if the folder has a file with the name of a result, and no sign of a run of this program: a summary, a session, the bone of
/// an earlier run, the lock of one that was killed.
[[nodiscard]] Status check_is_ours(const std::string& folder);

/// @returns bad_input if a run of this scene would replace the file that its bone was read from.
[[nodiscard]] Status check_source(const LoadedScene& loaded, const std::string& folder);

struct EarlierResultsConfig {
  std::string folder;                  ///< of the outputs, locked by this run; empty: none
  std::optional<std::string> session;  ///< file of this run's session, relative to the folder; nothing: none
  std::vector<std::string> inputs;     ///< files that the run reads: they stay where they are
  bool writes_bone = true;             ///< whether this run writes bone.vdb
};

class EarlierResults {
 public:
  /// Moves the results of an earlier run into a folder of their own. A session is one of them if it is that of a run with a summary, or has
  /// the name of this run's. bad_input also if drop() would give the earlier bone the name of an input.
  [[nodiscard]] static Result<EarlierResults> set_aside(EarlierResultsConfig config);
  EarlierResults(EarlierResults&& other) noexcept;
  EarlierResults& operator=(EarlierResults&&) = delete;
  /// Puts them back unless drop() was called.
  ~EarlierResults();
  /// This run starts: the bone gets the name bone.earlier.vdb, the others are deleted. bad_input: they cannot be renamed; nothing is
  /// deleted then.
  [[nodiscard]] Status drop();
  /// This run has written all of its results, its bone among them if it writes one: the earlier bone is deleted then.
  void replaced() const;

 private:
  explicit EarlierResults(EarlierResultsConfig config) : config_(std::move(config)) {}
  [[nodiscard]] Result<std::vector<std::string>> found() const;
  /// Puts back what a run that was killed before its first step has left aside; its own files are replaced then.
  [[nodiscard]] Status put_back() const;
  [[nodiscard]] bool is_input(const std::filesystem::path& file) const;
  [[nodiscard]] std::filesystem::path aside() const;

  EarlierResultsConfig config_;
  std::vector<std::string> moved_;  // relative to the folder
};

}  // namespace burrhole
