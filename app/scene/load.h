/// app/scene/load.h: from a scene file to everything a run needs; one path for all commands, tests and labs.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/scene/scene.h"
#include "core/tool/tool.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

struct LoadedScene {
  Scene scene;
  std::string tool_text;  ///< TOML, for the session
  Tool tool;              ///< erosion factors already scaled
  std::shared_ptr<const BoneModel> bone;
  std::optional<ImportReport> import;  ///< when the bone came from a scan or a mesh
};

/// Beside the scene itself.
struct LoadOptions {
  std::optional<std::string> tool_text;         ///< use this instead of the tool's file (replay)
  std::function<void(double)> progress;         ///< share of a long read done, 0..1; may be empty
  std::function<void(const std::string&)> say;  ///< one line on memory before an import takes it; may be empty
};

/// A tool as a run needs it, from the text of its file. @param name for messages. @param voxel_edge [m]. @returns nothing when any issue was
/// pushed.
[[nodiscard]] std::optional<Tool> load_tool(const std::string& text, const std::string& name, const StageConfig& config, const Needs& needs,
                                            double voxel_edge, Issues& issues);
/// The text of a tool's file, as a session keeps it. @param name of a tool, or a path, as in [tool]. bad_input: no such tool.
[[nodiscard]] Result<std::string> read_tool_text(const std::string& name, const std::string& scene_file, const SceneContext& context);

/// Reads scene, bone and tool. @returns nothing when any issue was pushed.
[[nodiscard]] std::optional<LoadedScene> load_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                                    const LoadOptions& options = {});

}  // namespace burrhole
