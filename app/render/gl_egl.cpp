// The back end egl: a context without surface, on a GPU by the device platform or in software by Mesa's surfaceless platform.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <string_view>

#include "app/render/gl_platform.h"

namespace burrhole {
namespace {

struct Egl {
  decltype(&eglGetProcAddress) get_proc_address = nullptr;
  decltype(&eglQueryString) query_string = nullptr;
  decltype(&eglInitialize) initialize = nullptr;
  decltype(&eglBindAPI) bind_api = nullptr;
  decltype(&eglChooseConfig) choose_config = nullptr;
  decltype(&eglCreateContext) create_context = nullptr;
  decltype(&eglDestroyContext) destroy_context = nullptr;
  decltype(&eglMakeCurrent) make_current = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;  // extensions from here: null if the library lacks them
  PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;
  PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;

  [[nodiscard]] bool knows(EGLDisplay display, std::string_view extension) const {
    const char* all = query_string(display, EGL_EXTENSIONS);
    return all != nullptr && (' ' + std::string(all) + ' ').find(' ' + std::string(extension) + ' ') != std::string::npos;
  }
};

Error refused(const std::string& why) { return gl_unavailable("egl: " + why); }

Result<Egl> load_egl() {
  const auto library = open_gl_library("libEGL.so.1", "libegl1");
  if (!library) return refused(library.error().message);
  Egl egl;
  void* const lib = library.value();
  if (!find_symbol(lib, "eglGetProcAddress", egl.get_proc_address) || !find_symbol(lib, "eglQueryString", egl.query_string) ||
      !find_symbol(lib, "eglInitialize", egl.initialize) || !find_symbol(lib, "eglBindAPI", egl.bind_api) ||
      !find_symbol(lib, "eglChooseConfig", egl.choose_config) || !find_symbol(lib, "eglCreateContext", egl.create_context) ||
      !find_symbol(lib, "eglDestroyContext", egl.destroy_context) || !find_symbol(lib, "eglMakeCurrent", egl.make_current))
    return refused("libEGL.so.1 lacks a function of EGL 1.5");
  const auto extension = [&egl](const char* name) { return egl.get_proc_address(name); };
  egl.get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(extension("eglGetPlatformDisplayEXT"));
  egl.query_devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(extension("eglQueryDevicesEXT"));
  egl.query_device_string = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(extension("eglQueryDeviceStringEXT"));
  return egl;
}

class EglPlatform final : public GlPlatform {
 public:
  EglPlatform(const Egl& egl, EGLDisplay display, EGLContext context) : egl_(egl), display_(display), context_(context) {}
  // The display is shared by the whole process and stays initialised: other contexts may use it.
  ~EglPlatform() override {
    release();
    egl_.destroy_context(display_, context_);
  }

  GlBackend backend() const noexcept override { return GlBackend::egl; }
  Status make_current() override {
    if (egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE) return {};
    return refused("the driver refuses to make its context current");
  }
  void release() override { egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
  GlFunction find_function(const char* name) const override { return egl_.get_proc_address(name); }

 private:
  Egl egl_;
  EGLDisplay display_;
  EGLContext context_;
};

GlPlatformResult make_on_display(const Egl& egl, EGLDisplay display, const std::string& where) {
  if (display == EGL_NO_DISPLAY) return refused("there is no display " + where);
  if (egl.initialize(display, nullptr, nullptr) != EGL_TRUE) return refused("the display " + where + " cannot be initialised");
  if (!egl.knows(display, "EGL_KHR_surfaceless_context")) return refused("the driver " + where + " cannot draw without a surface");
  if (egl.bind_api(EGL_OPENGL_API) != EGL_TRUE) return refused("the driver " + where + " has no OpenGL, only OpenGL ES");
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint found = 0;
  if (egl.choose_config(display, wanted, &config, 1, &found) != EGL_TRUE || found < 1)
    return refused("the driver " + where + " has no configuration for OpenGL");
  const EGLint attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION,           kGlMajor, EGL_CONTEXT_MINOR_VERSION, kGlMinor, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  const EGLContext context = egl.create_context(display, config, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) return refused("the driver " + where + " gives no OpenGL 4.5 core context");
  return std::unique_ptr<GlPlatform>(std::make_unique<EglPlatform>(egl, display, context));
}

std::optional<std::unique_ptr<GlPlatform>> find_gpu(const Egl& egl) {
  if (egl.query_devices == nullptr || egl.query_device_string == nullptr || egl.get_platform_display == nullptr) return std::nullopt;
  std::array<EGLDeviceEXT, 16> devices{};
  EGLint count = 0;
  if (egl.query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE) return std::nullopt;
  for (EGLint n = 0; n < count; ++n) {
    EGLDeviceEXT const device = devices[static_cast<std::size_t>(n)];
    const char* extensions = egl.query_device_string(device, EGL_EXTENSIONS);
    if (extensions == nullptr || std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos) continue;
    auto made = make_on_display(egl, egl.get_platform_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr), "of GPU " + std::to_string(n));
    if (made) return std::move(made).value();
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::unique_ptr<GlPlatform>> find_gpu_platform() {
  const auto egl = load_egl();
  return egl ? find_gpu(egl.value()) : std::nullopt;
}

GlPlatformResult make_egl_platform() {
  const auto egl = load_egl();
  if (!egl) return egl.error();
  if (auto gpu = find_gpu(egl.value())) return std::move(*gpu);
  if (const Status fit = check_gallium_driver(); !fit) return refused(fit.error().message);
  if (egl.value().get_platform_display == nullptr || !egl.value().knows(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    return refused("no GPU, and no software driver without a surface (Debian: libegl-mesa0)");
  return make_on_display(egl.value(), egl.value().get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr),
                         "without a surface");
}

}  // namespace burrhole
