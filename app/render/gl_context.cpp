#include "app/render/gl_context.h"

#include <dlfcn.h>
#include <glad/gl.h>

#include <cstdlib>

#include "app/render/gl_platform.h"

namespace burrhole {
namespace {

/// All drivers of a process share Mesa's dispatch table of a thread: before a context becomes current, the other back end releases its own.
thread_local GlPlatform* current_platform = nullptr;

GLADapiproc load_function(void* user, const char* name) { return static_cast<const GlPlatform*>(user)->find_function(name); }

std::string gl_string(const GladGLContext& gl, GLenum name) {
  const GLubyte* text = gl.GetString(name);
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

/// "4.5 (Core Profile) Mesa 22.3.6": at least the version that was asked for. A loader that failed in silence shows here too.
bool is_new_enough(const std::string& version) {
  char* rest = nullptr;
  const long major = std::strtol(version.c_str(), &rest, 10);
  if (*rest != '.') return false;
  const long minor = std::strtol(rest + 1, nullptr, 10);
  return major > kGlMajor || (major == kGlMajor && minor >= kGlMinor);
}

GlPlatformResult make_platform(GlBackend backend, int width, int height) {
  switch (backend) {
    case GlBackend::automatic:
#ifdef BH_WITH_EGL
      if (auto gpu = find_gpu_platform()) return std::move(*gpu);
#endif
      return make_osmesa_platform(width, height);
    case GlBackend::osmesa:
      return make_osmesa_platform(width, height);
    case GlBackend::egl:
#ifdef BH_WITH_EGL
      return make_egl_platform();
#else
      return gl_unavailable("egl: this program was built without it");
#endif
    case GlBackend::window:
#ifdef BH_WITH_WINDOW
      return make_window_platform(width, height);
#else
      return gl_unavailable("window: this program was built without it");
#endif
  }
  return gl_unavailable("no such back end of OpenGL");
}

}  // namespace

std::string_view gl_backend_name(GlBackend backend) noexcept {
  switch (backend) {
    case GlBackend::automatic:
      return "auto";
    case GlBackend::osmesa:
      return "osmesa";
    case GlBackend::egl:
      return "egl";
    case GlBackend::window:
      return "window";
  }
  return "auto";
}

const std::vector<GlBackend>& gl_backends() {
  static const std::vector<GlBackend> all{GlBackend::automatic, GlBackend::window, GlBackend::osmesa, GlBackend::egl};
  return all;
}

Error gl_unavailable(std::string message) { return {ErrorCode::unavailable, std::move(message), {}}; }

Status check_gallium_driver() {
  const char* driver = std::getenv("GALLIUM_DRIVER");
  if (driver == nullptr || std::string_view(driver) == "llvmpipe") return {};
  return gl_unavailable("GALLIUM_DRIVER=" + std::string(driver) + ": drawing in software needs llvmpipe; unset it");
}

Result<void*> open_gl_library(const char* file, const char* package) {
  void* library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (library != nullptr) return library;
  return gl_unavailable(std::string(file) + " (Debian: " + package + ") cannot be loaded");
}

void* find_symbol(void* library, const char* name) { return dlsym(library, name); }

struct GlContext::Impl {
  std::unique_ptr<GlPlatform> platform;
  GladGLContext gl{};
  std::string version, renderer;

  ~Impl() {
    if (current_platform == platform.get()) current_platform = nullptr;
  }
};

Result<GlContext> GlContext::create(int width, int height, GlBackend backend) {
  if (width < 1 || height < 1 || width > 16384 || height > 16384)
    return Error{ErrorCode::out_of_range, "a GL surface must be 1 to 16384 pixels wide and high", {}};
  // GLFW makes a new window's context current for a moment. An X server ends the program if an EGL context is current at that time.
  if (current_platform != nullptr) current_platform->release();
  current_platform = nullptr;
  auto platform = make_platform(backend, width, height);
  if (!platform) return platform.error();
  return create(std::move(platform).value());
}

Result<GlContext> GlContext::create(std::unique_ptr<GlPlatform> platform) {
  auto impl = std::make_unique<Impl>();
  impl->platform = std::move(platform);
  GlContext context(std::move(impl));
  if (const Status current = context.make_current(); !current) return current.error();
  Impl& made = *context.impl_;
  const std::string name(gl_backend_name(context.backend()));
  if (gladLoadGLContextUserPtr(&made.gl, load_function, made.platform.get()) == 0)
    return gl_unavailable(name + ": the OpenGL functions could not be loaded");
  made.version = gl_string(made.gl, GL_VERSION);
  made.renderer = gl_string(made.gl, GL_RENDERER);
  if (!is_new_enough(made.version)) return gl_unavailable(name + ": OpenGL 4.5 core is needed, the driver gives \"" + made.version + "\"");
  return context;
}

GlContext::GlContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;

Status GlContext::make_current() {
  GlPlatform* const own = impl_->platform.get();
  if (current_platform != nullptr && current_platform->backend() != own->backend()) current_platform->release();
  current_platform = nullptr;
  if (Status made = own->make_current(); !made) return made;
  current_platform = own;
  return {};
}

const GladGLContext& GlContext::functions() const noexcept { return impl_->gl; }
GlBackend GlContext::backend() const noexcept { return impl_->platform->backend(); }
const std::string& GlContext::version() const noexcept { return impl_->version; }
const std::string& GlContext::renderer() const noexcept { return impl_->renderer; }

bool GlContext::is_software() const noexcept {
  for (const std::string_view name : {"llvmpipe", "softpipe", "swrast"})
    if (renderer().find(name) != std::string::npos) return true;
  return false;
}

}  // namespace burrhole
