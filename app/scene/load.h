/// app/scene/load.h: loads a scene file with its tool and bone. All commands, tests and labs use it.
///   Units  SI.   Thread  any; allocates and reads files.   Errors  bad_input of a file, unavailable for what this build lacks.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/scene/scene.h"
#include "core/tool/tool.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

struct LoadedScene {
  Scene scene;
  std::string tool_text;  ///< TOML, for the session
  Tool tool;              ///< erosion factors already scaled
  std::shared_ptr<const BoneModel> bone;
  std::uint64_t scan_bytes = 0;           ///< [bytes] of the scan from which the bone was made, and of what was needed to make it
  std::string paged_note;                 ///< one line on why the bone is in a temporary file; empty: it is in memory
  std::optional<ImportReport> import;     ///< when the bone came from a scan or a mesh
  std::vector<std::string> changes;       ///< of the scene's file by the caller: TomlDocument::changes()
  std::vector<std::string> tool_changes;  ///< of the tool's file: LoadOptions::tool_sets
};

/// The text of a tool's file.
struct ToolText {
  std::string name;  ///< for messages
  std::string text;  ///< TOML
};

/// Options of load_scene() that are not part of the scene file.
struct LoadOptions {
  std::optional<std::string> tool_text;          ///< use this instead of the tool's file (replay)
  std::vector<std::string> tool_sets{};          ///< changes of the tool's file, each as TomlDocument::set() takes it; recorded in its text
  std::function<void(double)> progress;          ///< receives the share of a long read that is done, 0..1; may be empty
  std::function<void(const std::string&)> say;   ///< receives one line on the memory that an import will allocate; may be empty
  bool live = false;                             ///< the run will be on threads: counts for [limits] memory_mb
  std::string page_folder = temporary_folder();  ///< of the temporary file of a paged bone
  /// Reads the tools that the inputs of the run change to, which count for [limits] memory_mb; empty: a run without inputs. On an error it
  /// pushes issues.
  std::function<std::vector<ToolText>(const Scene& scene, Issues& issues)> input_tools{};
};

/// Makes the tool of a run from the text of its file. @param name for messages. @param needs of the scene's effects: pitch of the erosion
/// points, cutting field. @param voxel_edge [m]. @returns nothing when any issue was pushed.
[[nodiscard]] std::optional<Tool> load_tool(const std::string& text, const std::string& name, const StageConfig& config, const Needs& needs,
                                            double voxel_edge, Issues& issues);
/// @returns the text of a tool's file as a session stores it, with absolute paths. @param name of a tool, or a path, as in [tool].
/// bad_input: no such tool, or not TOML.
[[nodiscard]] Result<std::string> read_tool_text(const std::string& name, const std::string& scene_file, const SceneContext& context);

/// @param approach gives the thickness; an approach that misses the bone leaves it unknown.
/// @returns the tools of texts, in their order. Pushes the issues of those that cannot be made.
[[nodiscard]] std::vector<Tool> load_tools(const std::vector<ToolText>& texts, const Scene& scene, double voxel_edge, Issues& issues);

[[nodiscard]] BoneShape shape_of(const BoneModel& bone, const ApproachScene& approach);

/// Reads scene, bone and tool; imports the bone where the scene names a scan. @returns nothing when any issue was pushed.
/// If a scene is predicted to need more memory than [limits] memory_mb, its bone is kept in a temporary file; if that is predicted not to be
/// enough, the scene is refused when the headers of its volume have been read.
[[nodiscard]] std::optional<LoadedScene> load_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                                    const LoadOptions& options = {});

}  // namespace burrhole
