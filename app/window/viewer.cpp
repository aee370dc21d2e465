#include "app/window/viewer.h"

#include <fmt/format.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <utility>

#include "app/render/picture_texture.h"
#include "app/render/png.h"
#include "app/render/tip_slices_picture.h"
#include "app/view/quality.h"
#include "app/view/stereo.h"
#include "app/window/over_bone.h"
#include "app/window/transport_bar.h"
#include "app/window/viewer_sink.h"

namespace burrhole {
namespace {

using Steady = std::chrono::steady_clock;

constexpr auto kFrame = std::chrono::microseconds(16'000);  // between two pictures of a window that changes
constexpr double kIdleAfter = 0.6;                          // [s] without a change or an event
constexpr auto kIdle = std::chrono::milliseconds(250);      // of one that does not, unless something comes in
constexpr double kRest = 0.06;                              // [s] without a change, after which the picture is refined
constexpr double kStep = 0.05;                              // [s] of a picture that is drawn in steps: what an input waits for, at most
constexpr double kShowSteps = 0.25;                         // [s] after which what is drawn of it is shown, without an input
constexpr double kStillTool = 1e-4;                         // [m] of the tool, less changes no refined picture
constexpr double kSliceHalfWidth = 0.012;                   // [m] shown around the tip
constexpr double kSliceStep = 5e-5;                         // [m] of the tip, less changes no slice
constexpr double kSliceTurn = 0.999999;                     // [-] cosine of half a turn of 0.16 degrees, above which no slice changes
constexpr double kSliceEvery = 0.1;                         // [s] between two pictures of the slices, at least
constexpr int kSmallestSlice = 64, kSliceGaps = 16;         // [pixels]
constexpr double kSmooth = 0.1;                             // share of a new value in the shown frame rate and latency
const Vec3 kGround(0.06, 0.065, 0.075);

/// Shows the slices in the lower left corner of the picture, above the time line of a session.
void show_slices(const PictureTexture& slices, const WindowView& view, const Gui& gui, int height) {
  const float edge = 12.0f * gui.scale(), below = edge + (view.transport ? transport_height(gui) : 0.0f);
  const auto wide = static_cast<float>(slices.width()), tall = static_cast<float>(slices.height());
  const ImVec2 at(edge, static_cast<float>(height) - below - tall);
  // ImGui keeps names of OpenGL textures as pointers.  NOLINTNEXTLINE(performance-no-int-to-ptr)
  ImGui::GetBackgroundDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(slices.name())), at,
                                           ImVec2(at.x + wide, at.y + tall));
}

double seconds(Steady::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

Viewer::Viewer(GlfwWindow& window, WindowState& state, MakeWindowSink make_sink, const ViewerConfig& config)
    : window_(&window), state_(&state), make_parts_(std::move(make_sink)), config_(config), pace_(config.moving_budget, config.coarsest) {}
Viewer::~Viewer() = default;

Status Viewer::call(const std::function<Status()>& f) {
  Status result;
  bool done = false;
  std::unique_lock lock(mutex_);
  if (ended_) return Error{ErrorCode::unavailable, "the window has gone", {}};
  ++waited_for_;
  jobs_.push_back([&] {
    Status made = f();
    const std::scoped_lock inner(mutex_);
    --waited_for_;
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

bool Viewer::wait_for_jobs(Time until) {
  std::unique_lock lock(mutex_);
  return posted_.wait_until(lock, until, [this] { return waited_for_ > 0; });
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
    if (!parts) {  // the context went with it
      texture_.reset();
      gui_.reset();
      state_->fail(parts.error());
      return parts.error();
    }
    parts_ = std::move(parts).value();
    display_ = display;
    quality_ = run_quality_ = display.quality;
    if (display.method == "raycast") figures_.front = shipped_front(!display.transfer.empty());
    run_lights_ = {display.appearance.shadow, display.appearance.specular};
    if (draws_detail(display)) figures_.lights = run_lights_;  // rays to a surface
    return {};
  });
  if (!made) return made.error();
  return std::unique_ptr<PictureSink>(std::make_unique<Sink>(*this));
}

void Viewer::set_base(const FrameView& base, const Pose& world_from_approach, bool tool_turns) {
  post([this, base, world_from_approach, tool_turns] {
    base_ = base;
    world_from_approach_ = world_from_approach;
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
  panel_ = std::make_unique<Panel>(*gui_, *state_);
  texture_ = std::make_unique<PictureTexture>(*context_);
  return {};
}

Error Viewer::end_unused(std::thread& drawing, const Error& why) {
  state_->close();
  release();
  drawing.join();
  return why;
}

void Viewer::loop() {
  try {
    draw_until_closed();
  } catch (...) {
    state_->fail(std::current_exception());
  }
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
    jobs_.clear();
  }
  posted_.notify_all();
  texture_.reset();
  slices_.reset();
  gui_.reset();
  parts_ = {};
  context_.reset();
  window_->release();
}

void Viewer::draw_until_closed() {
  Status opened = open();
  if (!opened) {
    state_->fail(opened.error());
  } else {
    changed_at_ = active_at_ = last_frame_ = Steady::now();
    while (!(state_->closed() && released_.load(std::memory_order_acquire))) {
      const auto start = Steady::now();
      serve();
      if (gui_ && !window_->is_lost()) draw_frame();
      const bool idle = whole_ && seconds(Steady::now() - std::max(active_at_, changed_at_)) > kIdleAfter;
      for (auto until = start + kFrame; !wait_for_jobs(until) && idle && until < start + kIdle && !state_->has_events(); until += kFrame) {
      }
    }
  }
}

void Viewer::draw_frame() {
  const int width = window_->width(), height = window_->height();
  if (width < 1 || height < 1) return;  // minimised
  const auto now = Steady::now();
  const double since = seconds(now - last_frame_);
  last_frame_ = now;
  const WindowView view = state_->view();
  const std::vector<WindowEvent> events = state_->take_events();
  if (!events.empty()) active_at_ = now;  // the next frames come soon
  gui_->feed(events);
  fit_texts(view);
  const int side = panel_width(width, gui_->scale());
  state_->set_picture_size(width - side, height);
  const bool turned = !last_camera_ || !(*last_camera_ == view.camera);
  // While a session seeks, its bone is not that of the head yet.
  const bool seeks = view.transport && view.transport->seeks();
  if (base_ && parts_.renderer != nullptr && width > side && !seeks) draw_picture(view, width - side, height);
  if (!seeks) draw_slices(view);
  show(view, width, height, since);
  state_->take_mouse(gui_->wants_mouse());
  if (view.requests.screenshot) take_screenshot(width, height);
  window_->swap();
  if (whole_ && std::exchange(times_refined_, false)) {
    const double after = seconds(Steady::now() - changed_at_);
    figures_.refined_ms = after * 1e3;
    totals_.refined.add(after);
  }
  if (since > 0.0) figures_.frames_per_s += kSmooth * (1.0 / since - figures_.frames_per_s);
  if (view.stage == RunStage::drilling && turned)
    totals_.turning.add(since);
  else if (view.stage == RunStage::drilling && view.live.hand.spin > 0.0)
    totals_.drilling.add(since);
  if (const auto waited = state_->take_latency()) {
    totals_.latency.add(*waited);
    figures_.latency_ms += kSmooth * (*waited * 1e3 - figures_.latency_ms);
  }
}

void Viewer::send_texels() {
  // Just before the texels that grew: a picture in between would end the renderer's search for grown bone.
  if (grown_ && !texels_.empty()) {
    parts_.sink->forget();
    grown_ = false;
  }
  for (const TexelBox& texels : texels_) parts_.sink->update(texels);
  bone_changed_ = bone_changed_ || !texels_.empty();
  slices_stale_ = slices_stale_ || !texels_.empty();
  texels_.clear();
}

Viewer::Change Viewer::find_change(const WindowView& view, int width, int height) const {
  Change out{*base_};
  out.frame.world_from_bone = view.live.world_from_rest * base_->world_from_bone;
  out.frame.camera = view.camera;
  if (view.live.hand.tick > 0 || view.transport)
    out.frame.world_from_tool = tool_turns_ ? turned_tool(view.live.world_from_tool, view.turned) : view.live.world_from_tool;
  out.frame.cut = view.cut.on ? view.cut.plane(world_from_approach_)
                              : make_scene_cut(display_.cut, view.camera, out.frame.world_from_bone, view.live.world_from_tool.translation);
  const auto differ = [](const Pose& a, const Pose& b) { return a.translation != b.translation || a.rotation != b.rotation; };
  const std::optional<Pose>& tool = out.frame.world_from_tool;
  out.turned = !last_camera_ || !(*last_camera_ == view.camera);
  const auto plane = [](const std::optional<FrameView::Cut>& cut) {
    return cut ? std::optional(std::pair(cut->normal, cut->offset)) : std::nullopt;
  };
  const bool bone_moved = !last_bone_ || differ(out.frame.world_from_bone, *last_bone_);
  out.camera = out.turned || bone_moved || plane(out.frame.cut) != plane(last_plane_);
  out.tool = tool.has_value() != last_tool_.has_value() || (tool && differ(*tool, *last_tool_));
  out.bone = bone_changed_;
  out.size = width != picture_width_ || height != picture_height_;
  return out;
}

Status Viewer::restore_run_quality() {
  drawn_ = false;
  parts_.renderer->set_lights(run_lights_);
  if (figures_.lights) figures_.lights = run_lights_;
  return quality_ == run_quality_ ? Status() : parts_.renderer->set_quality(run_quality_);
}

bool Viewer::choose_lights(const WindowView& view) {
  const SurfaceLights wanted = view.requests.lights.value_or(run_lights_);
  if (!figures_.lights || *figures_.lights == wanted) return false;
  parts_.renderer->set_lights(wanted);
  figures_.lights = wanted;
  std::optional<BeforeLights> before;
  if (rest_) before = BeforeLights{std::move(*rest_), figures_.full_ms};
  forget_rest();
  rough_.reset();
  before_lights_ = std::move(before);
  return true;
}

void Viewer::forget_rest() {
  rest_.reset();
  before_lights_.reset();
  figures_.relit.reset();
}

bool Viewer::choose_quality(const WindowView& view, const Change& change) {
  const auto now = Steady::now();
  bool begins = false;
  // A bit that trembles in the hand rests.
  const std::optional<Pose>& tool = change.frame.world_from_tool;
  const bool rests = !tool || (still_tool_ && glm::length(tool->translation - still_tool_->translation) < kStillTool &&
                               std::abs(glm::dot(tool->rotation, still_tool_->rotation)) > kSliceTurn);
  if (!rests) still_tool_ = tool;
  if (change.camera || !rests || change.bone || change.size) {
    changed_at_ = now;
    times_refined_ = false;
    forget_rest();
  }
  if (change.tool) active_at_ = now;
  // A tool that moves without drilling leaves a refined picture as it is.
  if (change.camera || change.bone || view.live.hand.spin > 0.0)
    refined_ = false;
  else if (texels_.empty() && seconds(now - changed_at_) > kRest)
    begins = !std::exchange(refined_, true);
  DrawingQuality wanted = figures_.at_rest = view.requests.quality.value_or(run_quality_);
  if (!refined_) wanted.supersample = 1;
  keeps_rest_ = view.requests.lab;
  if (wanted != quality_) {
    if (!parts_.renderer->set_quality(wanted)) return false;
    quality_ = wanted;
    forget_rest();
  } else if (!choose_lights(view)) {
    return false;
  }
  if (refined_) figures_.full_ms.reset();  // that of another quality
  times_refined_ = begins;
  return true;
}

Result<PictureStep> Viewer::draw_eyes(const FrameView& frame, int width, int height, bool at_once) {
  // Side by side and top-bottom, each eye has half of the picture.
  const bool beside = display_.stereo.mode == StereoMode::side_by_side, above = display_.stereo.mode == StereoMode::top_bottom;
  const int eye_width = beside ? width / 2 : width, eye_height = above ? height / 2 : height;
  const auto cameras = make_eye_cameras(frame.camera, display_.stereo, static_cast<double>(eye_width) / eye_height);
  if (!cameras) return cameras.error();
  const bool alone = cameras->size() == 1;
  std::vector<Image> eyes;
  bool whole = true;
  for (const CameraView& camera : *cameras) {
    FrameView of_eye = frame;
    of_eye.camera = camera;
    if (alone && !at_once) {
      const auto start = Steady::now();
      auto step = parts_.renderer->draw_step(of_eye, eye_width, eye_height, kStep);
      while (step && !step->whole && seconds(Steady::now() - start) < kShowSteps && !state_->has_events() && !wait_for_jobs(start))
        step = parts_.renderer->draw_step(of_eye, eye_width, eye_height, kStep);
      if (!step) return step.error();
      whole = step->whole;
      eyes.push_back(std::move(step->image));
      continue;
    }
    auto image =
        alone ? parts_.renderer->draw_at_pace(of_eye, eye_width, eye_height, pace_) : parts_.renderer->draw(of_eye, eye_width, eye_height);
    if (!image) return image.error();
    eyes.push_back(std::move(image).value());
  }
  std::vector<Image> shown = make_buffer_pictures(display_.stereo, std::move(eyes));
  PictureStep out{shown.front(), whole};
  of_eyes_.clear();
  if (shown.size() > 1) of_eyes_ = std::move(shown);
  return out;
}

void Viewer::show(const WindowView& view, int width, int height, double since) {
  gui_->begin(width, height, since);
  const int side = panel_width(width, gui_->scale());
  if (texture_->name() != 0)
    // ImGui keeps names of OpenGL textures as pointers.  NOLINTNEXTLINE(performance-no-int-to-ptr)
    ImGui::GetBackgroundDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture_->name())),
                                             ImVec2(0.0f, 0.0f), ImVec2(static_cast<float>(width - side), static_cast<float>(height)));
  if (view.mode == CameraMode::microscope) draw_eyepiece(width - side, height);
  if (slices_) show_slices(*slices_, view, *gui_, height);
  if (!note_.empty()) draw_note(note_, *gui_, width - side);
  panel_->draw(view, figures_, width, height);
  gui_->end_layout();
  const bool quad = display_.stereo.mode == StereoMode::quad;
  for (const std::size_t eye : quad ? std::vector<std::size_t>{1, 0} : std::vector<std::size_t>{0}) {  // a screenshot shows the left eye
    if (quad) texture_->draw_to_eye(eye == 0);
    if (eye < of_eyes_.size()) texture_->set(of_eyes_[eye]);
    texture_->clear_window(width, height, kGround);
    gui_->draw();
  }
}

void Viewer::draw_picture(const WindowView& view, int width, int height) {
  // Changed bone waits until it has used no more than its share of the time, so that the tool stays smooth.
  const auto start = Steady::now();
  const bool sends = !texels_.empty() && seconds(start - sent_at_) * config_.bone_share >= bone_time_;
  if (sends) send_texels();
  const Change change = find_change(view, width, height);
  const bool other_quality = choose_quality(view, change);
  const double share = pace_.resolution();
  const bool same = !change.camera && !change.tool && !change.bone && !change.size && !other_quality && !added_changed_;
  if (drawn_ && same && whole_ && !(figures_.coarse && (refined_ || view.live.hand.spin > 0.0))) return;
  // Steps show the last picture in the rest: it must be one of this view.
  auto drawn = draw_eyes(change.frame, width, height, change.camera || !drawn_);
  if (!drawn) return state_->say("The picture cannot be drawn: " + drawn.error().text(), true);
  texture_->set(drawn->image);
  whole_ = drawn->whole;
  const double took = seconds(Steady::now() - start);
  if (sends) {
    sent_at_ = Steady::now();
    bone_time_ = took;
  }
  figures_.coarse = change.turned && share < 1.0;
  figures_.quality = quality_;
  measure(change, other_quality, took, *drawn);
  last_camera_ = change.frame.camera;
  last_plane_ = change.frame.cut;
  last_tool_ = change.frame.world_from_tool;
  last_bone_ = change.frame.world_from_bone;
  picture_width_ = width;
  picture_height_ = height;
  bone_changed_ = added_changed_ = false;
  drawn_ = true;
}

void Viewer::measure(const Change& change, bool other_quality, double took, const PictureStep& drawn) {
  const bool other_view = change.camera || change.bone || change.size;
  if (other_view || other_quality) figures_.moving_psnr.reset();
  all_stale_ = other_quality || change.size || (all_stale_ && !change.camera && !change.bone);
  steps_took_ += took;
  if (other_view || change.tool) rough_.reset();
  if (!drawn.whole) return;
  const double all = std::exchange(steps_took_, 0.0);
  totals_.picture.add(all);
  figures_.picture_ms = all * 1e3;
  if (refined_ && std::exchange(all_stale_, false)) {
    figures_.full_ms = all * 1e3;
    if (rough_) figures_.moving_psnr = psnr_of(*rough_, drawn.image);
    if (const auto before = std::exchange(before_lights_, {}); before && before->full_ms)
      figures_.relit = LightsChange{all * 1e3 - *before->full_ms, psnr_of(before->image, drawn.image)};
  }
  if (refined_ && keeps_rest_) rest_ = drawn.image;
  if (!refined_) rough_ = drawn.image;
}

void Viewer::fit_texts(const WindowView& view) {
  const double person = view.requests.text_scale > 0.0 ? view.requests.text_scale : config_.text_scale;
  const auto wanted = static_cast<float>(person) * window_->scale();
  if (wanted == gui_->scale()) return;
  gui_->rescale(wanted);
  slices_stale_ = true;
}

void Viewer::draw_slices(const WindowView& view) {
  if (!view.requests.slices || !base_ || parts_.renderer == nullptr) {
    slices_.reset();
    slices_stale_ = true;
    return;
  }
  const auto now = Steady::now();
  const Pose bone_from_tool = (view.live.world_from_rest * base_->world_from_bone).inverse() * view.live.world_from_tool;
  const bool moved = glm::length(bone_from_tool.translation - sliced_at_.translation) > kSliceStep ||
                     std::abs(glm::dot(bone_from_tool.rotation, sliced_at_.rotation)) < kSliceTurn;
  if (slices_ && !((moved || slices_stale_) && seconds(now - sliced_) > kSliceEvery)) return;
  auto mineral = parts_.renderer->read_mineral(bone_from_tool.translation, kSliceHalfWidth);
  if (!mineral) return state_->say("The slices cannot be drawn: " + mineral.error().text(), true);
  const int room = (window_->width() - panel_width(window_->width(), gui_->scale())) / 3 - kSliceGaps;
  const int size = std::max(kSmallestSlice, std::min(static_cast<int>(static_cast<float>(kSliceSize) * gui_->scale()), room));
  if (!slices_) slices_ = std::make_unique<PictureTexture>(parts_.renderer->context());
  slices_->set(draw_tip_slices(make_tip_slices(*mineral, tool_look_, bone_from_tool, kSliceHalfWidth, size)));
  sliced_at_ = bone_from_tool;
  sliced_ = now;
  slices_stale_ = false;
}

void Viewer::take_screenshot(int width, int height) {
  state_->with_controls([](Controls& controls) { controls.requests().screenshot = false; });
  if (config_.folder.empty()) return state_->say("There is no output folder for a screenshot", true);
  // Those of an earlier run stay.
  std::filesystem::path path;
  do path = std::filesystem::path(config_.folder) / fmt::format("screenshot-{}.png", ++screenshots_);
  while (std::filesystem::exists(path));
  const Status written = write_png(path, texture_->read_window(width, height));
  state_->say(written ? "Saved " + path.string() : written.error().text(), !written.ok());
}

}  // namespace burrhole
