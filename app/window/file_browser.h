/// app/window/file_browser.h: the folder that a person sees, as a list of choices. It knows no window.
///   Errors  none: problem() is one line for the person, and the list stays as it was.   Thread  one at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/window/file_list.h"
#include "app/window/selection.h"

namespace burrhole {

class FileBrowser {
 public:
  /// Shows the folder, or problem() and an empty list.
  explicit FileBrowser(const std::filesystem::path& folder);
  FileBrowser(const FileBrowser&) = delete;
  FileBrowser& operator=(const FileBrowser&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return list_.folder; }
  [[nodiscard]] std::span<const Choice> choices() const noexcept { return choices_; }
  [[nodiscard]] Selection& selection() noexcept { return *selection_; }
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  void set_problem(const std::string& line) { problem_ = line; }
  /// Opens a line: a folder is shown. @returns the line if it is a file, or the slices of a folder.
  std::optional<FileLine> open(std::size_t line);
  /// Shows the folder above, with the folder that was left as the chosen line.
  void leave();

 private:
  bool enter(const std::filesystem::path& folder);
  FolderList list_;
  std::vector<Choice> choices_;
  std::unique_ptr<Selection> selection_;  // of choices_
  std::string problem_;
};

}  // namespace burrhole
