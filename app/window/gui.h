/// app/window/gui.h: Dear ImGui in the context of a window, fed with recorded or live events.
///   Units  pixels.   Errors  unavailable.   Thread  the one that draws; the window's context is current.
#pragma once

#include <memory>
#include <vector>

#include "app/window/window_event.h"
#include "core/base/result.h"

struct ImFont;

namespace burrhole {

/// Colours that differ for people with any colour vision [OkabeIto08], as 0xRRGGBB.
struct GuiColors {
  static constexpr unsigned kSky = 0x56B4E9, kOrange = 0xE69F00, kGreen = 0x009E73, kRed = 0xD55E00, kYellow = 0xF0E442, kGrey = 0x9AA4AD;
};

class Gui {
 public:
  /// @param scale of texts and spaces. @param light dark letters on a light ground. unavailable: ImGui's shaders do not build.
  [[nodiscard]] static Result<std::unique_ptr<Gui>> create(float scale, bool light);
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
  ~Gui();

  /// A button that is pressed and released within one frame is released in the next: the panel sees every click.
  void feed(const std::vector<WindowEvent>& events);
  void begin(int width, int height, double dt);
  /// Draws into the current framebuffer.
  void end();
  [[nodiscard]] bool wants_mouse() const;
  [[nodiscard]] float scale() const noexcept { return scale_; }
  [[nodiscard]] ImFont* small() const noexcept { return small_; }
  [[nodiscard]] ImFont* big() const noexcept { return big_; }

 private:
  explicit Gui(float scale) : scale_(scale) {}
  float scale_;
  std::vector<WindowEvent> kept_;  // for the next frame
  ImFont *normal_ = nullptr, *small_ = nullptr, *big_ = nullptr;
};

}  // namespace burrhole
