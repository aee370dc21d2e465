/// app/render/gl_target.h: an offscreen render target and its read-back. Internal to app/render.   Units  pixels.   Errors  out_of_range,
/// unavailable.
#pragma once

#include <vector>

#include "app/render/footprint.h"
#include "app/render/gl_object.h"
#include "app/render/read_buffer.h"
#include "app/view/view.h"
#include "core/base/result.h"

namespace burrhole {

/// Format of a pixel: `bytes` RGBA8; `marked` RGBA8 and a stencil; `shown` RGBA8 without hits; `shaded` the same with a stencil; `floats` RGBA32F, for hundreds of blend
/// operations, without hits; `probed` RGBA8 and four floats.
enum class TargetKind { bytes, marked, shown, shaded, floats, probed };

/// Colour, 32-bit float depth and, for most kinds, the hit depth of rays in a texture of one float.
class GlTarget {
 public:
  GlTarget() = default;
  /// @returns ErrorCode::out_of_range if the size is outside 1..the driver's limit, ErrorCode::unavailable if the driver rejects it.
  [[nodiscard]] static Result<GlTarget> create(const GladGLContext& gl, int width, int height, TargetKind kind);

  [[nodiscard]] bool fits(int width, int height, TargetKind kind) const noexcept;
  void bind() const;            ///< outputs 0 picture, 1 hit, 2 probe, as available
  void bind_for_light() const;  ///< picture and depth only; the hit depth can then be read as texture hits()
  [[nodiscard]] std::int64_t pixels() const noexcept { return std::int64_t{width_} * height_; }
  [[nodiscard]] GLuint hits() const noexcept { return hits_.name(); }
  [[nodiscard]] Image read_picture() const;
  /// Reads a part into `out`, row 0 at the top. @param through null: at once.
  void read_part(const PixelRect& part, ReadBuffer* through, Image& out) const;
  [[nodiscard]] std::vector<glm::fvec4> read_probe() const;  ///< row 0 at the top; @pre the target is `probed`
  /// Copies to the same position in a texture. @returns its name. @pre make_depth_copy() was called.
  GLuint copy_depth(const PixelRect& part) const;
  void copy_picture(const GlTarget& to, const PixelRect& part) const;  ///< to the same position. @pre the scissor contains the part
  void make_depth_copy();                                              ///< makes the texture for copy_depth()
  [[nodiscard]] std::vector<float> read_depth() const;                 ///< 0..1, row 0 at the top

 private:
  const GladGLContext* gl_ = nullptr;
  int width_ = 0, height_ = 0;
  TargetKind kind_ = TargetKind::bytes;
  GlObject framebuffer_, light_framebuffer_, color_, depth_, hits_, probe_, depth_copy_;
};

}  // namespace burrhole
