/// app/render/bone_paint.h: the textures of a mesh of bone in GPU memory, and their maps from the bone frame. Internal to app/render.
///   Frame  bone frame.   Units  m, texels.   Errors  out_of_range beyond the driver's limit; unavailable: the driver has no memory.
#pragma once

#include <cstdint>

#include "app/render/gl_object.h"
#include "app/view/bone_texture.h"
#include "core/base/result.h"

namespace burrhole {

class BonePaint {
 public:
  /// @param box of the bone as loaded, bone frame.
  [[nodiscard]] static Result<BonePaint> create(const GladGLContext& gl, const BoneTextures& textures, const Bounds& box);
  void bind() const;                                                     ///< texture units 2 and 3, uniform block 1
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }  ///< sent, without coarser levels

 private:
  const GladGLContext* gl_ = nullptr;
  GlObject exterior_, interior_, maps_;
  std::uint64_t bytes_ = 0;
};

}  // namespace burrhole
