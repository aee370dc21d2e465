/// app/scene/scene.h: a scene file as plain values and the plans of its effects. An effect exists if, and only if, its table is there.
///   Units SI; keys in the file carry their unit and are converted where they are read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/effect/registry.h"
#include "app/stage/effect.h"
#include "core/config/toml.h"

namespace burrhole {

struct Scene : StageConfig {
  EffectPlans effects;

  /// The config struct of that type, of the first effect that has one; null: there is none.
  template <class Config>
  [[nodiscard]] Config* find() noexcept {
    return effects.find<Config>();
  }
  template <class Config>
  [[nodiscard]] const Config* find() const noexcept {
    return effects.find<Config>();
  }
};

/// What reading a scene depends on beside its text.
struct SceneContext {
  std::vector<std::string> tool_folders;                ///< where names of tools are looked up, in order, after the scene's own folder
  bool tool_given = false;                              ///< the tool's text is at hand (replay): its file is not looked for
  const EffectRegistry* registry = &shipped_effects();  ///< the effects that the program knows
};

/// The path of a tool's file by its name or path, as in [tool]; nothing: there is none.
[[nodiscard]] std::optional<std::string> find_tool(const std::string& name, const std::string& scene_file, const SceneContext& context);

/// Adds a shipped effect as an empty table would; nothing happens where the scene has it. @param table of an effect of this version.
void add_effect(Scene& scene, const std::string& table);

/// @returns nothing when any issue was pushed; all faults of the file are pushed. An issue with code `unavailable` means exit code 4.
/// @param log also records which keys were asked for; may be null.
[[nodiscard]] std::optional<Scene> read_scene(const TomlDocument& document, const SceneContext& context, Issues& issues,
                                              KeyLog* log = nullptr);

}  // namespace burrhole
