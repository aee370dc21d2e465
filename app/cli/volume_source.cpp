#include "app/cli/volume_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "app/cli/progress.h"
#include "app/scene/volume_scene.h"
#include "core/config/toml.h"

namespace burrhole::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestScene = 1 << 20;  // [bytes]
constexpr double kMostVoxels = 30e6;               // of a picture; a little below DisplayConfig::whole_voxels
constexpr double kUneven = 1.05;                   // [-] longest over shortest edge of a voxel that is drawn as scanned

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

/// @returns the request of a [volume] table with this source and the assignments.
Result<ImportRequest> make_request(const std::string& path, const std::vector<std::string>& sets) {
  auto document = TomlDocument::parse("[volume]\nsource = " + quoted(fs::absolute(path).lexically_normal().string()) + "\n", path);
  if (!document) return document.error();
  for (const std::string& assignment : sets) {
    if (!assignment.starts_with("volume."))
      return bad_input("--set " + assignment + ": a volume has no scene, so only keys of [volume] can be set; leave it out");
    if (Status set = document->set(assignment); !set) return set.error();
  }
  Issues issues;
  TableReader root = document->root(issues);
  auto table = root.table("volume", "");
  const VolumeScene volume = read_volume(std::move(*table), path);
  if (!issues.empty()) return issues.front();
  if (!volume.scan) return bad_input("is not a volume of a file or folder: burrhole import --help lists what is read", path);
  return volume.scan->request;
}

/// @returns the edge of the cubes to which a volume is resampled; nothing if it is drawn at its own voxels.
std::optional<double> picture_spacing(const BoneGrid& grid) {
  if (grid.loaded_bytes > 0) return std::nullopt;  // a bone model is used at its own voxels
  const Mat3& linear = grid.bone_from_index.linear;
  const Vec3 edges(glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2]));
  const double least = std::min({edges.x, edges.y, edges.z}), most = std::max({edges.x, edges.y, edges.z});
  const double count = static_cast<double>(grid.dims.x) * grid.dims.y * grid.dims.z;
  if (most <= kUneven * least && count <= kMostVoxels) return std::nullopt;
  return std::max(least, std::cbrt(count * edges.x * edges.y * edges.z / kMostVoxels));
}

}  // namespace

bool is_volume(const std::string& argument) {
  std::error_code ignored;
  if (fs::is_directory(argument, ignored)) return true;
  if (!fs::is_regular_file(argument, ignored)) return false;
  if (fs::file_size(argument, ignored) > kLargestScene) return true;
  const auto document = TomlDocument::load(argument);
  if (!document) return !argument.ends_with(".toml");
  Issues none;
  const TableReader root = document->root(none);
  return root.has("dims") && !root.has("volume");
}

Result<ImportedBone> read_volume_for_picture(const std::string& path, const std::vector<std::string>& sets) {
  auto request = make_request(path, sets);
  if (!request) return request.error();
  Progress progress(false, kReadingDelay);
  if (!request->bone.spacing) {
    std::optional<BoneGrid> seen;
    ImportRequest probe = *request;
    probe.accept = [&](const BoneGrid& grid, std::uint64_t) -> Result<BoneStorage> {
      seen = grid;
      return bad_input("the shape is known");
    };
    const auto stopped = import_bone(probe, {});
    if (!seen) return stopped ? bad_input("is not a volume: burrhole import --help lists what is read", path) : stopped.error();
    request->bone.spacing = picture_spacing(*seen);
  }
  request->read.progress = [&](double share) { progress.show(share, "reading"); };
  auto bone = import_bone(*request, {});
  if (!bone) return bone.error();
  if (bone->bone->bone_voxels() == 0)
    return bad_input("has no bone to draw: give the band of its bone by --set 'volume.bone_hu=[LO, HI]'", path);
  return bone;
}

}  // namespace burrhole::cli
