/// app/render/glfw_library.h: the functions of GLFW, found at run time. For files that own a window; GLFW's header is included here.
///   Errors  unavailable: no library, an older one, no display.   Thread  main.
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <string>

#include "app/render/gl_platform.h"
#include "core/base/result.h"

#define BH_GLFW_FUNCTIONS(F)       \
  F(Init)                          \
  F(GetError)                      \
  F(WindowHint)                    \
  F(DefaultWindowHints)            \
  F(CreateWindow)                  \
  F(DestroyWindow)                 \
  F(MakeContextCurrent)            \
  F(SwapBuffers)                   \
  F(SwapInterval)                  \
  F(GetProcAddress)                \
  F(WaitEventsTimeout)             \
  F(SetWindowUserPointer)          \
  F(GetWindowUserPointer)          \
  F(SetKeyCallback)                \
  F(SetCharCallback)               \
  F(SetMouseButtonCallback)        \
  F(SetCursorPosCallback)          \
  F(SetScrollCallback)             \
  F(SetFramebufferSizeCallback)    \
  F(SetWindowFocusCallback)        \
  F(SetWindowCloseCallback)        \
  F(SetWindowContentScaleCallback) \
  F(SetWindowShouldClose)          \
  F(GetFramebufferSize)            \
  F(GetWindowSize)                 \
  F(GetWindowPos)                  \
  F(GetWindowContentScale)         \
  F(SetWindowMonitor)              \
  F(SetWindowSizeLimits)           \
  F(GetPrimaryMonitor)             \
  F(GetVideoMode)                  \
  F(JoystickIsGamepad)             \
  F(GetGamepadState)

namespace burrhole {

struct Glfw {
#define BH_GLFW_MEMBER(name) decltype(&glfw##name) name = nullptr;  // NOLINT(bugprone-macro-parentheses)
  BH_GLFW_FUNCTIONS(BH_GLFW_MEMBER)
#undef BH_GLFW_MEMBER

  /// The description of GLFW's last error, in one line.
  [[nodiscard]] std::string said() const;
};

/// @returns "window: " and the reason.
[[nodiscard]] Error no_window(const std::string& why);
/// Opens the library and initialises it, once and for the lifetime of the process: its window classes and its connection to the display are
/// shared. Also unavailable where GALLIUM_DRIVER names a driver that crashes Mesa.
[[nodiscard]] Result<Glfw> load_glfw();

/// From now on a lost connection to an X display sets display_lost(), where Xlib would end the process. Main thread.
void survive_display_loss();
/// Whether the connection is lost. From then on no function of GLFW may be called; a current context of software OpenGL stays usable.
/// Any thread.
[[nodiscard]] bool display_lost() noexcept;

/// The context of a window, which the window or a derived class owns.
class GlfwPlatform : public GlPlatform {
 public:
  GlfwPlatform(const Glfw& glfw, GLFWwindow* window) : glfw_(glfw), window_(window) {}
  [[nodiscard]] GlBackend backend() const noexcept override { return GlBackend::window; }
  [[nodiscard]] Status make_current() override;
  void release() override;
  [[nodiscard]] GlFunction find_function(const char* name) const override { return glfw_.GetProcAddress(name); }

 protected:
  Glfw glfw_;
  GLFWwindow* window_;
};

}  // namespace burrhole
