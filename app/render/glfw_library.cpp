#include "app/render/glfw_library.h"

#include <algorithm>

namespace burrhole {

std::string Glfw::said() const {
  const char* text = nullptr;
  if (GetError(&text) == GLFW_NO_ERROR || text == nullptr) return "GLFW gives no reason";
  std::string line(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

Error no_window(const std::string& why) { return gl_unavailable("window: " + why); }

Result<Glfw> load_glfw() {
  if (const Status fit = check_gallium_driver(); !fit) return no_window(fit.error().message);
  const auto library = open_gl_library("libglfw.so.3", "libglfw3");
  if (!library) return no_window(library.error().message);
  Glfw glfw;
  bool all = true;
#define BH_GLFW_FIND(name) all = find_symbol(library.value(), "glfw" #name, glfw.name) && all;
  BH_GLFW_FUNCTIONS(BH_GLFW_FIND)
#undef BH_GLFW_FIND
  if (!all) return no_window("libglfw.so.3 lacks a function of GLFW 3.3");
  if (glfw.Init() != GLFW_TRUE) return no_window("there is no display: " + glfw.said());
  return glfw;
}

Status GlfwPlatform::make_current() {
  glfw_.MakeContextCurrent(window_);
  if (glfw_.GetError(nullptr) == GLFW_NO_ERROR) return {};
  return no_window("the driver refuses to make its context current");
}

}  // namespace burrhole
