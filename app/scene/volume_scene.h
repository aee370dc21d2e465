/// app/scene/volume_scene.h: reads the [volume] table: a phantom, a saved bone model, or a scan or mesh to be imported at load.
///   Units  SI; keys in the file carry their unit and are converted here and nowhere else.   Errors  bad_input, as issues of the table.
#pragma once

#include <optional>
#include <string>

#include "app/stage/stage_config.h"
#include "core/config/toml.h"

namespace burrhole {

/// Part of the message that a file is not there.
inline constexpr const char* kPathsCount =
    "a path in a scene counts from the scene's folder, one on the command line also from the current one";

/// [m] depth of the region's centre below the entry, along the axis; a skull is 5 to 9 mm thick.
inline constexpr double kRegionDepth = 5e-3;

/// Pushes errors to the table's Issues. @param scene_file paths are relative to its folder; `$NAME` at their start is replaced by the
/// environment variable.
[[nodiscard]] VolumeScene read_volume(TableReader table, const std::string& scene_file);

/// @returns "mm", "cm", "m", "in".
[[nodiscard]] const std::vector<std::string>& length_unit_names();
/// @returns the length of such a unit [m].
[[nodiscard]] double length_unit(const std::string& name);

}  // namespace burrhole
