// The back end window: the context of a hidden GLFW window, equal to that of an interactive window.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

#include "app/render/gl_platform.h"

namespace burrhole {
namespace {

struct Glfw {
  decltype(&glfwInit) init = nullptr;
  decltype(&glfwGetError) get_error = nullptr;
  decltype(&glfwWindowHint) window_hint = nullptr;
  decltype(&glfwCreateWindow) create_window = nullptr;
  decltype(&glfwDestroyWindow) destroy_window = nullptr;
  decltype(&glfwMakeContextCurrent) make_context_current = nullptr;
  decltype(&glfwGetProcAddress) get_proc_address = nullptr;

  /// The description of GLFW's last error, in one line.
  [[nodiscard]] std::string said() const {
    const char* text = nullptr;
    if (get_error(&text) == GLFW_NO_ERROR || text == nullptr) return "GLFW gives no reason";
    std::string line(text);
    std::replace(line.begin(), line.end(), '\n', ' ');
    return line;
  }
};

Error refused(const std::string& why) { return gl_unavailable("window: " + why); }

/// GLFW stays initialised for the lifetime of the process: its window classes and its connection to the display are shared.
Result<Glfw> load_glfw() {
  const auto library = open_gl_library("libglfw.so.3", "libglfw3");
  if (!library) return refused(library.error().message);
  Glfw glfw;
  void* const lib = library.value();
  if (!find_symbol(lib, "glfwInit", glfw.init) || !find_symbol(lib, "glfwGetError", glfw.get_error) ||
      !find_symbol(lib, "glfwWindowHint", glfw.window_hint) || !find_symbol(lib, "glfwCreateWindow", glfw.create_window) ||
      !find_symbol(lib, "glfwDestroyWindow", glfw.destroy_window) ||
      !find_symbol(lib, "glfwMakeContextCurrent", glfw.make_context_current) ||
      !find_symbol(lib, "glfwGetProcAddress", glfw.get_proc_address))
    return refused("libglfw.so.3 lacks a function of GLFW 3.3");
  if (glfw.init() != GLFW_TRUE) return refused("there is no display: " + glfw.said());
  return glfw;
}

class WindowPlatform final : public GlPlatform {
 public:
  WindowPlatform(const Glfw& glfw, GLFWwindow* window) : glfw_(glfw), window_(window) {}
  ~WindowPlatform() override { glfw_.destroy_window(window_); }

  GlBackend backend() const noexcept override { return GlBackend::window; }
  Status make_current() override {
    glfw_.make_context_current(window_);
    if (glfw_.get_error(nullptr) == GLFW_NO_ERROR) return {};
    return refused("the driver refuses to make its context current");
  }
  void release() override { glfw_.make_context_current(nullptr); }
  GlFunction find_function(const char* name) const override { return glfw_.get_proc_address(name); }

 private:
  Glfw glfw_;
  GLFWwindow* window_;
};

}  // namespace

GlPlatformResult make_window_platform(int width, int height) {
  if (const Status fit = check_gallium_driver(); !fit) return refused(fit.error().message);
  const auto glfw = load_glfw();
  if (!glfw) return glfw.error();
  const Glfw& g = glfw.value();
  g.window_hint(GLFW_VISIBLE, GLFW_FALSE);
  g.window_hint(GLFW_CLIENT_API, GLFW_OPENGL_API);
  g.window_hint(GLFW_CONTEXT_VERSION_MAJOR, kGlMajor);
  g.window_hint(GLFW_CONTEXT_VERSION_MINOR, kGlMinor);
  g.window_hint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow* const window = g.create_window(width, height, "burrhole", nullptr, nullptr);
  if (window == nullptr) return refused("the display gives no OpenGL 4.5 core context: " + g.said());
  return std::unique_ptr<GlPlatform>(std::make_unique<WindowPlatform>(g, window));
}

}  // namespace burrhole
