/// app/engine/load.h: from a scene file to everything a run needs; one path for all commands, tests and labs.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/engine/scene.h"
#include "core/tool/tool.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

struct LoadedScene {
  Scene scene;
  std::string tool_text;  ///< TOML, for the session
  Tool tool;              ///< erosion factors already scaled
  std::shared_ptr<const BoneModel> bone;
};

/// Reads scene, bone and tool. @returns nothing when any issue was pushed. `tool_text`: use this instead of the tool's file (replay).
[[nodiscard]] std::optional<LoadedScene> load_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                                    const std::optional<std::string>& tool_text = std::nullopt);

}  // namespace burrhole
