#include "app/render/glfw_library.h"

#include <algorithm>
#include <atomic>

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

namespace {

std::atomic<bool> lost{false};
thread_local GLFWwindow* current = nullptr;

// In place of Xlib's, which both end the process. The function of Xlib that met the loss then returns.
int note_loss(void*) {
  lost.store(true, std::memory_order_release);
  return 0;
}
// Xlib leaves its display locked for a process that ends; other threads would wait for ever.
void go_on(void* display, void* unlock) { reinterpret_cast<void (*)(void*)>(unlock)(display); }

}  // namespace

void survive_display_loss() {
  // Xlib's own names, without its header: `Display*` is a pointer here. Without them (an older Xlib, Wayland) a loss ends the process.
  using GetDisplay = void* (*)();
  using SetHandler = void* (*)(int (*handler)(void* display));
  using SetExit = void (*)(void* display, void (*handler)(void* display, void* data), void* data);
  const auto glfw = open_gl_library("libglfw.so.3", "libglfw3");
  const auto xlib = open_gl_library("libX11.so.6", "libx11-6");
  GetDisplay display = nullptr;
  SetHandler set_handler = nullptr;
  SetExit set_exit = nullptr;
  if (!glfw || !xlib || !find_symbol(glfw.value(), "glfwGetX11Display", display) ||
      !find_symbol(xlib.value(), "XSetIOErrorHandler", set_handler) || !find_symbol(xlib.value(), "XSetIOErrorExitHandler", set_exit))
    return;
  void* const unlock = find_symbol(xlib.value(), "XUnlockDisplay");
  void* const shown = display();
  if (shown == nullptr || unlock == nullptr) return;
  set_handler(note_loss);
  set_exit(shown, go_on, unlock);
}

bool display_lost() noexcept { return lost.load(std::memory_order_acquire); }

void GlfwPlatform::release() {
  if (!display_lost()) glfw_.MakeContextCurrent(nullptr);
  current = nullptr;
}

Status GlfwPlatform::make_current() {
  // A context that is current stays so; none can be made current any more.
  if (display_lost()) return current == window_ ? Status() : Status(no_window("the display was lost"));
  glfw_.MakeContextCurrent(window_);
  current = window_;
  if (glfw_.GetError(nullptr) == GLFW_NO_ERROR) return {};
  return no_window("the driver refuses to make its context current");
}

}  // namespace burrhole
