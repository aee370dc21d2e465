/// app/render/gl_target.h: what a picture is drawn into and read back from. Internal: only app/render's sources include it.
#pragma once

#include <vector>

#include "app/engine/view.h"
#include "app/render/gl_object.h"
#include "core/base/result.h"

namespace burrhole {

/// Colour RGBA8, depth 32F and, when asked for, a float probe of four values a pixel.
class GlTarget {
 public:
  GlTarget() = default;
  /// @returns ErrorCode::out_of_range when the size is not in 1..the driver's limit, ErrorCode::unavailable when the driver refuses.
  [[nodiscard]] static Result<GlTarget> create(const GladGLContext& gl, int width, int height, bool with_probe);

  [[nodiscard]] bool fits(int width, int height, bool with_probe) const noexcept;
  void bind() const;
  [[nodiscard]] Image read_picture() const;                  ///< row 0 at the top
  [[nodiscard]] std::vector<glm::fvec4> read_probe() const;  ///< row 0 at the top; the target has a probe

 private:
  const GladGLContext* gl_ = nullptr;
  int width_ = 0, height_ = 0;
  GlObject framebuffer_, color_, depth_, probe_;
};

}  // namespace burrhole
