/// app/report/plot_labels.h: places of the names of points in a panel, so that no two overlap.
///   Frame  picture, x to the right, y up.   Units  pixels [px].   Errors  none.
///   Source  own derivation: one name after the other takes the place that costs least.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace burrhole {

struct PlotPoint {
  double x = 0.0, y = 0.0;  ///< [px]
};

struct PlotBox {
  PlotPoint lo, hi;

  [[nodiscard]] PlotPoint middle() const noexcept { return {0.5 * (lo.x + hi.x), 0.5 * (lo.y + hi.y)}; }
  [[nodiscard]] bool overlaps(const PlotBox& b) const noexcept { return lo.x < b.hi.x && b.lo.x < hi.x && lo.y < b.hi.y && b.lo.y < hi.y; }
  [[nodiscard]] bool contains(const PlotBox& b) const noexcept {
    return b.lo.x >= lo.x && b.lo.y >= lo.y && b.hi.x <= hi.x && b.hi.y <= hi.y;
  }
};

struct PlotLine {
  PlotPoint from, to;
};

/// A name and the point to which it belongs; its box includes the space around it.
struct PointName {
  PlotPoint at;
  double width = 0.0, height = 0.0;  ///< [px]
};

/// What is in the panel beside the names.
struct PanelContents {
  PlotBox frame;                   ///< names stay inside
  std::vector<PlotBox> covered{};  ///< no name here, such as the legend
  std::vector<PlotPoint> marks{};  ///< markers of points, avoided where there is room elsewhere
  std::vector<PlotLine> lines{};   ///< likewise
};

struct PlacedName {
  PlotBox box;
  std::optional<PlotLine> leader{};  ///< from the point's marker to the box, where the box is not beside it
};

/// @returns one place per name, in their order; nothing where the frame has no room left. No two boxes overlap, and none overlaps `covered`.
[[nodiscard]] std::vector<std::optional<PlacedName>> place_names(std::span<const PointName> names, const PanelContents& contents);

}  // namespace burrhole
