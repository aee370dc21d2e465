// The back end window: the context of a hidden GLFW window, equal to that of an interactive window.
#include "app/render/gl_platform.h"
#include "app/render/glfw_library.h"

namespace burrhole {
namespace {

class WindowPlatform final : public GlPlatform {
 public:
  WindowPlatform(const Glfw& glfw, GLFWwindow* window) : glfw_(glfw), window_(window) {}
  ~WindowPlatform() override { glfw_.DestroyWindow(window_); }

  GlBackend backend() const noexcept override { return GlBackend::window; }
  Status make_current() override {
    glfw_.MakeContextCurrent(window_);
    if (glfw_.GetError(nullptr) == GLFW_NO_ERROR) return {};
    return no_window("the driver refuses to make its context current");
  }
  void release() override { glfw_.MakeContextCurrent(nullptr); }
  GlFunction find_function(const char* name) const override { return glfw_.GetProcAddress(name); }

 private:
  Glfw glfw_;
  GLFWwindow* window_;
};

}  // namespace

GlPlatformResult make_window_platform(int width, int height) {
  const auto glfw = load_glfw();
  if (!glfw) return glfw.error();
  const Glfw& g = glfw.value();
  g.DefaultWindowHints();
  g.WindowHint(GLFW_VISIBLE, GLFW_FALSE);
  g.WindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
  g.WindowHint(GLFW_CONTEXT_VERSION_MAJOR, kGlMajor);
  g.WindowHint(GLFW_CONTEXT_VERSION_MINOR, kGlMinor);
  g.WindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow* const window = g.CreateWindow(width, height, "burrhole", nullptr, nullptr);
  if (window == nullptr) return no_window("the display gives no OpenGL 4.5 core context: " + g.said());
  return std::unique_ptr<GlPlatform>(std::make_unique<WindowPlatform>(g, window));
}

}  // namespace burrhole
