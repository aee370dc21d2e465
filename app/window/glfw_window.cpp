#include "app/window/glfw_window.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "app/render/glfw_library.h"

namespace burrhole {
namespace {

constexpr int kLeastWidth = 480, kLeastHeight = 320;

}  // namespace

struct GlfwWindow::Impl {
  Glfw glfw;
  GLFWwindow* window = nullptr;
  std::function<void(const WindowEvent&)> handler;
  std::atomic<int> pixels_wide{1}, pixels_high{1};
  std::atomic<float> text_scale{1.0f};
  double pointer_x = 0.0, pointer_y = 0.0;  // [pixels] of the framebuffer
  int window_x = 0, window_y = 0, window_width = 1280, window_height = 800;
  bool full = false;

  ~Impl() {
    if (window != nullptr && !display_lost()) glfw.DestroyWindow(window);
  }
  void send(const WindowEvent& event) const {
    if (handler) handler(event);
  }
  void listen();
  [[nodiscard]] static Impl& of(GLFWwindow* window);
};

namespace {
/// @returns whether the display gives a window of the last hints without stereo.
bool lacks_stereo(const Glfw& glfw, const std::string& title) {
  glfw.WindowHint(GLFW_STEREO, GLFW_FALSE);
  glfw.WindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* const plain = glfw.CreateWindow(kLeastWidth, kLeastHeight, title.c_str(), nullptr, nullptr);
  if (plain != nullptr) glfw.DestroyWindow(plain);
  return plain != nullptr;
}

// GLFW hands a callback the window alone, and its pointer is read by a function that was found at run time.
decltype(&glfwGetWindowUserPointer) pointer_of = nullptr;
}  // namespace

GlfwWindow::Impl& GlfwWindow::Impl::of(GLFWwindow* window) { return *static_cast<Impl*>(pointer_of(window)); }

void GlfwWindow::Impl::listen() {
  using Kind = WindowEvent::Kind;
  pointer_of = glfw.GetWindowUserPointer;
  glfw.SetWindowUserPointer(window, this);
  glfw.SetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action != GLFW_REPEAT && key != GLFW_KEY_UNKNOWN) of(w).send({.kind = Kind::key, .code = key, .down = action == GLFW_PRESS});
  });
  glfw.SetCharCallback(window, [](GLFWwindow* w, unsigned code) { of(w).send({.kind = Kind::character, .code = static_cast<int>(code)}); });
  glfw.SetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) {
    const Impl& impl = of(w);
    impl.send({.kind = Kind::button, .code = button, .down = action == GLFW_PRESS, .x = impl.pointer_x, .y = impl.pointer_y});
  });
  glfw.SetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    Impl& impl = of(w);
    int width = 1, height = 1;  // of the window in its own units, which are not pixels on every desktop
    impl.glfw.GetWindowSize(w, &width, &height);
    impl.pointer_x = x * impl.pixels_wide / std::max(1, width);
    impl.pointer_y = y * impl.pixels_high / std::max(1, height);
    impl.send({.kind = Kind::motion, .x = impl.pointer_x, .y = impl.pointer_y});
  });
  glfw.SetScrollCallback(window, [](GLFWwindow* w, double x, double y) { of(w).send({.kind = Kind::scroll, .x = x, .y = y}); });
  glfw.SetFramebufferSizeCallback(window, [](GLFWwindow* w, int width, int height) {
    Impl& impl = of(w);
    impl.pixels_wide = width;
    impl.pixels_high = height;
    impl.send({.kind = Kind::size, .x = static_cast<double>(width), .y = static_cast<double>(height)});
  });
  glfw.SetWindowFocusCallback(window, [](GLFWwindow* w, int focused) { of(w).send({.kind = Kind::focus, .down = focused != 0}); });
  glfw.SetWindowContentScaleCallback(window, [](GLFWwindow* w, float x, float) { of(w).text_scale = x; });
  glfw.SetWindowCloseCallback(window, [](GLFWwindow* w) {
    of(w).glfw.SetWindowShouldClose(w, GLFW_FALSE);  // the program decides
    of(w).send({.kind = Kind::close});
  });
}

GlfwWindow::GlfwWindow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GlfwWindow::GlfwWindow(GlfwWindow&&) noexcept = default;
GlfwWindow::~GlfwWindow() = default;

Result<GlfwWindow> GlfwWindow::create(const std::string& title, int width, int height, bool quad) {
  auto glfw = load_glfw();
  if (!glfw) return glfw.error();
  auto impl = std::make_unique<Impl>();
  impl->glfw = *glfw;
  const Glfw& g = impl->glfw;
  g.DefaultWindowHints();
  g.WindowHint(GLFW_CONTEXT_VERSION_MAJOR, kGlMajor);
  g.WindowHint(GLFW_CONTEXT_VERSION_MINOR, kGlMinor);
  g.WindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  g.WindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  g.WindowHint(GLFW_STEREO, quad ? GLFW_TRUE : GLFW_FALSE);  // a hard constraint: GLFW makes no window without it
  impl->window = g.CreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (impl->window == nullptr && quad && lacks_stereo(g, title))
    return no_window("the driver has no quad-buffered stereo (--stereo side-by-side or --stereo anaglyph shows two eyes without it)");
  if (impl->window == nullptr) return no_window("the display gives no OpenGL 4.5 core context: " + g.said());
  g.SetWindowSizeLimits(impl->window, kLeastWidth, kLeastHeight, GLFW_DONT_CARE, GLFW_DONT_CARE);
  impl->listen();
  survive_display_loss();
  int w = 1, h = 1;
  g.GetFramebufferSize(impl->window, &w, &h);
  impl->pixels_wide = w;
  impl->pixels_high = h;
  float scale = 1.0f;
  g.GetWindowContentScale(impl->window, &scale, nullptr);
  impl->text_scale = scale;
  return GlfwWindow(std::move(impl));
}

void GlfwWindow::set_handler(std::function<void(const WindowEvent&)> handler) { impl_->handler = std::move(handler); }
void GlfwWindow::wait(double seconds) {
  if (display_lost())
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  else
    impl_->glfw.WaitEventsTimeout(seconds);
}
bool GlfwWindow::is_lost() const noexcept { return display_lost(); }

PadState GlfwWindow::pad() {
  if (display_lost()) return {};
  for (int n = GLFW_JOYSTICK_1; n <= GLFW_JOYSTICK_LAST; ++n) {
    GLFWgamepadstate s;
    if (impl_->glfw.JoystickIsGamepad(n) != GLFW_TRUE || impl_->glfw.GetGamepadState(n, &s) != GLFW_TRUE) continue;
    const auto axis = [&](int which) { return static_cast<double>(s.axes[which]); };
    const auto trigger = [&](int which) { return 0.5 * (axis(which) + 1.0); };  // GLFW: -1 released .. 1
    const auto button = [&](int which) { return s.buttons[which] == GLFW_PRESS; };
    return {.present = true,
            .left_x = axis(GLFW_GAMEPAD_AXIS_LEFT_X),
            .left_y = axis(GLFW_GAMEPAD_AXIS_LEFT_Y),
            .right_x = axis(GLFW_GAMEPAD_AXIS_RIGHT_X),
            .right_y = axis(GLFW_GAMEPAD_AXIS_RIGHT_Y),
            .left_trigger = trigger(GLFW_GAMEPAD_AXIS_LEFT_TRIGGER),
            .right_trigger = trigger(GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER),
            .a = button(GLFW_GAMEPAD_BUTTON_A),
            .b = button(GLFW_GAMEPAD_BUTTON_B),
            .x = button(GLFW_GAMEPAD_BUTTON_X),
            .y = button(GLFW_GAMEPAD_BUTTON_Y),
            .start = button(GLFW_GAMEPAD_BUTTON_START),
            .left_bumper = button(GLFW_GAMEPAD_BUTTON_LEFT_BUMPER),
            .right_bumper = button(GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER)};
  }
  return {};
}

void GlfwWindow::set_full_screen(bool full) {
  if (full == impl_->full || display_lost()) return;
  const Glfw& g = impl_->glfw;
  GLFWmonitor* const monitor = g.GetPrimaryMonitor();
  const GLFWvidmode* const mode = monitor != nullptr ? g.GetVideoMode(monitor) : nullptr;
  if (mode == nullptr) return;
  impl_->full = full;
  if (full) {
    g.GetWindowPos(impl_->window, &impl_->window_x, &impl_->window_y);
    g.GetWindowSize(impl_->window, &impl_->window_width, &impl_->window_height);
    g.SetWindowMonitor(impl_->window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
  } else {
    g.SetWindowMonitor(impl_->window, nullptr, impl_->window_x, impl_->window_y, impl_->window_width, impl_->window_height, GLFW_DONT_CARE);
  }
}

Result<GlContext> GlfwWindow::context() { return GlContext::create(std::make_unique<GlfwPlatform>(impl_->glfw, impl_->window)); }
void GlfwWindow::release() noexcept {
  if (!display_lost()) impl_->glfw.MakeContextCurrent(nullptr);
}
void GlfwWindow::swap() noexcept {
  if (!display_lost()) impl_->glfw.SwapBuffers(impl_->window);
}
void GlfwWindow::set_interval(int interval) noexcept {
  if (!display_lost()) impl_->glfw.SwapInterval(interval);
}
int GlfwWindow::width() const noexcept { return impl_->pixels_wide; }
int GlfwWindow::height() const noexcept { return impl_->pixels_high; }
float GlfwWindow::scale() const noexcept { return impl_->text_scale; }

}  // namespace burrhole
