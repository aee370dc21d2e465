#include "app/window/file_browser.h"

#include <fmt/format.h>

namespace burrhole {

FileBrowser::FileBrowser(const std::filesystem::path& folder) : selection_(std::make_unique<Selection>(choices_)) {
  list_.folder = folder;
  enter(folder);
}

bool FileBrowser::enter(const std::filesystem::path& folder) {
  auto list = list_folder(folder);
  if (!list) {
    problem_ = list.error().text();
    return false;
  }
  list_ = std::move(list).value();
  problem_.clear();
  choices_.clear();
  for (const FileLine& line : list_.lines)
    choices_.push_back({{}, line.kind == FileKind::folder && line.name != ".." ? line.name + "/" : line.name, line.about});
  if (list_.others > 0)
    choices_.push_back({{},
                        fmt::format("{} other {}", list_.others, list_.others == 1 ? "file" : "files"),
                        {},
                        "not recognised by name; `burrhole import FILE` says whether it can be read"});
  selection_ = std::make_unique<Selection>(choices_);
  if (!list_.lines.empty() && list_.lines.front().name == "..") selection_->point_at(1);
  return true;
}

std::optional<FileLine> FileBrowser::open(std::size_t line) {
  if (line >= list_.lines.size()) return std::nullopt;
  const FileLine chosen = list_.lines[line];
  if (chosen.kind != FileKind::folder) return chosen;
  if (chosen.name == "..")
    leave();
  else
    enter(chosen.path);
  return std::nullopt;
}

void FileBrowser::leave() {
  const std::filesystem::path left = list_.folder;
  if (!left.has_relative_path() || !enter(left.parent_path())) return;
  for (std::size_t n = 0; n < list_.lines.size(); ++n)
    if (list_.lines[n].path == left) selection_->point_at(n);
}

}  // namespace burrhole
