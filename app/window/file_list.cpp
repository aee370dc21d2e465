#include "app/window/file_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "core/base/input_file.h"
#include "core/config/toml.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLines = 2000;
constexpr std::uintmax_t kLargestText = 1 << 20;  // [bytes] of a TOML file that is a scene or describes a raw volume

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// @returns whether a file begins as DICOM part 10 says: "DICM" after 128 bytes.
bool is_dicom(const fs::path& path) {
  constexpr std::streamoff kPreamble = 128;
  if (!check_regular_file(path.string())) return false;
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> magic{};
  return file.seekg(kPreamble) && file.read(magic.data(), magic.size()) && magic == std::array{'D', 'I', 'C', 'M'};
}

struct Ending {
  const char* ending;
  FileKind kind;
  const char* about;
};
constexpr std::array kEndings{Ending{".nii", FileKind::scan, "NIfTI"},          Ending{".nii.gz", FileKind::scan, "NIfTI"},
                              Ending{".hdr", FileKind::scan, "NIfTI"},          Ending{".nrrd", FileKind::scan, "NRRD"},
                              Ending{".nhdr", FileKind::scan, "NRRD"},          Ending{".mha", FileKind::scan, "MetaImage"},
                              Ending{".mhd", FileKind::scan, "MetaImage"},      Ending{".stl", FileKind::mesh, "closed mesh"},
                              Ending{".obj", FileKind::mesh, "closed mesh"},    Ending{".ply", FileKind::mesh, "closed mesh"},
                              Ending{".vdb", FileKind::grids, "OpenVDB volume"}};

/// @returns a TOML file that is a scene or describes a raw volume.
std::optional<FileLine> read_toml(const fs::path& path, const std::string& name) {
  std::error_code error;
  if (const auto bytes = fs::file_size(path, error); error || bytes > kLargestText) return std::nullopt;
  const auto document = TomlDocument::load(path.string());
  if (!document) return FileLine{FileKind::scene, name, "not valid: " + document.error().text(), path};
  Issues ignored;
  TableReader root = document->root(ignored);
  if (root.has("volume")) return FileLine{FileKind::scene, name, "scene: " + root.text("title", name, ""), path};
  if (root.has("dims")) return FileLine{FileKind::scan, name, "raw volume", path};
  return std::nullopt;
}

/// @returns a file as a line; nothing if it cannot be opened by itself.
std::optional<FileLine> line_of(const fs::path& path, const std::string& name) {
  const std::string low = lower(name);
  if (low.ends_with(".toml")) return read_toml(path, name);
  for (const Ending& known : kEndings)
    if (low.ends_with(known.ending)) return FileLine{known.kind, name, known.about, path};
  return std::nullopt;
}

}  // namespace

Result<FolderList> list_folder(const fs::path& folder) {
  std::error_code error;
  FolderList out;
  out.folder = fs::absolute(folder, error).lexically_normal();
  if (!out.folder.has_filename() && out.folder.has_relative_path()) out.folder = out.folder.parent_path();  // a slash at the end
  fs::directory_iterator at(out.folder, error);
  if (error) return bad_input("the folder cannot be read: " + error.message(), out.folder.string());
  std::vector<FileLine> folders, files;
  std::size_t slices = 0;
  for (; !error && at != fs::directory_iterator() && folders.size() + files.size() < kMostLines; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with('.')) continue;
    std::error_code ignored;
    const bool is_file = at->is_regular_file(ignored);
    if (at->is_directory(ignored)) {
      folders.push_back({FileKind::folder, name, "folder", at->path()});
    } else if (auto line = is_file ? line_of(at->path(), name) : std::nullopt) {
      files.push_back(std::move(*line));
    } else if (is_file && is_dicom(at->path())) {
      ++slices;
    } else {
      ++out.others;
    }
  }
  const auto by_name = [](const FileLine& line) { return lower(line.name); };
  std::ranges::sort(folders, {}, by_name);
  std::ranges::sort(files, {}, by_name);
  if (out.folder.has_relative_path()) out.lines.push_back({FileKind::folder, "..", "the folder above", out.folder.parent_path()});
  if (slices > 0)
    out.lines.push_back({FileKind::slices, "The scan in this folder and those below",
                         fmt::format("DICOM, {} {} here", slices, slices == 1 ? "file" : "files"), out.folder});
  out.lines.insert(out.lines.end(), folders.begin(), folders.end());
  out.lines.insert(out.lines.end(), files.begin(), files.end());
  return out;
}

fs::path first_folder() {
  std::error_code ignored;
  const char* const data = std::getenv("BURRHOLE_DATA");
  if (data != nullptr && fs::is_directory(data, ignored)) return data;
  return fs::current_path(ignored);
}

}  // namespace burrhole
