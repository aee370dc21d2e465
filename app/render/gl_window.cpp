// The back end window: the context of a hidden GLFW window, equal to that of an interactive window.
#include "app/render/glfw_library.h"

namespace burrhole {
namespace {

class HiddenWindow final : public GlfwPlatform {
 public:
  using GlfwPlatform::GlfwPlatform;
  ~HiddenWindow() override { glfw_.DestroyWindow(window_); }
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
  return std::unique_ptr<GlPlatform>(std::make_unique<HiddenWindow>(g, window));
}

}  // namespace burrhole
