/// app/render/gl_platform.h: what a back end of GlContext gives: a context to make current and the addresses of its functions.
///   Internal to app/render. No OpenGL header: each back end keeps its library's types in its own file.
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
  virtual void release() = 0;  ///< no context of this back end is current in this thread afterwards
  [[nodiscard]] virtual GlFunction find_function(const char* name) const = 0;
};

using GlPlatformResult = Result<std::unique_ptr<GlPlatform>>;

[[nodiscard]] GlPlatformResult make_osmesa_platform(int width, int height);
/// The first GPU that gives a context. Nothing where EGL knows none.
[[nodiscard]] std::optional<std::unique_ptr<GlPlatform>> find_gpu_platform();
/// A GPU, else software without a surface.
[[nodiscard]] GlPlatformResult make_egl_platform();
[[nodiscard]] GlPlatformResult make_window_platform(int width, int height);

/// What the back ends share.
[[nodiscard]] Error gl_unavailable(std::string message);
/// Mesa crashes on a driver name it does not know, and its softpipe has no 4.5 core context. @returns the refusal, if any.
[[nodiscard]] Status check_gallium_driver();
/// Opens a library for the life of the process: a driver's threads and statics do not survive an unload. `package` is Debian's.
[[nodiscard]] Result<void*> open_gl_library(const char* file, const char* package);
[[nodiscard]] void* find_symbol(void* library, const char* name);

/// @returns whether the symbol was found.
template <class F>
[[nodiscard]] bool find_symbol(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(find_symbol(library, name));
  return function != nullptr;
}

}  // namespace burrhole
