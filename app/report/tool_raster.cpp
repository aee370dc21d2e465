#include "app/report/tool_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tool/tool_surface.h"

namespace burrhole {
namespace {

constexpr int kOver = 3;  // samples per pixel along each side
constexpr float kNothing = std::numeric_limits<float>::lowest();

std::uint8_t byte_of(double x) noexcept { return static_cast<std::uint8_t>(std::clamp(x, 0.0, 255.0) + 0.5); }

Raster blank(const RasterSize& size) {
  const auto count = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  return {size, std::vector<Rgb>(count, kPaper), std::vector<float>(count, kNothing)};
}

/// Means of kOver x kOver samples; the depth is that of the nearest sample.
Raster reduced(const Raster& fine) {
  Raster out = blank({fine.size.width / kOver, fine.size.height / kOver});
  for (int row = 0; row < out.size.height; ++row)
    for (int column = 0; column < out.size.width; ++column) {
      std::array<int, 3> sum{};
      float& depth = out.depth[out.at(column, row)];
      for (int n = 0; n < kOver * kOver; ++n) {
        const std::size_t from = fine.at(column * kOver + n % kOver, row * kOver + n / kOver);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += fine.pixels[from][c];
        depth = std::max(depth, fine.depth[from]);
      }
      for (std::size_t c = 0; c < 3; ++c) out.pixels[out.at(column, row)][c] = static_cast<std::uint8_t>(sum[c] / (kOver * kOver));
    }
  return out;
}

/// Transform from the plane of a view to samples.
struct Grid {
  SheetFrame frame;
  RasterSize size;
  [[nodiscard]] double column(double u) const noexcept { return (u - frame.u_lo) / (frame.u_hi - frame.u_lo) * size.width; }
  [[nodiscard]] double row(double v) const noexcept { return (v - frame.v_lo) / (frame.v_hi - frame.v_lo) * size.height; }
  [[nodiscard]] int clamped(double x, int most) const noexcept { return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(most))); }
};

/// Draws one triangle with a depth test. Corners are (column, row, depth).
void fill_triangle(Raster& raster, const std::array<Vec3, 3>& corners, const Rgb& colour, const Grid& grid) {
  const auto& [a, b, c] = corners;
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (std::abs(area) < 1e-12) return;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [low, high] = std::minmax({a.y, b.y, c.y});
  for (int row = grid.clamped(low - 0.5, grid.size.height); row < grid.clamped(high + 1.5, grid.size.height); ++row)
    for (int column = grid.clamped(left - 0.5, grid.size.width); column < grid.clamped(right + 1.5, grid.size.width); ++column) {
      const double x = column + 0.5, y = row + 0.5;
      const double s = ((b.x - x) * (c.y - y) - (b.y - y) * (c.x - x)) / area, t = ((c.x - x) * (a.y - y) - (c.y - y) * (a.x - x)) / area;
      if (s < 0.0 || t < 0.0 || s + t > 1.0) continue;
      const auto depth = static_cast<float>(s * a.z + t * b.z + (1.0 - s - t) * c.z);
      const std::size_t at = raster.at(column, row);
      if (depth <= raster.depth[at]) continue;
      raster.depth[at] = depth;
      raster.pixels[at] = colour;
    }
}

/// Whether the surface at `p` with normal `normal` cuts, as the nearest shell point with a similar normal does. Points on edges, with a
/// bisecting normal, count at twice their distance: they decide only for faces too narrow to have points of their own.
bool cuts_at(const PointShell& shell, const Vec3& p, const Vec3& normal) noexcept {
  double best = std::numeric_limits<double>::infinity();
  bool cuts = false;
  for (std::size_t n = 0; n < shell.size(); ++n) {
    const double alike = -glm::dot(shell.inward_normals[n], normal);
    if (alike < 0.5) continue;
    const Vec3 way = shell.positions[n] - p;
    const double squared = glm::dot(way, way) * (alike > 0.9 ? 1.0 : 4.0);
    if (squared >= best) continue;
    best = squared;
    cuts = shell.cutting[n] != 0;
  }
  return cuts;
}

Rgb lit(const Rgb& base, const Vec3& normal, const SheetView& view, bool pale) noexcept {
  const Vec3 lamp = glm::normalize(view.viewer - 0.6 * view.right + 0.5 * view.up);
  const double light = 0.52 + 0.5 * std::max(0.0, glm::dot(normal, lamp));
  Rgb out;
  for (std::size_t c = 0; c < 3; ++c) out[c] = byte_of(pale ? 255.0 - 0.28 * (255.0 - base[c] * light) : base[c] * light);
  return out;
}

/// The section of the cut plane with a triangle, from left to right in (x, z), and the side of the solid.
struct Crossing {
  Vec3 a{0.0}, b{0.0};
  int entering = 0;  ///< +1 if x enters the solid, -1 if it leaves
};

std::vector<Crossing> cross_plane(const TriangleMesh& mesh, double y) {
  std::vector<Crossing> crossings;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = Vec3(mesh.positions[mesh.indices[t + i]]);
    std::vector<Vec3> ends;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &from = p[i], &to = p[(i + 1) % 3];
      if ((from.y > y) != (to.y > y)) ends.push_back(from + (to - from) * ((y - from.y) / (to.y - from.y)));
    }
    const Vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (ends.size() == 2) crossings.push_back({ends[0], ends[1], normal.x < 0.0 ? 1 : -1});
  }
  return crossings;
}

/// One row of the section: inside where the crossings to the left do not cancel.
void fill_row(Raster& raster, const Grid& grid, int row, const std::vector<Crossing>& crossings) {
  const double v = grid.frame.v_lo + (grid.frame.v_hi - grid.frame.v_lo) * (row + 0.5) / grid.size.height;
  std::vector<std::pair<double, int>> steps;
  for (const Crossing& c : crossings) {
    if ((c.a.z > v) == (c.b.z > v)) continue;
    steps.emplace_back(c.a.x + (c.b.x - c.a.x) * ((v - c.a.z) / (c.b.z - c.a.z)), c.entering);
  }
  std::sort(steps.begin(), steps.end());
  int winding = 0;
  for (std::size_t n = 0; n + 1 < steps.size(); ++n) {
    winding += steps[n].second;
    if (winding == 0) continue;
    const int from = grid.clamped(grid.column(steps[n].first) + 0.5, grid.size.width);
    const int to = grid.clamped(grid.column(steps[n + 1].first) + 0.5, grid.size.width);
    for (int column = from; column < to; ++column) raster.pixels[raster.at(column, row)] = kPassive;
  }
}

}  // namespace

SheetView oblique_view() noexcept {
  // 0.35 rad (20 degrees) shows an end face and keeps lengths within 6 %; half a right angle would foreshorten.
  const double turn = 0.45, lift = 0.35;
  const Vec3 viewer(-std::sin(turn) * std::cos(lift), -std::cos(turn) * std::cos(lift), -std::sin(lift));
  const Vec3 right = glm::normalize(glm::cross(Vec3(0.0, 0.0, 1.0), viewer));
  return {right, glm::cross(viewer, right), viewer};
}

void SheetFrame::include(double u, double v) noexcept {
  u_lo = std::min(u_lo, u);
  u_hi = std::max(u_hi, u);
  v_lo = std::min(v_lo, v);
  v_hi = std::max(v_hi, v);
}

SheetFrame SheetFrame::fitted(double margin, double aspect) const noexcept {
  const double room = margin * std::max(u_hi - u_lo, v_hi - v_lo);
  const double width = u_hi - u_lo + 2.0 * room, height = v_hi - v_lo + 2.0 * room;
  const double half_width = 0.5 * std::max(width, aspect * height), middle = 0.5 * (u_lo + u_hi), low = v_lo - room;
  return {middle - half_width, middle + half_width, low, low + std::max(height, width / aspect)};
}

Raster shade_tool(const Tool& tool, const SheetView& view, const SheetFrame& frame, const RasterSize& size, Shading shading) {
  const Grid grid{frame, {size.width * kOver, size.height * kOver}};
  Raster fine = blank(grid.size);
  constexpr double kInside = 2e-5;  // [m] below the surface, where the region of a triangle is asked for
  const bool fluted = shading == Shading::fluted, regions = fluted && tool.surface != nullptr;
  const TriangleMesh& mesh = fluted ? tool.look : tool.mesh;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    std::array<Vec3, 3> corners;
    Vec3 middle(0.0), normal(0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p(mesh.positions[mesh.indices[t + i]]);
      const Vec3 seen = view.project(p);
      corners[i] = {grid.column(seen.x), grid.row(seen.y), seen.z};
      middle += p / 3.0;
      normal += Vec3(mesh.normals[mesh.indices[t + i]]) / 3.0;
    }
    normal = glm::length(normal) > 0.0 ? glm::normalize(normal) : view.viewer;
    if (glm::dot(normal, view.viewer) < -0.2) continue;  // faces away from the viewer; a closed mesh hides it
    const bool cuts = regions ? tool.surface->cuts_at(middle - kInside * normal) : cuts_at(tool.shell, middle, normal);
    fill_triangle(fine, corners, lit(cuts ? kCuts : kSteel, normal, view, shading == Shading::pale), grid);
  }
  return reduced(fine);
}

Rgb factor_colour(double share) noexcept {
  // Light yellow to dark red with even steps of lightness; distinct from the grey of passive parts.
  static constexpr std::array<Rgb, 5> kStops{{{255, 237, 160}, {254, 190, 92}, {248, 131, 56}, {211, 58, 36}, {128, 0, 38}}};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  Rgb out;
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = byte_of(kStops[low][c] + (at - static_cast<double>(low)) * (kStops[low + 1][c] - kStops[low][c]));
  return out;
}

Raster cut_tool(const Tool& tool, const SheetFrame& frame, const RasterSize& size) {
  const Grid grid{frame, {size.width * kOver, size.height * kOver}};
  Raster fine = blank(grid.size);
  const double pitch = tool.erosion.pitch;
  const std::vector<Crossing> crossings = cross_plane(tool.mesh, 0.499 * pitch);
  for (int row = 0; row < grid.size.height; ++row) fill_row(fine, grid, row, crossings);
  const float most = tool.erosion.size() > 0 ? *std::max_element(tool.erosion.factors.begin(), tool.erosion.factors.end()) : 1.0f;
  for (std::size_t n = 0; n < tool.erosion.size(); ++n) {
    const Vec3& p = tool.erosion.positions[n];
    if (std::abs(p.y - 0.5 * pitch) > 0.25 * pitch) continue;
    const Rgb colour = factor_colour(static_cast<double>(tool.erosion.factors[n] / most));
    for (int row = grid.clamped(grid.row(p.z - 0.5 * pitch) + 0.5, grid.size.height);
         row < grid.clamped(grid.row(p.z + 0.5 * pitch) + 0.5, grid.size.height); ++row)
      for (int column = grid.clamped(grid.column(p.x - 0.5 * pitch) + 0.5, grid.size.width);
           column < grid.clamped(grid.column(p.x + 0.5 * pitch) + 0.5, grid.size.width); ++column)
        fine.pixels[fine.at(column, row)] = colour;
  }
  return reduced(fine);
}

}  // namespace burrhole
