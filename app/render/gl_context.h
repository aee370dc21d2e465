/// app/render/gl_context.h: an OpenGL 4.5 core context without a display (OSMesa, loaded privately at run time).
#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"

struct GladGLContext;

namespace burrhole {

/// Owns one context. Move-only; one owner thread at a time, which calls make_current() before it uses functions().
class GlContext {
 public:
  /// @param width, height [pixels] of the context's own surface, 1..16384; pictures use framebuffers of their own.
  /// @returns ErrorCode::unavailable when the library is absent, has no 4.5 core context, or GALLIUM_DRIVER names a driver it cannot run.
  [[nodiscard]] static Result<GlContext> create(int width, int height);
  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  [[nodiscard]] Status make_current();
  /// The functions of this context; opaque outside app/render.
  [[nodiscard]] const GladGLContext& functions() const noexcept;
  [[nodiscard]] const std::string& version() const noexcept;  ///< as the driver states it
  [[nodiscard]] const std::string& renderer() const noexcept;

 private:
  struct Impl;
  explicit GlContext(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
