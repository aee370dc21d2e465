/// app/render/texture_load.h: the textures that a scene names, made or read from PNG files. No OpenGL.
///   Units  texels.   Errors  bad_input with the path and what to do; unavailable: no memory.   Thread  any: no state.
#pragma once

#include <memory>

#include "app/view/bone_texture.h"
#include "core/base/result.h"

namespace burrhole {

/// @returns the textures; null if none is named. Files are checked by their headers first (app/view/texture_file.h).
[[nodiscard]] Result<std::shared_ptr<const BoneTextures>> load_textures(const TextureConfig& config);

}  // namespace burrhole
