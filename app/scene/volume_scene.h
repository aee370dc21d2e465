/// app/scene/volume_scene.h: the [volume] table: a phantom, a bone model saved earlier, or a scan or mesh that is imported at load.
///   Units SI; keys in the file carry their unit and are converted here and nowhere else.
#pragma once

#include <optional>
#include <string>

#include "app/stage/stage_config.h"
#include "core/config/toml.h"

namespace burrhole {

/// How far below the entry the region's centre lies, along the axis: a skull is 5 to 9 mm thick.
inline constexpr double kRegionDepth = 5e-3;  // [m]

/// Pushes faults to the table's Issues. @param scene_file paths are relative to its folder; `$NAME` at their start is the environment's.
[[nodiscard]] VolumeScene read_volume(TableReader table, const std::string& scene_file);

/// "mm", "cm", "m", "in" in metres.
[[nodiscard]] const std::vector<std::string>& length_unit_names();
[[nodiscard]] double length_unit(const std::string& name);

}  // namespace burrhole
