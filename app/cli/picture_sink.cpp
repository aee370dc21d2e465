#include "app/cli/picture_sink.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <optional>

#include "app/cli/film.h"
#include "app/cli/png_writer.h"
#include "app/render/marks.h"
#include "app/render/overlay.h"
#include "app/render/png.h"
#include "app/render/renderer.h"
#include "app/render/texture_load.h"
#include "app/render/tip_slices_picture.h"
#include "app/view/picture_memory.h"
#include "app/view/quality.h"
#include "app/view/stereo.h"
#include "volumes/read/memory_check.h"

namespace burrhole::cli {
namespace {

/// Pictures in files of a run whose window has a buffer for each eye.
StereoView stereo_of_files(StereoView stereo) {
  if (stereo.mode == StereoMode::quad) stereo.mode = StereoMode::side_by_side;
  return stereo;
}

class OffscreenSink final : public PictureSink {
 public:
  OffscreenSink(Renderer renderer, const DisplayConfig& display, const PictureOptions& options)
      : renderer_(std::move(renderer)),
        options_(options),
        translucent_(!display.transfer.empty()),
        quality_(display.quality),
        budget_(display.budget),
        stereo_(stereo_of_files(display.stereo)),
        scale_bar_(display.scale_bar),
        orientation_(display.orientation) {}

  [[nodiscard]] Renderer& renderer() noexcept { return renderer_; }

  Status start(const VolumeView& volume, const TriangleMesh& tool) override {
    if (Status set = renderer_.set_volume(volume); !set) return set;
    note_ = volume.note;
    return renderer_.set_tool(tool);
  }
  void update(const TexelBox& texels) override { renderer_.update(texels); }
  Status move_detail(const DetailView& view) override { return renderer_.set_detail(view); }
  Status change_tool(const TriangleMesh& tool) override { return renderer_.set_tool(tool); }
  Status set_added(const std::shared_ptr<const AddedMesh>& mesh) override { return renderer_.set_added(mesh); }
  void forget() override { renderer_.forget(); }
  Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64& hash) override {
    if (budget_ && !expected_)
      if (Status chosen = choose(view, width, height); !chosen) return chosen;
    auto image = draw_eyes(view, width, height);
    if (!image) return image.error();
    for (const Rgba8& p : image->pixels)
      hash.add(static_cast<std::uint64_t>(p.r) << 24 | static_cast<std::uint64_t>(p.g) << 16 | static_cast<std::uint64_t>(p.b) << 8 | p.a);
    if (options_.folder.empty()) return {};
    return writer_.add((std::filesystem::path(options_.folder) / (name + ".png")).string(), std::move(image).value());
  }
  Status film(const FrameView& view, int width, int height) override {
    if (options_.film == nullptr) return {};
    auto image = draw_eyes(view, width, height);
    if (!image) return image.error();
    return options_.film->add(*image);
  }
  Result<std::vector<std::string>> files() override {
    if (Status written = writer_.wait(); !written) return written.error();
    return writer_.files();
  }
  std::string driver() const override { return renderer_.driver(); }
  RunSummary::Display display() const override {
    constexpr double kMs = 1e3;
    const auto in_ms = [](const std::optional<double>& seconds) { return seconds ? std::optional(*seconds * kMs) : std::nullopt; };
    const GlContext& context = renderer_.context();
    return {
        std::string(gl_backend_name(context.backend())), context.version(), context.renderer(), quality_, in_ms(budget_), in_ms(expected_)};
  }

 private:
  /// Chooses the quality from the time of one picture at the lowest quality. The first picture is not timed: it compiles shaders.
  Status choose(const FrameView& view, int width, int height) {
    const auto front = shipped_front(translucent_);
    std::chrono::duration<double> took{};
    for (int n = 0; n < 2; ++n) {
      if (Status set = renderer_.set_quality(front.front().quality); !set) return set;
      const auto start = std::chrono::steady_clock::now();
      if (const auto image = renderer_.draw(view, width, height); !image) return image.error();
      took = std::chrono::steady_clock::now() - start;
    }
    const QualityChoice choice = choose_quality(front, took.count(), *budget_);
    quality_ = choice.quality;
    expected_ = choice.expected;
    if (options_.report)
      options_.report(fmt::format("{}: about {:.3g} ms a picture, {} {:g} ms", quality_text(quality_, translucent_), *expected_ * 1e3,
                                  choice.met ? "within the budget of" : "the lowest quality, over the budget of", *budget_ * 1e3));
    return renderer_.set_quality(quality_);
  }

  Result<Image> draw_eyes(const FrameView& view, int width, int height) {
    const auto cameras = make_eye_cameras(view.camera, stereo_, static_cast<double>(width) / height);
    if (!cameras) return cameras.error();
    std::vector<Image> eyes;
    for (const CameraView& camera : *cameras) {
      FrameView of_eye = view;
      of_eye.camera = camera;
      auto image = draw_one(of_eye, width, height);
      if (!image) return image.error();
      eyes.push_back(std::move(image).value());
    }
    return make_screen_picture(stereo_, std::move(eyes));
  }

  Result<Image> draw_one(const FrameView& view, int width, int height) {
    auto image = renderer_.draw(view, width, height);
    if (!image) return image;
    if (view.inset && stereo_.mode == StereoMode::off)
      if (Status drawn = add_inset(view, *image); !drawn) return drawn.error();
    if (scale_bar_) draw_scale_bar(*image, fit_scale_bar(view.camera, width, height));
    if (orientation_) draw_orientation(*image, view.camera, view.world_from_bone);
    if (!note_.empty()) draw_note(*image, note_);
    if (options_.bar) draw_color_bar(*image, *options_.bar);
    return image;
  }

  /// Draws all of a head into the upper right corner.
  Status add_inset(const FrameView& view, Image& image) {
    FrameView small = view;
    small.camera = *view.inset;
    small.inset.reset();
    small.cut.reset();
    const auto drawn = renderer_.draw(small, std::max(16, image.width / 4), std::max(16, image.height / 4));
    if (!drawn) return drawn.error();
    frame_into(image, *drawn);
    return {};
  }

  Renderer renderer_;
  PictureOptions options_;
  bool translucent_;
  DrawingQuality quality_;
  std::optional<double> budget_, expected_;  // [s]
  StereoView stereo_;
  bool scale_bar_, orientation_;
  std::string note_;  // on what is assumed; empty: nothing
  PngWriter writer_;
};

}  // namespace

namespace {

Result<RenderOptions> options_of(const DisplayConfig& display, const PictureOptions& options) {
  RenderOptions render = make_render_options(display.quality, display.appearance);
  render.shader_folder = options.shader_folder;
  for (const GlBackend backend : gl_backends())
    if (options.gl == gl_backend_name(backend)) render.gl = backend;
  if (display.method == "slices")
    render.slices = SliceOptions{.per_voxel = display.slices_per_voxel, .correct = display.opacity_correction};
  render.mesh = display.method == "mesh";
  if (draws_textures(display)) {
    auto textures = load_textures(display.textures);
    if (!textures) return textures.error();
    render.textures = std::move(textures).value();
  }
  if (!display.transfer.empty()) render.translucent = display.transfer;
  render.growth_is_reported = true;
  return render;
}

}  // namespace

Result<DrawingSink> make_window_sink(const DisplayConfig& display, const PictureOptions& options, GlContext context) {
  const auto render = options_of(display, options);
  if (!render) return render.error();
  auto renderer = Renderer::create(*render, std::move(context));
  if (!renderer) return renderer.error();
  auto sink = std::make_unique<OffscreenSink>(std::move(renderer).value(), display, options);
  Renderer* const drawing = &sink->renderer();
  return DrawingSink{std::move(sink), drawing};
}

Status write_tip_slices(const std::string& file, int width, int height, const std::function<TipSlices(int size)>& make,
                        const std::vector<std::string>& legend) {
  const CellLayout layout = fit_cells(width, height);
  return write_png(file, draw_tip_slices(make(layout.size), layout, legend));
}

Status check_picture_memory(const DisplayConfig& display) {
  const auto error = memory_error(static_cast<double>(picture_bytes(display)));
  if (!error) return {};
  return Error{
      ErrorCode::unavailable,
      fmt::format("a picture of {} x {} pixels {}: give a smaller --size or display.size, or fewer rays a pixel (display.supersample)",
                  display.width, display.height, *error),
      {}};
}

Result<std::unique_ptr<PictureSink>> make_picture_sink(const DisplayConfig& display, const PictureOptions& options) {
  if (display.stereo.mode == StereoMode::quad)
    return Error{ErrorCode::unavailable,
                 "quad-buffered stereo needs a window: --stereo side-by-side or --stereo anaglyph draws two eyes into a file",
                 {}};
  if (Status fits = check_picture_memory(display); !fits) return fits.error();
  const auto render = options_of(display, options);
  if (!render) return render.error();
  auto renderer = Renderer::create(*render);
  if (!renderer) return renderer.error();
  return std::unique_ptr<PictureSink>(std::make_unique<OffscreenSink>(std::move(renderer).value(), display, options));
}

}  // namespace burrhole::cli
