/// app/bench/render_canvas.h: a renderer with one view, for rows of the area render.
///   Frame  world.   Units  SI.   Thread  main; owns a GL context.   Errors  unavailable without OpenGL; those of drawing, in
///   Canvas::error.
#pragma once

#include "app/bench/bench.h"
#include "app/render/renderer.h"
#include "app/view/texels.h"

namespace burrhole {

inline constexpr int kCanvasSide = 512;  ///< [pixels]

/// Draws pictures and keeps the first error.
struct Canvas {
  Renderer renderer;
  FrameView view;
  Image image;   ///< the last picture
  Status error;  ///< the first error of draw() and set_volume()

  [[nodiscard]] static Result<Canvas> create(const RenderOptions& options, const FrameView& view);
  void draw();
  void set_volume(const VolumeView& volume);
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_of(image.pixels); }
};

/// @returns a transfer function for which the opacity over a voxel edge equals the density: extinction -ln(1 - density) / edge [1/m].
/// @param edge [m].
[[nodiscard]] TransferFunction density_as_opacity(double edge);

/// Times ray casting with and without empty-space skipping and shading, and against slices. @param what name of the scene in the rows.
/// @param surface_samples, translucent_samples targets for the million samples of a frame: first hit, and density as opacity.
[[nodiscard]] Status compare_rays(Bench& bench, const VolumeView& volume, const FrameView& view, const std::string& what,
                                  const Bars& surface_samples, const Bars& translucent_samples);

}  // namespace burrhole
