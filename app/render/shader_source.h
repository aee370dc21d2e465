/// app/render/shader_source.h: shader texts, the include and define expander, and the list of every variant that may be linked.
///   No OpenGL here: the build-time tool and the driver both use this file, so what was validated is what runs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "app/engine/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Text of each file of shaders/, by file name.
using ShaderFiles = std::map<std::string, std::string, std::less<>>;

/// One program: its two stages and the names that are defined while they are expanded.
struct ShaderVariant {
  std::string name;
  std::string vertex;
  std::string fragment;
  std::vector<std::string> defines;
};

/// What rays to the surface call for; each choice that is off is not in the expanded source.
struct RaycastChoice {
  bool cut = false;    ///< part of the volume is cut away
  bool skip = false;   ///< empty space is skipped by the distance map
  bool probe = false;  ///< hit positions and sample counts come beside the picture
};

/// The same for the light on what they hit.
struct SurfaceChoice {
  bool cut = false;
  bool soft = false;    ///< the volume holds dura or brain
  bool finish = false;  ///< smoothed normals and soft highlights
  LookView looks{.labels = false};
};

/// The same for slices.
struct SlicesChoice {
  bool cut = false;
  bool correct = false;  ///< opacity corrected for the distance between slices
  bool labels = false;
  NormalSource normals = NormalSource::texture;
};

/// The same for translucent bone.
struct TranslucentChoice {
  bool cut = false;
  bool soft = false;
  bool skip = false;
  bool probe = false;
  bool labels = false;
  bool tint = false;  ///< the transfer function has a tint
};

[[nodiscard]] ShaderVariant raycast_variant(const RaycastChoice& choice);
[[nodiscard]] ShaderVariant surface_variant(const SurfaceChoice& choice);
[[nodiscard]] ShaderVariant translucent_variant(const TranslucentChoice& choice);
[[nodiscard]] ShaderVariant slices_variant(const SlicesChoice& choice);
[[nodiscard]] ShaderVariant tool_variant(bool probe);
[[nodiscard]] ShaderVariant background_variant();
/// The build validates and a test links each: all choices of what is drawn, without looks, with those of a scene that names none and with
/// all of them, and each look alone and left out.
[[nodiscard]] std::vector<ShaderVariant> all_shader_variants();

/// The text the driver gets: #version 450, one #define a name, then `file` with each `#include "name"` line replaced by that file and with
/// `#ifdef`, `#ifndef`, `#else` and `#endif` decided: of a branch that is not taken nothing is left but empty lines.
/// @returns ErrorCode::bad_input with file and line when a file is missing or includes itself, or a branch is not closed.
[[nodiscard]] Result<std::string> expand_shader(const ShaderFiles& files, std::string_view file, const std::vector<std::string>& defines);

/// The first fault in a driver's log of such a text, its place in words: file, line and, where the driver tells it, column.
[[nodiscard]] Error shader_fault(const ShaderFiles& files, std::string_view log);

/// The shaders as built in.
[[nodiscard]] const ShaderFiles& embedded_shaders();
/// Shaders from a folder (*.glsl, *.vert, *.frag). @returns ErrorCode::bad_input when it cannot be read or holds none.
[[nodiscard]] Result<ShaderFiles> read_shader_folder(const std::filesystem::path& folder);

}  // namespace burrhole
