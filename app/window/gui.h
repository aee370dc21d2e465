/// app/window/gui.h: Dear ImGui in the context of a window, fed with recorded or live events.
///   Units  pixels.   Errors  unavailable.   Thread  the one that draws; the window's context is current.
#pragma once

#include <memory>
#include <vector>

#include "app/window/window_event.h"
#include "core/base/result.h"

struct ImFont;

namespace burrhole {

/// Colours of a theme, as 0xRRGGBB. Hues differ for people with any colour vision [OkabeIto08]; each text colour has a contrast of at least
/// 4.5 : 1 on `ground` and on `chosen` (WCAG 2.1, 1.4.3).
struct GuiColors {
  unsigned text, sky, orange, green, red, grey;  ///< of texts
  unsigned yellow;                               ///< of marks
  unsigned ground, chosen;                       ///< of a panel, and of the chosen line of a list
  [[nodiscard]] static constexpr GuiColors dark() noexcept {
    return {0xEDF0F2, 0x56B4E9, 0xE69F00, 0x12B886, 0xFF7A33, 0x9AA4AD, 0xF0E442, 0x1A1D21, 0x26323D};
  }
  [[nodiscard]] static constexpr GuiColors light() noexcept {
    return {0x14181C, 0x005A8C, 0x7A4A00, 0x006045, 0xA03400, 0x505860, 0x8A6D00, 0xF0F0F0, 0xCFE0EE};
  }
};

class Gui {
 public:
  /// @param scale of texts and spaces. @param light dark letters on a light ground. unavailable: ImGui's shaders do not build.
  [[nodiscard]] static Result<std::unique_ptr<Gui>> create(float scale, bool light);
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
  ~Gui();

  /// Makes texts and spaces of another size. Between two frames.
  void rescale(float scale);
  [[nodiscard]] const GuiColors& colors() const noexcept { return colors_; }
  /// A button that is pressed and released within one frame is released in the next: the panel sees every click.
  void feed(const std::vector<WindowEvent>& events);
  void begin(int width, int height, double dt);
  /// Draws into the current framebuffer: end_layout() and draw().
  void end();
  void end_layout();
  /// Draws the last layout; once for each eye, where the window has two buffers.
  void draw();
  [[nodiscard]] bool wants_mouse() const;
  [[nodiscard]] float scale() const noexcept { return scale_; }
  [[nodiscard]] ImFont* small() const noexcept { return small_; }
  [[nodiscard]] ImFont* big() const noexcept { return big_; }

 private:
  Gui(float scale, bool light) : scale_(scale), light_(light), colors_(light ? GuiColors::light() : GuiColors::dark()) {}
  /// Fonts and style of scale_.
  void apply_scale();
  float scale_;
  bool light_;
  GuiColors colors_;
  std::vector<WindowEvent> kept_;  // for the next frame
  ImFont *normal_ = nullptr, *small_ = nullptr, *big_ = nullptr;
};

}  // namespace burrhole
