#include "app/cli/picture_sink.h"

#include <filesystem>
#include <optional>

#include "app/render/png.h"
#include "app/render/renderer.h"

namespace burrhole::cli {
namespace {

class OffscreenSink final : public PictureSink {
 public:
  OffscreenSink(Renderer renderer, std::string folder) : renderer_(std::move(renderer)), folder_(std::move(folder)) {}

  Status start(const VolumeView& volume, const TriangleMesh& tool) override {
    if (Status set = renderer_.set_volume(volume); !set) return set;
    return renderer_.set_tool(tool);
  }
  void update(const TexelBox& texels) override { renderer_.update(texels); }
  void forget() override { renderer_.forget(); }
  Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64& hash) override {
    auto image = renderer_.draw(view, width, height);
    if (!image) return image.error();
    for (const Rgba8& p : image->pixels)
      hash.add(static_cast<std::uint64_t>(p.r) << 24 | static_cast<std::uint64_t>(p.g) << 16 | static_cast<std::uint64_t>(p.b) << 8 | p.a);
    if (folder_.empty()) return {};
    const std::string file = (std::filesystem::path(folder_) / (name + ".png")).string();
    if (Status written = write_png(file, *image); !written) return written;
    files_.push_back(file);
    return {};
  }
  const std::vector<std::string>& files() const override { return files_; }
  std::string driver() const override { return renderer_.driver(); }

 private:
  Renderer renderer_;
  std::string folder_;
  std::vector<std::string> files_;
};

}  // namespace

Result<std::unique_ptr<PictureSink>> make_picture_sink(const std::string& folder, const DisplayScene& display, const std::string& gl) {
  RenderOptions options;
  for (const GlBackend backend : gl_backends())
    if (gl == gl_backend_name(backend)) options.gl = backend;
  if (display.method == "slices")
    options.slices = SliceOptions{.per_voxel = display.slices_per_voxel, .correct = display.opacity_correction};
  if (!display.transfer.empty()) options.translucent = display.transfer;
  options.growth_is_told = true;
  options.supersample = 2;  // a handful of still pictures: smooth edges are worth four times the pixels
  auto renderer = Renderer::create(options);
  if (!renderer) return renderer.error();
  return std::unique_ptr<PictureSink>(std::make_unique<OffscreenSink>(std::move(renderer).value(), folder));
}

}  // namespace burrhole::cli
