/// app/scene/scene.h: a scene file as plain values and the plans of its effects. An effect exists if, and only if, the file has its table.
///   Units  SI; keys in the file carry their unit and are converted where they are read.   Thread  any.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/effect/registry.h"
#include "app/stage/effect.h"
#include "core/config/toml.h"
#include "core/measure/outcome_limits.h"

namespace burrhole {

/// [output]: files that a run writes into its folder besides summary.json. Pictures and session have tables of their own.
struct OutputScene {
  bool bone = true;        ///< bone.vdb, from which a later run can start
  bool whole_bone = true;  ///< it holds the bone as loaded too; false: only what was changed
  bool report = true;      ///< report.html
  bool plots = true;       ///< the plot of force, depth and speed over time in the report
};

struct Scene : StageConfig {
  EffectPlans effects;
  OutputScene output;
  OutcomeLimits outcome;  ///< [outcome]: limits of the flags of the result

  /// @returns the config struct of type Config of the first effect that has one; null if no effect has one.
  template <class Config>
  [[nodiscard]] Config* find() noexcept {
    return effects.find<Config>();
  }
  template <class Config>
  [[nodiscard]] const Config* find() const noexcept {
    return effects.find<Config>();
  }
};

/// What the reading of a scene depends on, apart from its text.
struct SceneContext {
  std::vector<std::string> tool_folders;                ///< searched in order for names of tools, after the scene's own folder
  bool tool_given = false;                              ///< true: the caller has the tool's text (replay), and its file is not searched for
  const EffectRegistry* registry = &shipped_effects();  ///< the known effects
};

/// @returns why a name that ends as a mesh does is no tool, and what to do; empty: it does not.
[[nodiscard]] std::optional<std::string> mesh_as_tool(const std::string& name);
/// @returns "not found in FOLDER, FOLDER; did you mean ...?", for a name that find_tool() does not find.
[[nodiscard]] std::string tool_not_found(const std::string& name, const std::string& scene_file, const SceneContext& context);

/// @returns the path of a tool's file by its name or path, as in [tool]; nothing if there is no such file.
[[nodiscard]] std::optional<std::string> find_tool(const std::string& name, const std::string& scene_file, const SceneContext& context);

/// Adds a shipped effect with its defaults, as an empty table does; no operation if the scene has it. @param table of a shipped
/// effect.
void add_effect(Scene& scene, const std::string& table);

/// Pushes every error of the file, not only the first. @returns nothing if an issue was pushed. Codes: out_of_range for numbers outside
/// their range; unavailable (exit code 4) for hand.kind = "device", which needs hardware; bad_input for all others, also for words of
/// later versions.
/// @param log records the keys that were read; may be null.
[[nodiscard]] std::optional<Scene> read_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                              KeyLog* log = nullptr);

}  // namespace burrhole
