/// app/window/viewer.h: the thread that draws a window: the bone as it is now, from the person's camera, and the panel.
///   The run's thread hands it texels and asks it for the pictures of the report; only this thread uses OpenGL.
///   Frame  world.   Units  SI; pixels.   Errors  unavailable: no OpenGL 4.5, or the window has gone.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/job/picture_sink.h"
#include "app/render/renderer.h"
#include "app/window/glfw_window.h"
#include "app/window/panel.h"
#include "app/window/quality_steps.h"
#include "app/window/window_figures.h"
#include "app/window/window_state.h"
#include "core/base/step_timer.h"

namespace burrhole {

class PictureTexture;

/// A sink for the pictures of a run, and the renderer that it owns and that also draws the window.
struct WindowSinkParts {
  std::unique_ptr<PictureSink> sink;
  Renderer* renderer = nullptr;
};
using MakeWindowSink = std::function<Result<WindowSinkParts>(const DisplayConfig&, const std::string& folder, GlContext context)>;

struct ViewerConfig {
  bool light = false;            ///< dark letters on a light ground
  double text_scale = 1.0;       ///< [-] of the desktop's own scale
  double moving_budget = 0.050;  ///< [s] of a picture while the camera moves
  double coarsest = 0.625;       ///< [-] least share of its width and height that is drawn then
  double bone_share = 0.4;       ///< [-] of the time, at most, for pixels whose bone has changed; a moving tool needs no rays
  std::string folder;            ///< of screenshots; empty: none can be taken
};

class Viewer {
 public:
  Viewer(GlfwWindow& window, WindowState& state, MakeWindowSink make_sink, const ViewerConfig& config);
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer();

  /// The drawing thread: returns when the state is closed and `release()` was called.
  void loop();
  /// The run has ended; nothing will be posted any more.
  void release() noexcept { released_.store(true, std::memory_order_release); }
  /// Nothing will use the window: ends its drawing thread. @returns the reason.
  [[nodiscard]] Error end_unused(std::thread& drawing, const Error& why);
  void set_report(const std::string& path);
  /// After loop() has returned.
  [[nodiscard]] const WindowFigures& totals() const noexcept { return totals_; }

  // Run thread.
  /// Makes the sink on the drawing thread. The viewer must outlive it.
  [[nodiscard]] Result<std::unique_ptr<PictureSink>> make_sink(const DisplayConfig& display, const std::string& folder);
  /// Sets light, background and place of the bone, and of the plan.
  void set_base(const FrameView& base, const Pose& world_from_approach, bool tool_turns);
  /// Runs f on the drawing thread and waits. unavailable: that thread has ended.
  [[nodiscard]] Status call(const std::function<Status()>& f);
  /// Runs f there later, in the order of the posts.
  void post(std::function<void()> f);

 private:
  class Sink;
  using Time = std::chrono::steady_clock::time_point;

  [[nodiscard]] Status open();
  void draw_until_closed();
  void serve();
  /// @returns whether somebody waits for a job; otherwise after `until`.
  bool wait_for_jobs(Time until);
  void draw_frame();
  void send_texels();
  void draw_picture(const WindowView& view, int width, int height);
  /// What the next picture shows, and which parts of it differ from the last.
  struct Change {
    FrameView frame;
    bool turned = false;                                            // the camera
    bool camera = false, tool = false, bone = false, size = false;  // camera: or the cut, or the pose of the bone
  };
  [[nodiscard]] Change find_change(const WindowView& view, int width, int height) const;
  /// Decides on one ray a pixel or on the scene's quality. @returns whether it changed.
  bool choose_quality(const WindowView& view, const Change& change);
  /// Sets the shadows and highlights that the person wants. @returns whether they changed.
  bool choose_lights(const WindowView& view);
  /// The pictures of a run have its quality and lights, whatever the window shows.
  [[nodiscard]] Status restore_run_quality();
  /// Another view or quality: pictures that were kept for comparison are no longer of it.
  void forget_rest();
  /// One picture, or those of both eyes joined, as the scene's stereo says. @param at_once a picture is drawn as a whole, if the view
  /// has moved at its pace; otherwise the picture of one eye is drawn in steps.
  [[nodiscard]] Result<PictureStep> draw_eyes(const FrameView& frame, int width, int height, bool at_once);
  /// Draws picture and panel into the window: once, or into the buffer of each eye.
  void show(const WindowView& view, int width, int height, double since);
  /// Makes texts of the size that desktop and person want.
  void fit_texts(const WindowView& view);
  /// Keeps what a picture has cost, and its difference from the coarser one of the same view.
  void measure(const Change& change, bool other_quality, double took, const PictureStep& drawn);
  /// Draws the slices through the tip, if they are asked for and bone or tip has changed.
  void draw_slices(const WindowView& view);
  void take_screenshot(int width, int height);

  GlfwWindow* window_;
  WindowState* state_;
  MakeWindowSink make_parts_;
  ViewerConfig config_;

  std::mutex mutex_;
  std::condition_variable posted_;
  std::deque<std::function<void()>> jobs_;
  int waited_for_ = 0;  // jobs that a call() waits for
  bool ended_ = false;
  std::atomic<bool> released_{false};

  // Drawing thread.
  std::optional<GlContext> context_;  // until the renderer has it
  std::unique_ptr<Gui> gui_;
  std::unique_ptr<Panel> panel_;
  WindowSinkParts parts_;
  DisplayConfig display_;
  std::unique_ptr<PictureTexture> texture_, slices_;  // slices_: null while they are not asked for
  TriangleMesh tool_look_;
  Pose sliced_at_;
  bool slices_stale_ = true;
  Time sliced_{};
  std::optional<FrameView> base_;
  std::string note_;  // of the volume: what of the picture is assumed
  bool tool_turns_ = true, bone_changed_ = false, added_changed_ = false, drawn_ = false, refined_ = true, grown_ = false;
  bool whole_ = true;                     // false: the picture is drawn in steps, and pixels are missing
  DrawingQuality quality_, run_quality_;  // of the last picture; of the pictures of the run
  SurfaceLights run_lights_;
  std::vector<Image> of_eyes_;  // of the last picture, in the mode quad
  DynamicResolution pace_;
  double steps_took_ = 0.0;  // [s] of the picture that is drawn in steps
  bool all_stale_ = false;   // they were, and nothing else has changed since
  Pose world_from_approach_;
  std::optional<CameraView> last_camera_;
  std::optional<FrameView::Cut> last_plane_;
  std::optional<Pose> last_tool_;
  std::optional<Pose> last_bone_;   // of the last picture
  std::optional<Pose> still_tool_;  // where the tool has rested since the last change
  std::vector<TexelBox> texels_;    // of changed bone, not sent to the renderer yet
  double bone_time_ = 0.0;          // [s] of the last picture with changed bone
  // Of what the picture shows; of that, or events; of the last picture; of the last bone; of the change after which a picture is refined.
  Time changed_at_{}, active_at_{}, last_frame_{}, sent_at_{};
  bool times_refined_ = false;  // the picture that is drawn now is the first refined one after a change
  std::optional<Image> rough_;  // the last picture that was not refined, of the present view
  std::optional<Image> rest_;   // the last whole refined picture, of the present view
  /// That before shadows and highlights were changed, until the one after is whole.
  struct BeforeLights {
    Image image;
    std::optional<double> full_ms;
  };
  std::optional<BeforeLights> before_lights_;
  bool keeps_rest_ = false;  // the panel of the lab is open, which shows the comparison
  int picture_width_ = 0, picture_height_ = 0, screenshots_ = 0;
  DisplayFigures figures_;
  WindowFigures totals_;
};

}  // namespace burrhole
