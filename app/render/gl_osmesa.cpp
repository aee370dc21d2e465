// The back end osmesa: software, no display. Its surface is memory of this program.
#include <vector>

#include "app/render/gl_platform.h"

namespace burrhole {
namespace {

// Declarations from Mesa's osmesa.h, which cannot be included: it includes GL/gl.h, whose prototypes conflict with those of the loader.
constexpr int kRgba = 0x1908;
constexpr int kFormat = 0x22;
constexpr int kDepthBits = 0x30;
constexpr int kProfile = 0x33;
constexpr int kCoreProfile = 0x34;
constexpr int kMajorVersion = 0x36;
constexpr int kMinorVersion = 0x37;
constexpr unsigned kUnsignedByte = 0x1401;
using Handle = struct osmesa_context*;

struct Osmesa {
  Handle (*create_attribs)(const int*, Handle) = nullptr;
  unsigned char (*make_current)(Handle, void*, unsigned, int, int) = nullptr;
  GlFunction (*get_proc_address)(const char*) = nullptr;
  void (*destroy)(Handle) = nullptr;
};

Result<Osmesa> load_osmesa() {
  const auto library = open_gl_library("libOSMesa.so.8", "libosmesa6");
  if (!library) return gl_unavailable("osmesa: " + library.error().message);
  Osmesa mesa;
  if (!find_symbol(library.value(), "OSMesaCreateContextAttribs", mesa.create_attribs) ||
      !find_symbol(library.value(), "OSMesaMakeCurrent", mesa.make_current) ||
      !find_symbol(library.value(), "OSMesaGetProcAddress", mesa.get_proc_address) ||
      !find_symbol(library.value(), "OSMesaDestroyContext", mesa.destroy))
    return gl_unavailable("osmesa: libOSMesa.so.8 lacks a function of OSMesa 11.2 or newer");
  return mesa;
}

class OsmesaPlatform final : public GlPlatform {
 public:
  OsmesaPlatform(const Osmesa& mesa, Handle handle, int width, int height)
      : mesa_(mesa),
        handle_(handle),
        width_(width),
        height_(height),
        surface_(4u * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}
  ~OsmesaPlatform() override { mesa_.destroy(handle_); }

  GlBackend backend() const noexcept override { return GlBackend::osmesa; }
  Status make_current() override {
    if (mesa_.make_current(handle_, surface_.data(), kUnsignedByte, width_, height_) != 0) return {};
    return gl_unavailable("osmesa: the library refuses to make its context current");
  }
  void release() override { mesa_.make_current(nullptr, nullptr, 0, 0, 0); }
  GlFunction find_function(const char* name) const override { return mesa_.get_proc_address(name); }

 private:
  Osmesa mesa_;
  Handle handle_;
  int width_, height_;
  std::vector<unsigned char> surface_;
};

}  // namespace

GlPlatformResult make_osmesa_platform(int width, int height) {
  if (const Status fit = check_gallium_driver(); !fit) return gl_unavailable("osmesa: " + fit.error().message);
  const auto mesa = load_osmesa();
  if (!mesa) return mesa.error();
  const int attributes[] = {kFormat, kRgba, kDepthBits, 24, kProfile, kCoreProfile, kMajorVersion, kGlMajor, kMinorVersion, kGlMinor, 0};
  const Handle handle = mesa.value().create_attribs(attributes, nullptr);
  if (handle == nullptr) return gl_unavailable("osmesa: the driver gives no OpenGL 4.5 core context");
  return std::unique_ptr<GlPlatform>(std::make_unique<OsmesaPlatform>(mesa.value(), handle, width, height));
}

}  // namespace burrhole
