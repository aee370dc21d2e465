#include "app/cli/picture_sink.h"

#include <array>
#include <filesystem>
#include <optional>

#include "app/render/overlay.h"
#include "app/render/png.h"
#include "app/render/renderer.h"
#include "app/render/stereo.h"

namespace burrhole::cli {
namespace {

class OffscreenSink final : public PictureSink {
 public:
  OffscreenSink(Renderer renderer, std::string folder, const DisplayScene& display)
      : renderer_(std::move(renderer)), folder_(std::move(folder)), stereo_(display.stereo), scale_bar_(display.scale_bar) {}

  Status start(const VolumeView& volume, const TriangleMesh& tool) override {
    if (Status set = renderer_.set_volume(volume); !set) return set;
    return renderer_.set_tool(tool);
  }
  void update(const TexelBox& texels) override { renderer_.update(texels); }
  Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64& hash) override {
    auto image = draw_eyes(view, width, height);
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
  Result<Image> draw_eyes(const FrameView& view, int width, int height) {
    if (stereo_.mode == StereoMode::off) return draw_one(view, width, height);
    const auto cameras = make_stereo_cameras(view.camera, stereo_, static_cast<double>(width) / height);
    if (!cameras) return cameras.error();
    std::array<Image, 2> eyes;
    for (std::size_t side = 0; side < 2; ++side) {
      FrameView seen = view;
      seen.camera = (*cameras)[side];
      auto image = draw_one(seen, width, height);
      if (!image) return image.error();
      eyes[side] = std::move(image).value();
    }
    return join_eyes(stereo_.mode, eyes[0], eyes[1]);
  }

  Result<Image> draw_one(const FrameView& view, int width, int height) {
    auto image = renderer_.draw(view, width, height);
    if (image && scale_bar_) draw_scale_bar(*image, fit_scale_bar(view.camera, width, height));
    return image;
  }

  Renderer renderer_;
  std::string folder_;
  StereoView stereo_;
  bool scale_bar_;
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
  options.looks = display.looks;
  options.supersample = 2;  // a handful of still pictures: smooth edges are worth four times the pixels
  auto renderer = Renderer::create(options);
  if (!renderer) return renderer.error();
  return std::unique_ptr<PictureSink>(std::make_unique<OffscreenSink>(std::move(renderer).value(), folder, display));
}

}  // namespace burrhole::cli
