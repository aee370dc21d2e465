/// app/window/glfw_window.h: a window of GLFW with an OpenGL context, its events as plain values. GLFW is opened at run time.
///   Units  pixels.   Errors  unavailable: no display, no library, no OpenGL.
///   Thread  main, except for the functions of the thread that draws.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "app/render/gl_context.h"
#include "app/window/window_event.h"
#include "core/base/result.h"

namespace burrhole {

class GlfwWindow {
 public:
  /// @param quad with a back buffer for each eye; unavailable where the driver has none.
  [[nodiscard]] static Result<GlfwWindow> create(const std::string& title, int width, int height, bool quad = false);
  GlfwWindow(GlfwWindow&&) noexcept;
  ~GlfwWindow();

  /// Receives every event, on the main thread, within wait().
  void set_handler(std::function<void(const WindowEvent&)> handler);
  /// Waits for events for `seconds` at most, and hands them on.
  void wait(double seconds);
  /// The display is gone: nothing is shown any more, and no event comes. Any thread.
  [[nodiscard]] bool is_lost() const noexcept;
  [[nodiscard]] PadState pad();
  void set_full_screen(bool full);

  // The thread that draws.
  /// The window's context, for the thread that calls. The window must outlive it. Errors as GlContext.
  [[nodiscard]] Result<GlContext> context();
  void release() noexcept;  ///< the context is current nowhere afterwards, as its end requires
  void swap() noexcept;
  void set_interval(int interval) noexcept;  ///< of swap(), in refreshes of the screen
  /// Size of the framebuffer; 0 while the window is minimised.
  [[nodiscard]] int width() const noexcept;
  [[nodiscard]] int height() const noexcept;
  [[nodiscard]] float scale() const noexcept;  ///< of texts, as the desktop asks

 private:
  struct Impl;
  explicit GlfwWindow(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace burrhole
