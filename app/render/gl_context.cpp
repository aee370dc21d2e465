#include "app/render/gl_context.h"

#include <dlfcn.h>
#include <glad/gl.h>

#include <cstdlib>
#include <string_view>
#include <vector>

namespace burrhole {
namespace {

// From Mesa's osmesa.h, which cannot be included: it drags in GL/gl.h, whose prototypes clash with the loader's.
constexpr int kOsmesaRgba = 0x1908;
constexpr int kOsmesaFormat = 0x22;
constexpr int kOsmesaDepthBits = 0x30;
constexpr int kOsmesaProfile = 0x33;
constexpr int kOsmesaCoreProfile = 0x34;
constexpr int kOsmesaMajorVersion = 0x36;
constexpr int kOsmesaMinorVersion = 0x37;
using OsmesaHandle = struct osmesa_context*;

struct Osmesa {
  OsmesaHandle (*create_attribs)(const int*, OsmesaHandle) = nullptr;
  GLboolean (*make_current)(OsmesaHandle, void*, GLenum, GLsizei, GLsizei) = nullptr;
  GLADapiproc (*get_proc_address)(const char*) = nullptr;
  void (*destroy)(OsmesaHandle) = nullptr;
};

Error unavailable(std::string message) { return {ErrorCode::unavailable, std::move(message), {}}; }

template <class F>
bool find_symbol(void* library, const char* name, F& function) {
  function = reinterpret_cast<F>(dlsym(library, name));
  return function != nullptr;
}

/// The library stays loaded for the life of the process: its compiler threads and statics do not survive an unload.
Result<Osmesa> load_osmesa() {
  // Mesa 22.3 crashes on a driver name it does not know, and its softpipe has no 4.5 core context.
  const char* driver = std::getenv("GALLIUM_DRIVER");
  if (driver != nullptr && std::string_view(driver) != "llvmpipe")
    return unavailable("GALLIUM_DRIVER=" + std::string(driver) + ": offscreen drawing needs llvmpipe; unset it");
  void* library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return unavailable("offscreen drawing needs libOSMesa.so.8 (Debian: libosmesa6), which cannot be loaded");
  Osmesa mesa;
  if (!find_symbol(library, "OSMesaCreateContextAttribs", mesa.create_attribs) ||
      !find_symbol(library, "OSMesaMakeCurrent", mesa.make_current) ||
      !find_symbol(library, "OSMesaGetProcAddress", mesa.get_proc_address) || !find_symbol(library, "OSMesaDestroyContext", mesa.destroy))
    return unavailable("libOSMesa.so.8 lacks a function of OSMesa 11.2 or newer");
  return mesa;
}

GLADapiproc load_function(void* user, const char* name) { return static_cast<const Osmesa*>(user)->get_proc_address(name); }

std::string gl_string(const GladGLContext& gl, GLenum name) {
  const GLubyte* text = gl.GetString(name);
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

}  // namespace

struct GlContext::Impl {
  Osmesa mesa;
  OsmesaHandle handle = nullptr;
  std::vector<unsigned char> surface;
  int width = 0, height = 0;
  GladGLContext gl{};
  std::string version, renderer;

  ~Impl() {
    if (handle != nullptr) mesa.destroy(handle);
  }
};

Result<GlContext> GlContext::create(int width, int height) {
  if (width < 1 || height < 1 || width > 16384 || height > 16384)
    return Error{ErrorCode::out_of_range, "a GL surface must be 1 to 16384 pixels wide and high", {}};
  const auto mesa = load_osmesa();
  if (!mesa) return mesa.error();
  auto impl = std::make_unique<Impl>();
  impl->mesa = mesa.value();
  impl->width = width;
  impl->height = height;
  impl->surface.resize(4u * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int attributes[] = {kOsmesaFormat,
                            kOsmesaRgba,
                            kOsmesaDepthBits,
                            24,
                            kOsmesaProfile,
                            kOsmesaCoreProfile,
                            kOsmesaMajorVersion,
                            4,
                            kOsmesaMinorVersion,
                            5,
                            0};
  impl->handle = impl->mesa.create_attribs(attributes, nullptr);
  if (impl->handle == nullptr) return unavailable("OSMesa gives no OpenGL 4.5 core context");
  GlContext context(std::move(impl));
  const Status current = context.make_current();
  if (!current) return current.error();
  Impl& made = *context.impl_;
  if (gladLoadGLContextUserPtr(&made.gl, load_function, &made.mesa) == 0) return unavailable("the OpenGL functions could not be loaded");
  made.version = gl_string(made.gl, GL_VERSION);
  made.renderer = gl_string(made.gl, GL_RENDERER);
  // A loader that failed in silence shows here: no version, or not the one that was asked for.
  if (!made.version.starts_with("4.5")) return unavailable("OpenGL 4.5 core was asked for, the driver gave \"" + made.version + "\"");
  return context;
}

GlContext::GlContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;

Status GlContext::make_current() {
  if (impl_->mesa.make_current(impl_->handle, impl_->surface.data(), GL_UNSIGNED_BYTE, impl_->width, impl_->height) == 0)
    return unavailable("OSMesa refuses to make its context current");
  return {};
}

const GladGLContext& GlContext::functions() const noexcept { return impl_->gl; }
const std::string& GlContext::version() const noexcept { return impl_->version; }
const std::string& GlContext::renderer() const noexcept { return impl_->renderer; }

}  // namespace burrhole
