/// app/bench/render_canvas.h: a renderer with one view, for rows of the area render.
#pragma once

#include "app/bench/bench.h"
#include "app/view/texels.h"
#include "app/render/renderer.h"

namespace burrhole {

inline constexpr int kCanvasSide = 512;  ///< [pixels]

/// Draws and keeps the first fault, which ends the area.
struct Canvas {
  Renderer renderer;
  FrameView view;
  Image image;  ///< the last picture
  Status fault;

  [[nodiscard]] static Result<Canvas> create(const RenderOptions& options, const FrameView& view);
  void draw();
  void set_volume(const VolumeView& volume);
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_of(image.pixels); }
};

/// A transfer function by which the opacity of a voxel's length equals the density: extinction -ln(1 - density) / edge, edge in m.
[[nodiscard]] TransferFunction density_as_opacity(double edge);

/// What rays cost, with and without skipping, shading and keeping; against slices. @param what names the scene in the rows.
/// @param bars of samples a frame: of a surface, of bone whose density is its opacity.
[[nodiscard]] Status compare_rays(Bench& bench, const VolumeView& volume, const FrameView& view, const std::string& what,
                                  const Bars& surface_samples, const Bars& translucent_samples);

}  // namespace burrhole
