/// app/lab/render_stand.h: a renderer with a volume and a view, for the drawing study, and the CPU time of its pictures.
///   Units  in the names.   Frame  that of the view.   Errors  those of a renderer.   Thread  one.
#pragma once

#include <limits>
#include <string>

#include "app/render/renderer.h"

namespace burrhole {

inline constexpr DrawingQuality kShippedQuality{.supersample = 2};  ///< the default of scenes

struct StandView {
  FrameView view;
  int width = 0, height = 0;  ///< [pixels]
};

class Stand {
 public:
  [[nodiscard]] static Result<Stand> create(GlBackend gl, RenderOptions how, const VolumeView& volume, const StandView& view);
  [[nodiscard]] Result<Image> draw(const DrawingQuality& quality);
  [[nodiscard]] double bytes() const;  ///< [bytes] of the volume and its skip map
  [[nodiscard]] std::string driver() const { return renderer_.driver(); }

 private:
  Stand(Renderer renderer, const StandView& view) : renderer_(std::move(renderer)), view_(view) {}
  Renderer renderer_;
  StandView view_;
};

struct Drawn {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Image image;
  double median_us = kNone, p99_us = kNone;  ///< CPU time of a picture
  double over_shipped = kNone;               ///< [-] median over that of the default quality of scenes
};

/// Draws one picture untimed, then times pictures interleaved with `shipped` at the default quality, of which a third suffices.
[[nodiscard]] Result<Drawn> draw_timed(Stand& stand, const DrawingQuality& quality, Stand& shipped, int frames);

}  // namespace burrhole
