/// app/render/gl_target.h: what a picture is drawn into and read back from. Internal: only app/render's sources include it.
#pragma once

#include <vector>

#include "app/engine/view.h"
#include "app/render/footprint.h"
#include "app/render/gl_object.h"
#include "core/base/result.h"

namespace burrhole {

/// What a pixel holds: `bytes` RGBA8; `floats` RGBA32F, for blending hundreds of times; `probed` RGBA8 and four floats beside it.
enum class TargetKind { bytes, floats, probed };

/// Colour, and depth 32F; but for `floats` what rays hit, in a texture of one float.
class GlTarget {
 public:
  GlTarget() = default;
  /// @returns ErrorCode::out_of_range when the size is not in 1..the driver's limit, ErrorCode::unavailable when the driver refuses.
  [[nodiscard]] static Result<GlTarget> create(const GladGLContext& gl, int width, int height, TargetKind kind);

  [[nodiscard]] bool fits(int width, int height, TargetKind kind) const noexcept;
  void bind() const;            ///< outputs 0 picture, 1 hit, 2 probe, as far as there are
  void bind_for_light() const;  ///< the picture and the same depth alone; what rays hit can be read as the texture hits()
  [[nodiscard]] GLuint hits() const noexcept { return hits_.name(); }
  [[nodiscard]] Image read_picture() const { return read_part({Vec2i(0), Vec2i(width_, height_)}); }
  [[nodiscard]] Image read_part(const PixelRect& part) const;    ///< row 0 at the top
  [[nodiscard]] std::vector<glm::fvec4> read_probe() const;      ///< row 0 at the top; the target is probed
  void copy_depth(GLuint texture, const PixelRect& part) const;  ///< to the same place in a texture of make_depth_texture()
  [[nodiscard]] GlObject make_depth_texture() const;             ///< of its size
  [[nodiscard]] std::vector<float> read_depth() const;           ///< 0..1, row 0 at the top

 private:
  const GladGLContext* gl_ = nullptr;
  int width_ = 0, height_ = 0;
  TargetKind kind_ = TargetKind::bytes;
  GlObject framebuffer_, light_framebuffer_, color_, depth_, hits_, probe_;
};

}  // namespace burrhole
