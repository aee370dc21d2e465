#include "app/window/viewer.h"

#include <fmt/format.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <filesystem>

#include "app/render/picture_texture.h"
#include "app/render/png.h"
#include "app/view/quality.h"

namespace burrhole {
namespace {

using Steady = std::chrono::steady_clock;

constexpr auto kFrame = std::chrono::microseconds(16'000);  // between two pictures of a window that changes
constexpr auto kIdle = std::chrono::milliseconds(40);       // of one that does not
constexpr double kSmooth = 0.1;                             // share of a new value in the shown frame rate and latency
const Vec3 kGround(0.06, 0.065, 0.075);

double seconds(Steady::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

/// The sink that a run sees: everything is done by the drawing thread.
class Viewer::Sink final : public PictureSink {
 public:
  explicit Sink(Viewer& viewer) : viewer_(&viewer) {}

  Status start(const VolumeView& volume, const TriangleMesh& tool) override {
    return viewer_->call([&] { return own().start(volume, tool); });
  }
  void update(const TexelBox& texels) override {
    viewer_->post([this, texels] {
      own().update(texels);
      viewer_->texels_changed_ = true;
    });
  }
  Status move_detail(const DetailView& view) override {
    return viewer_->call([&] { return own().move_detail(view); });
  }
  Status change_tool(const TriangleMesh& tool) override {
    return viewer_->call([&] {
      viewer_->texels_changed_ = true;
      return own().change_tool(tool);
    });
  }
  void forget() override {
    viewer_->post([this] { own().forget(); });
  }
  Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64& hash) override {
    return viewer_->call([&] {
      // The pictures of a run have its quality, whatever the window shows.
      viewer_->drawn_ = false;
      viewer_->quality_ = viewer_->display_.quality;
      if (Status set = viewer_->parts_.renderer->set_quality(viewer_->quality_); !set) return set;
      return own().draw(name, view, width, height, hash);
    });
  }
  Result<std::vector<std::string>> files() override {
    std::optional<Result<std::vector<std::string>>> out;
    const Status called = viewer_->call([&] {
      out.emplace(own().files());
      return Status();
    });
    if (!called) return called.error();
    return *out;
  }
  std::string driver() const override {
    std::string out;
    (void)viewer_->call([&] {
      out = own().driver();
      return Status();
    });
    return out;
  }
  RunSummary::Display display() const override {
    RunSummary::Display out;
    (void)viewer_->call([&] {
      out = own().display();
      return Status();
    });
    return out;
  }

 private:
  [[nodiscard]] PictureSink& own() const { return *viewer_->parts_.sink; }
  Viewer* viewer_;
};

Viewer::Viewer(GlfwWindow& window, Desk& desk, MakeWindowSink make_sink, const ViewerConfig& config)
    : window_(&window), desk_(&desk), make_parts_(std::move(make_sink)), config_(config), pace_(config.moving_budget) {}
Viewer::~Viewer() = default;

Status Viewer::call(const std::function<Status()>& f) {
  Status result;
  bool done = false;
  std::unique_lock lock(mutex_);
  if (ended_) return Error{ErrorCode::unavailable, "the window has gone", {}};
  jobs_.push_back([&] {
    Status made = f();
    const std::scoped_lock inner(mutex_);
    result = std::move(made);
    done = true;
  });
  posted_.notify_all();
  posted_.wait(lock, [&] { return done || ended_; });
  return done ? result : Status(Error{ErrorCode::unavailable, "the window has gone", {}});
}

void Viewer::post(std::function<void()> f) {
  const std::scoped_lock lock(mutex_);
  if (!ended_) jobs_.push_back(std::move(f));
  posted_.notify_all();
}

void Viewer::serve() {
  for (;;) {
    std::function<void()> job;
    {
      const std::scoped_lock lock(mutex_);
      if (jobs_.empty()) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    job();
    posted_.notify_all();
  }
}

Result<std::unique_ptr<PictureSink>> Viewer::make_sink(const DisplayConfig& display, const std::string& folder) {
  const Status made = call([&]() -> Status {
    if (!context_) return Error{ErrorCode::internal, "the window draws one run", {}};
    auto parts = make_parts_(display, folder, std::move(*context_));
    context_.reset();
    if (!parts) return parts.error();
    parts_ = std::move(parts).value();
    display_ = display;
    quality_ = display.quality;
    return {};
  });
  if (!made) return made.error();
  return std::unique_ptr<PictureSink>(std::make_unique<Sink>(*this));
}

void Viewer::set_base(const FrameView& base, bool tool_turns) {
  post([this, base, tool_turns] {
    base_ = base;
    tool_turns_ = tool_turns;
  });
}

void Viewer::set_report(const std::string& path) {
  post([this, path] { panel_->set_report(path); });
}

Status Viewer::open() {
  auto context = window_->context();
  if (!context) return context.error();
  context_ = std::move(context).value();
  window_->set_interval(context_->is_software() ? 0 : 1);
  auto gui = Gui::create(static_cast<float>(config_.text_scale) * window_->scale(), config_.light);
  if (!gui) return gui.error();
  gui_ = std::move(gui).value();
  panel_ = std::make_unique<Panel>(*gui_, *desk_);
  texture_ = std::make_unique<PictureTexture>(*context_);
  return {};
}

void Viewer::loop() {
  Status opened = open();
  if (!opened) {
    desk_->fail(opened.error());
  } else {
    changed_at_ = last_frame_ = Steady::now();
    while (!(desk_->closed() && released_.load(std::memory_order_acquire))) {
      const auto start = Steady::now();
      serve();
      draw_frame();
      const bool idle = seconds(Steady::now() - changed_at_) > 2.0 * config_.rest;
      std::unique_lock lock(mutex_);
      if (jobs_.empty()) posted_.wait_until(lock, start + (idle ? kIdle : kFrame));
    }
  }
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
    jobs_.clear();
  }
  posted_.notify_all();
  texture_.reset();
  gui_.reset();
  parts_ = {};
  context_.reset();
}

void Viewer::draw_frame() {
  const int width = window_->width(), height = window_->height();
  if (width < 1 || height < 1) return;  // minimised
  const auto now = Steady::now();
  const double since = seconds(now - last_frame_);
  last_frame_ = now;
  const DeskView view = desk_->view();
  gui_->feed(desk_->take_events());
  const int side = panel_width(width, gui_->scale());
  desk_->set_picture_size(width - side, height);
  if (base_ && parts_.renderer != nullptr && width > side) draw_picture(view, width - side, height);
  texture_->clear_window(width, height, kGround);
  gui_->begin(width, height, since);
  if (texture_->name() != 0)
    ImGui::GetBackgroundDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture_->name())),
                                             ImVec2(0.0f, 0.0f), ImVec2(static_cast<float>(width - side), static_cast<float>(height)));
  panel_->draw(view, figures_, width, height);
  gui_->end();
  desk_->take_mouse(gui_->wants_mouse());
  if (view.wishes.screenshot) take_screenshot(width, height);
  window_->swap();
  note_time(since);
  if (const auto waited = desk_->take_latency()) figures_.latency_ms += kSmooth * (*waited * 1e3 - figures_.latency_ms);
}

DrawingQuality Viewer::wanted_quality(bool at_rest) const {
  DrawingQuality out = display_.quality;
  if (!at_rest) out.supersample = 1;
  return out;
}

void Viewer::draw_picture(const DeskView& view, int width, int height) {
  FrameView frame = *base_;
  frame.camera = view.camera;
  frame.world_from_tool = view.live.hand.tick > 0 ? std::optional(view.live.world_from_tool) : std::nullopt;
  if (frame.world_from_tool && tool_turns_) frame.world_from_tool = turned_tool(*frame.world_from_tool, view.turned);
  const bool camera_moves = !last_camera_ || !(*last_camera_ == frame.camera);
  const auto differ = [](const Pose& a, const Pose& b) { return a.translation != b.translation || a.rotation != b.rotation; };
  const bool tool_moves =
      frame.world_from_tool.has_value() != last_tool_.has_value() || (last_tool_ && differ(*frame.world_from_tool, *last_tool_));
  const bool resized = width != picture_width_ || height != picture_height_;
  const auto now = Steady::now();
  if (camera_moves || tool_moves || texels_changed_ || resized) changed_at_ = now;
  const bool at_rest = seconds(now - changed_at_) > config_.rest;
  const DrawingQuality wanted = wanted_quality(at_rest);
  const bool changes_quality = !(wanted == quality_);
  if (drawn_ && !camera_moves && !tool_moves && !texels_changed_ && !resized && !changes_quality && !figures_.coarse) return;
  if (changes_quality && parts_.renderer->set_quality(wanted)) quality_ = wanted;
  auto image = parts_.renderer->draw_at_pace(frame, width, height, pace_);
  if (!image) {
    desk_->say("The picture cannot be drawn: " + image.error().text(), true);
    return;
  }
  texture_->set(*image);
  figures_.picture_ms = seconds(Steady::now() - now) * 1e3;
  figures_.coarse = camera_moves && pace_.resolution() < 1.0;
  figures_.quality = quality_text(quality_, false);
  last_camera_ = frame.camera;
  last_tool_ = frame.world_from_tool;
  picture_width_ = width;
  picture_height_ = height;
  texels_changed_ = false;
  drawn_ = true;
}

void Viewer::take_screenshot(int width, int height) {
  desk_->with_pilot([](Pilot& pilot) { pilot.wishes().screenshot = false; });
  if (config_.folder.empty()) return desk_->say("There is no output folder for a screenshot", true);
  const auto path = std::filesystem::path(config_.folder) / fmt::format("screenshot-{}.png", ++screenshots_);
  const Status written = write_png(path, texture_->read_window(width, height));
  desk_->say(written ? "Saved " + path.string() : written.error().text(), !written.ok());
}

void Viewer::note_time(double seconds_since) {
  if (seconds_since > 0.0) figures_.frames_per_s += kSmooth * (1.0 / seconds_since - figures_.frames_per_s);
}

}  // namespace burrhole
