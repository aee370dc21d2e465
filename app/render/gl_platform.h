/// app/render/gl_platform.h: interface of a back end of GlContext: makes a context current and returns addresses of its functions.
///   Internal to app/render. No OpenGL header: each back end keeps the types of its library in its own file.   Errors  unavailable.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/render/gl_context.h"

namespace burrhole {

inline constexpr int kGlMajor = 4, kGlMinor = 5;

using GlFunction = void (*)();

class GlPlatform {
 public:
  GlPlatform() = default;
  GlPlatform(const GlPlatform&) = delete;
  GlPlatform& operator=(const GlPlatform&) = delete;
  virtual ~GlPlatform() = default;
  [[nodiscard]] virtual GlBackend backend() const noexcept = 0;
  [[nodiscard]] virtual Status make_current() = 0;
  virtual void release() = 0;  ///< afterwards no context of this back end is current in this thread
  [[nodiscard]] virtual GlFunction find_function(const char* name) const = 0;
};

using GlPlatformResult = Result<std::unique_ptr<GlPlatform>>;

[[nodiscard]] GlPlatformResult make_osmesa_platform(int width, int height);
/// @returns the first GPU that provides a context; nothing if EGL has none.
[[nodiscard]] std::optional<std::unique_ptr<GlPlatform>> find_gpu_platform();
/// @returns a GPU, otherwise software without a surface.
[[nodiscard]] GlPlatformResult make_egl_platform();
[[nodiscard]] GlPlatformResult make_window_platform(int width, int height);

// Shared by the back ends.
[[nodiscard]] Error gl_unavailable(std::string message);
/// @returns an error if GALLIUM_DRIVER names an unknown driver, which crashes Mesa, or softpipe, which has no 4.5 core context.
[[nodiscard]] Status check_gallium_driver();
/// Opens a library for the lifetime of the process: threads and statics of a driver do not permit unloading. @param package name of the
/// Debian package.
[[nodiscard]] Result<void*> open_gl_library(const char* file, const char* package);
[[nodiscard]] void* find_symbol(void* library, const char* name);

/// @returns whether the symbol was found.
template <class F>
[[nodiscard]] bool find_symbol(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(find_symbol(library, name));
  return function != nullptr;
}

}  // namespace burrhole
