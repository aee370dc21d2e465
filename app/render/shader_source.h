/// app/render/shader_source.h: shader texts, expansion of includes and defines, and the list of all variants that may be linked.
///   No OpenGL: build-time tool and program use this file, so the validated text is the one that runs.   Errors  bad_input.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Text of each file of shaders/, by file name.
using ShaderFiles = std::map<std::string, std::string, std::less<>>;

/// One program: its two stages and the names defined for them.
struct ShaderVariant {
  std::string name;
  std::string vertex;
  std::string fragment;
  std::vector<std::string> defines;
};

/// Part of a bone that a program draws: all of it in one volume; or the whole at coarser voxels, without the box of the detail; or the detail.
enum class VolumeLevel { only, whole, detail };

/// Options of rays to the surface; a disabled option is not in the expanded source.
struct RaycastChoice {
  bool cut = false;    ///< part of the volume is cut away
  bool skip = false;   ///< empty space is skipped by the distance map
  bool probe = false;  ///< writes hit positions and sample counts beside the picture
  bool table = false;  ///< the background has a table
  bool fog = false;
  VolumeLevel level = VolumeLevel::only;
};

/// Options of the light on the surface that rays hit.
struct SurfaceChoice {
  bool cut = false;
  bool soft = false;    ///< the volume contains dura or brain
  bool finish = false;  ///< smoothed normals and soft highlights
  bool fog = false;
  bool tool_shadow = false;  ///< the hits lie in the shadow of the tool
  Appearance appearance{.labels = false};
  VolumeLevel level = VolumeLevel::only;
};

/// Options of slices.
struct SlicesChoice {
  bool cut = false;
  bool correct = false;  ///< opacity corrected for the distance between slices
  bool labels = false;
  bool fog = false;
  NormalSource normals = NormalSource::texture;
};

/// Options of translucent bone.
struct TranslucentChoice {
  bool cut = false;
  bool soft = false;
  bool skip = false;
  bool probe = false;
  bool labels = false;
  bool tint = false;  ///< the transfer function has a tint
  bool fog = false;
};

/// Options of the skin.
struct SkinChoice {
  bool cut = false;
  bool fog = false;
  bool rim = false;  ///< the cut edge of the opening
};

/// The tool, and what effects add: into the picture of the bone, with a probe or not; or over a copy of it.
enum class ToolPass { picture, probe, layer };

/// Options of triangles.
struct MeshChoice {
  bool cut = false;
  bool probe = false;
  bool finish = false;
  bool specular = false;
  bool fog = false;
  bool exterior = false;  ///< a texture on the surface as loaded
  bool interior = false;  ///< a texture where bone was cut
};

/// Options of what effects add.
struct AddedChoice {
  ToolPass pass = ToolPass::picture;
  bool cut = false;
  bool fog = false;
  bool wet = false;  ///< part of it mirrors the room
};

[[nodiscard]] ShaderVariant raycast_variant(const RaycastChoice& choice);
[[nodiscard]] ShaderVariant surface_variant(const SurfaceChoice& choice);
/// Marks the hits whose ambient occlusion may have changed; the appearance counts for their normals only.
[[nodiscard]] ShaderVariant stale_occlusion_variant(const SurfaceChoice& choice);
[[nodiscard]] ShaderVariant translucent_variant(const TranslucentChoice& choice);
[[nodiscard]] ShaderVariant slices_variant(const SlicesChoice& choice);
[[nodiscard]] ShaderVariant added_variant(const AddedChoice& choice);
[[nodiscard]] ShaderVariant tool_variant(ToolPass pass, bool fog = false);
/// Depths of the tool seen from the light.
[[nodiscard]] ShaderVariant tool_depth_variant();
/// Marks the hits in the shadow of the tool.
[[nodiscard]] ShaderVariant tool_shadow_variant();
[[nodiscard]] ShaderVariant background_variant(bool table = false, bool fog = false);
[[nodiscard]] ShaderVariant skin_variant(const SkinChoice& choice);
[[nodiscard]] ShaderVariant mesh_variant(const MeshChoice& choice);
/// The build validates and a test links each of these: all options of the drawing method, without appearance options, with those of a
/// default scene and with all, and each appearance option alone and left out; fog with each method, with the default scene's options and with
/// all; the shadow of the tool with each surface that has shadows.
[[nodiscard]] std::vector<ShaderVariant> all_shader_variants();

/// @returns the text for the driver: #version 450, one #define per name, then `file` with each `#include "name"` line replaced by that file
/// and with `#ifdef`, `#ifndef`, `#else` and `#endif` evaluated; a branch not taken becomes empty lines.
/// ErrorCode::bad_input with file and line if a file is missing or includes itself, or a branch is not closed.
[[nodiscard]] Result<std::string> expand_shader(const ShaderFiles& files, std::string_view file, const std::vector<std::string>& defines);

/// @returns the first error in a driver's log of such a text, with its place: file, line and, if the driver reports it, column.
[[nodiscard]] Error shader_error(const ShaderFiles& files, std::string_view log);

/// The built-in shaders.
[[nodiscard]] const ShaderFiles& embedded_shaders();
/// Reads shaders from a folder (*.glsl, *.vert, *.frag). @returns ErrorCode::bad_input if it cannot be read or has none.
[[nodiscard]] Result<ShaderFiles> read_shader_folder(const std::filesystem::path& folder);

}  // namespace burrhole
