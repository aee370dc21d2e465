/// app/cli/given_paths.h: files that a person means by less than their path.   Thread  any.   Errors  none.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "app/cli/commands.h"
#include "app/stage/result_files.h"

namespace burrhole::cli {

/// @returns the file NAME.toml of the current folder for the name of a tool that is not shipped; empty if there is none.
[[nodiscard]] inline std::string tool_file_here(const std::string& name) {
  std::error_code ignored;
  const std::string file = name + ".toml";
  const std::vector<std::string> shipped = shipped_names("tools");
  const bool plain = !name.empty() && name.find_first_of("/\"' ") == std::string::npos && !name.ends_with(".toml");
  return plain && std::ranges::find(shipped, name) == shipped.end() && std::filesystem::is_regular_file(file, ignored) ? file
                                                                                                                       : std::string();
}

/// @returns the bone in a folder of results, or `restore` itself: what --restore reads.
[[nodiscard]] inline std::string bone_of(const std::string& restore) {
  std::error_code ignored;
  const std::filesystem::path bone = std::filesystem::path(restore) / kBoneFile;
  const bool in_folder = std::filesystem::is_directory(restore, ignored) && std::filesystem::exists(bone, ignored);
  return in_folder ? bone.string() : restore;
}

}  // namespace burrhole::cli
