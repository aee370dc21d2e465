/// app/report/tool_raster.h: a bit as small pictures, made in memory: shaded from outside with a depth for every pixel, and cut through the
///   axis. No OpenGL: the report draws bits where nothing else can.
///   Frame  a view's plane: u to the right, v up, [m]; depth grows towards the viewer.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/tool/tool.h"

namespace burrhole {

using Rgb = std::array<std::uint8_t, 3>;

/// Parallel projection.
struct SheetView {
  Vec3 right{1.0, 0.0, 0.0}, up{0.0, 0.0, 1.0}, viewer{0.0, -1.0, 0.0};  ///< unit, at right angles
  [[nodiscard]] Vec3 project(const Vec3& p) const noexcept { return {glm::dot(p, right), glm::dot(p, up), glm::dot(p, viewer)}; }
};
/// Seen from the side and a little from below, so that the working end shows.
[[nodiscard]] SheetView oblique_view() noexcept;

/// Part of a view's plane [m]; empty until something is included.
struct SheetFrame {
  double u_lo = std::numeric_limits<double>::infinity(), u_hi = -std::numeric_limits<double>::infinity();
  double v_lo = std::numeric_limits<double>::infinity(), v_hi = -std::numeric_limits<double>::infinity();
  void include(double u, double v) noexcept;
  /// Grown by `margin` of its size, then to both sides, or upwards, until width / height is `aspect`.
  [[nodiscard]] SheetFrame fitted(double margin, double aspect) const noexcept;
};

struct RasterSize {
  int width = 0, height = 0;  ///< [px]
};

struct Raster {
  RasterSize size;
  std::vector<Rgb> pixels;   ///< row after row from the bottom
  std::vector<float> depth;  ///< [m] towards the viewer; lowest() where nothing is
  [[nodiscard]] std::size_t at(int column, int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(column);
  }
};

inline constexpr Rgb kPaper{255, 255, 255}, kSteel{176, 184, 192}, kCuts{222, 120, 48}, kPassive{205, 208, 212};

/// The mesh with soft light from the upper left. Triangles next to cutting shell points are warm, the others steel.
[[nodiscard]] Raster shade_tool(const Tool& tool, const SheetView& view, const SheetFrame& frame, const RasterSize& size, bool pale);
/// Colour of an erosion factor as a share of the greatest, 0..1: light to dark.
[[nodiscard]] Rgb factor_colour(double share) noexcept;
/// Cut along the x-z plane through the layer of erosion points next to it: their cells by factor, the rest of the tool kPassive.
[[nodiscard]] Raster cut_tool(const Tool& tool, const SheetFrame& frame, const RasterSize& size);

}  // namespace burrhole
