/// app/cli/volume_source.h: a volume on the command line, in place of a scene.   Errors  bad_input, one line.   Thread  main.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "volumes/import_bone.h"

namespace burrhole::cli {

/// @returns whether an argument names a volume that exists: a folder, a .toml that describes a raw volume, or a file that is no scene.
[[nodiscard]] bool is_volume(const std::string& argument);

/// Reads a volume for a picture of all of it. Voxels that are not cubes, and more than one texture holds, are resampled to cubes.
/// @param sets assignments of keys of [volume], as "volume.unit=\"mm\"". bad_input also for a key of another table.
[[nodiscard]] Result<ImportedBone> read_volume_for_picture(const std::string& path, const std::vector<std::string>& sets);

}  // namespace burrhole::cli
