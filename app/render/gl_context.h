/// app/render/gl_context.h: an OpenGL 4.5 core context from one of three back ends, each loaded at run time with private symbols.
///   Errors  unavailable.   Thread  one owner at a time.
///   osmesa  Mesa's software renderer, needs no display and no GPU.
///   egl     EGL without a surface: a GPU where there is one, else Mesa's software renderer.
///   window  a hidden window of GLFW; needs a display.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

struct GladGLContext;

namespace burrhole {

class GlPlatform;

/// `automatic`: egl on a GPU if there is one, otherwise osmesa.
enum class GlBackend { automatic, osmesa, egl, window };

/// @returns "auto", "osmesa", "egl" or "window".
[[nodiscard]] std::string_view gl_backend_name(GlBackend backend) noexcept;
[[nodiscard]] const std::vector<GlBackend>& gl_backends();  ///< all four, automatic first

/// Owns one context. Move-only. One thread at a time uses it and calls make_current() before it uses functions(). GLFW requires the main
/// thread for create() and the destructor of a window.
class GlContext {
 public:
  /// @param width, height [pixels] of the context's own surface, 1..16384; pictures use framebuffers of their own.
  /// @returns ErrorCode::unavailable with a reason of one line: a library is missing, there is no display, the driver has no 4.5 core
  /// context, or GALLIUM_DRIVER names a driver that crashes Mesa.
  [[nodiscard]] static Result<GlContext> create(int width, int height, GlBackend backend = GlBackend::automatic);
  /// The context of an object that somebody else made, such as an interactive window. Errors as above.
  [[nodiscard]] static Result<GlContext> create(std::unique_ptr<GlPlatform> platform);
  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  [[nodiscard]] Status make_current();
  /// The function table of this context; opaque outside app/render.
  [[nodiscard]] const GladGLContext& functions() const noexcept;
  [[nodiscard]] GlBackend backend() const noexcept;           ///< the back end in use, never `automatic`
  [[nodiscard]] const std::string& version() const noexcept;  ///< version string of the driver
  [[nodiscard]] const std::string& renderer() const noexcept;
  [[nodiscard]] bool is_software() const noexcept;  ///< a renderer of Mesa on the CPU

 private:
  struct Impl;
  explicit GlContext(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
