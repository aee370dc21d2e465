/// app/report/tool_raster.h: pictures of a bit, made in memory: shaded from outside with a depth per pixel, and a section through the axis.
///   No OpenGL, so the report can draw bits on any machine.
///   Frame  plane of a view: u to the right, v up; depth increases towards the viewer.   Units  SI.   Errors  none.
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
  Vec3 right{1.0, 0.0, 0.0}, up{0.0, 0.0, 1.0}, viewer{0.0, -1.0, 0.0};  ///< [-] unit vectors at right angles
  [[nodiscard]] Vec3 project(const Vec3& p) const noexcept { return {glm::dot(p, right), glm::dot(p, up), glm::dot(p, viewer)}; }
};
/// View from the side and slightly from below, which shows the working end.
[[nodiscard]] SheetView oblique_view() noexcept;

/// Range of the plane of a view [m]; empty until a point is included.
struct SheetFrame {
  double u_lo = std::numeric_limits<double>::infinity(), u_hi = -std::numeric_limits<double>::infinity();  ///< [m]
  double v_lo = std::numeric_limits<double>::infinity(), v_hi = -std::numeric_limits<double>::infinity();  ///< [m]
  void include(double u, double v) noexcept;
  /// @returns the frame grown by `margin` of its size, then to both sides or upwards until width / height is `aspect`.
  [[nodiscard]] SheetFrame fitted(double margin, double aspect) const noexcept;
};

struct RasterSize {
  int width = 0, height = 0;  ///< [px]
};

struct Raster {
  RasterSize size;
  std::vector<Rgb> pixels;   ///< row by row from the bottom
  std::vector<float> depth;  ///< [m] towards the viewer; lowest() where there is no surface
  [[nodiscard]] std::size_t at(int column, int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(column);
  }
};

inline constexpr Rgb kPaper{255, 255, 255}, kSteel{176, 184, 192}, kCuts{222, 120, 48}, kPassive{205, 208, 212};

/// What of a bit is drawn: the solid that it sweeps, the same in pale colours under its points, or the bit with its flutes and edges.
enum class Shading { solid, pale, fluted };

/// Draws the mesh with soft light from the upper left. Triangles next to cutting shell points have a warm colour, the others that of steel;
/// of fluted bits, those of regions that cut.
[[nodiscard]] Raster shade_tool(const Tool& tool, const SheetView& view, const SheetFrame& frame, const RasterSize& size, Shading shading);
/// @returns the colour of an erosion factor as a share of the largest, 0..1: light to dark.
[[nodiscard]] Rgb factor_colour(double share) noexcept;
/// Draws the section along the x-z plane through the adjacent layer of erosion points: cells by factor, the rest of the tool kPassive.
[[nodiscard]] Raster cut_tool(const Tool& tool, const SheetFrame& frame, const RasterSize& size);

}  // namespace burrhole
