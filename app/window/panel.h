/// app/window/panel.h: what a person reads beside and over the picture, and its buttons.
///   Units  as the texts say.   Errors  none.   Thread  the one that draws, between Gui::begin() and Gui::end().
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/view/quality.h"
#include "app/window/gui.h"
#include "app/window/quality_steps.h"
#include "app/window/window_state.h"

namespace burrhole {

/// Figures of the display itself.
struct DisplayFigures {
  double frames_per_s = 0.0;
  double picture_ms = 0.0;                ///< time of the latest picture
  double latency_ms = 0.0;                ///< from an event to the picture that shows it, smoothed
  DrawingQuality quality;                 ///< of the latest picture
  DrawingQuality at_rest;                 ///< wanted of a picture at rest
  std::span<const QualityPoint> front{};  ///< what is known of qualities of this display; empty: nothing
  std::optional<double> full_ms{};        ///< time of the last picture at rest of which all pixels were drawn, at this quality
  std::optional<double> moving_psnr{};    ///< [dB] of the last picture before it was refined against that at rest, of the same view
  std::optional<SurfaceLights> lights{};  ///< of the latest picture; absent: this display has no shadows and highlights
  std::optional<LightsChange> relit{};    ///< absent: not changed yet, or the view has changed since
  double refined_ms = 0.0;                ///< from the last change to the latest picture at rest; 0: none yet
  bool coarse = false;                    ///< the latest picture is coarser than one at rest
};

/// Keeps the last seconds of force and depth for the plots.
class PanelHistory {
 public:
  static constexpr std::size_t kMost = 600;
  /// @param jumps a session may go on at another time: what was before is another part of it. A run does not jump, but its window may stall.
  void add(double time, double force, double depth, bool jumps);
  [[nodiscard]] const std::vector<float>& force() const noexcept { return force_; }
  [[nodiscard]] const std::vector<float>& depth() const noexcept { return depth_; }
  [[nodiscard]] double feed() const noexcept { return feed_; }  ///< [mm/s] over the last half second

 private:
  std::vector<float> force_, depth_;
  std::vector<double> time_;
  double feed_ = 0.0;
};

/// Width of the panel [pixels] in a window of that width.
[[nodiscard]] int panel_width(int window_width, float scale) noexcept;

/// The latest values of a figure, for a percentile.
class LatestValues {
 public:
  void add(float value);
  /// @returns the value that `share` of them do not exceed; 0 without any.
  [[nodiscard]] float at(double share) const;

 private:
  static constexpr std::size_t kMost = 512;
  std::vector<float> values_;
  std::size_t next_ = 0;
};

/// Draws everything but the picture.
class Panel {
 public:
  Panel(const Gui& gui, WindowState& state) : gui_(&gui), state_(&state) {}
  void draw(const WindowView& view, const DisplayFigures& figures, int width, int height);
  /// Path of the report, shown at the end; empty: none.
  void set_report(const std::string& path) { report_ = path; }

 private:
  void side(const WindowView& view, const DisplayFigures& figures, int width, int height);
  void push_gauge(const WindowView& view);
  void figures_of(const WindowView& view);
  void zone(const ZoneReading& zone);
  void layers(const WindowView& view);
  void drive(const WindowView& view);
  void instruments(const WindowView& view);
  void tools(const WindowView& view);
  void buttons(const WindowView& view);
  void lab(const WindowView& view, const DisplayFigures& figures);
  void text_buttons(float wide);
  void quality(const WindowView& view, const DisplayFigures& figures, int width, int height);
  void over_picture(const WindowView& view, const DisplayFigures& figures, int width, int height);
  [[nodiscard]] bool has_hints(const WindowView& view) const noexcept;
  void warnings(const WindowView& view, int width);
  /// @returns the height [pixels] of what it draws.
  float hints(const WindowView& view, int width, int height);
  void help(bool watches, int width, int height);
  void end_question(int width, int height);
  void end_screen(int width, int height);
  void big(const char* label, const std::string& value, unsigned color);

  const Gui* gui_;
  WindowState* state_;
  WindowPlan plan_;
  PanelHistory history_;
  LatestValues servo_us_, contact_us_, bone_us_;
  std::string report_;
  int checkpoints_ = 0;
};

}  // namespace burrhole
