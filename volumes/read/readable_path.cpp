#include "volumes/read/readable_path.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "core/config/toml.h"
#include "volumes/read/byte_stream.h"
#include "volumes/read/dicom_elements.h"
#include "volumes/read/number_text.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

constexpr std::array kEndings{".nii", ".nii.gz", ".hdr", ".hdr.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".stl", ".obj", ".ply", ".vdb"};
constexpr std::size_t kSniffed = 132;             // [bytes] of the magic text of DICOM and what precedes it
constexpr int kMostSniffed = 2000;                // files
constexpr std::uintmax_t kLargestText = 1 << 20;  // [bytes] of a .toml that describes a raw volume
constexpr std::size_t kMostNamed = 5;

bool describes_raw_volume(const fs::path& path) {
  std::error_code error;
  if (const auto bytes = fs::file_size(path, error); error || bytes > kLargestText) return false;
  const auto document = TomlDocument::load(path.string());
  if (!document) return false;
  Issues ignored;
  const TableReader root = document->root(ignored);
  return root.has("dims") && !root.has("volume");
}

bool is_volume(const fs::path& path) {
  const std::string name = lower(path.filename().string());
  if (name.ends_with(".toml")) return describes_raw_volume(path);
  return std::ranges::any_of(kEndings, [&](const char* ending) { return name.ends_with(ending); });
}

bool is_dicom(const fs::path& path) {
  const auto head = read_head(path.string(), false, kSniffed);
  return head && starts_like_dicom(*head);
}

/// Also in the folders below, as the reader of DICOM does.
bool holds_dicom(const fs::path& folder, const std::vector<fs::path>& volumes) {
  std::error_code error;
  int left = kMostSniffed;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end && left > 0; at.increment(error)) {
    std::error_code ignored;
    if (!at->is_regular_file(ignored) || std::ranges::find(volumes, at->path()) != volumes.end()) continue;
    --left;
    if (is_dicom(at->path())) return true;
  }
  return false;
}

}  // namespace

Result<std::string> readable_path(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return path;
  std::vector<fs::path> volumes;
  for (fs::directory_iterator at(path, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (!at->path().filename().string().starts_with('.') && at->is_regular_file(ignored) && is_volume(at->path()))
      volumes.push_back(at->path());
  }
  if (volumes.empty() || holds_dicom(path, volumes)) return path;
  if (volumes.size() == 1) return volumes.front().string();
  std::ranges::sort(volumes);
  std::vector<std::string> names;
  for (const fs::path& volume : volumes)
    if (names.size() < kMostNamed) names.push_back(volume.filename().string());
  return bad_input(fmt::format("the folder holds {} volumes: name one of them: {}{}", volumes.size(), fmt::join(names, ", "),
                               volumes.size() > kMostNamed ? ", ..." : ""),
                   path);
}

}  // namespace burrhole
