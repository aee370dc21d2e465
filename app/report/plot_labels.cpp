#include "app/report/plot_labels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kMarkRadius = 6.0;  // [px] of the largest marker
// Distances [px] of the box from its point, and directions round it; the first is the upper left.
constexpr double kNear = 1.0;
constexpr double kSteps[] = {kNear, 7.0, 14.0, 22.0, 32.0, 44.0, 58.0, 74.0, 92.0, 112.0, 134.0, 160.0};
constexpr int kDirections = 16;

// Costs, in pixels of distance that they are worth.
constexpr double kOnMark = 10.0, kOnLine = 12.0, kLeaderCrosses = 40.0, kLeaderOverMark = 6.0;

double cross(const PlotPoint& a, const PlotPoint& b, const PlotPoint& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool cross(const PlotLine& a, const PlotLine& b) {
  return cross(a.from, a.to, b.from) * cross(a.from, a.to, b.to) < 0.0 && cross(b.from, b.to, a.from) * cross(b.from, b.to, a.to) < 0.0;
}

bool meets(const PlotLine& line, const PlotBox& box) {
  if (std::max(line.from.x, line.to.x) < box.lo.x || std::min(line.from.x, line.to.x) > box.hi.x) return false;
  if (std::max(line.from.y, line.to.y) < box.lo.y || std::min(line.from.y, line.to.y) > box.hi.y) return false;
  // Corners on both sides of the line.
  double least = INFINITY, most = -INFINITY;
  for (const PlotPoint& corner : {box.lo, PlotPoint{box.hi.x, box.lo.y}, box.hi, PlotPoint{box.lo.x, box.hi.y}}) {
    const double side = cross(line.from, line.to, corner);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least <= 0.0 && most >= 0.0;
}

PlotPoint nearest_of(const PlotBox& box, const PlotPoint& p) {
  return {std::clamp(p.x, box.lo.x, box.hi.x), std::clamp(p.y, box.lo.y, box.hi.y)};
}

bool meets(const PlotPoint& mark, const PlotBox& box) {
  const PlotPoint near = nearest_of(box, mark);
  return std::hypot(near.x - mark.x, near.y - mark.y) < kMarkRadius;
}

PlotBox round_point(const PlotPoint& p, double radius) { return {{p.x - radius, p.y - radius}, {p.x + radius, p.y + radius}}; }

/// The box of a name at a distance from its point's marker.
PlotBox box_at(const PointName& name, double distance, int direction) {
  const double angle = std::numbers::pi * (0.75 - 2.0 * direction / kDirections);
  const double half_x = 0.5 * name.width, half_y = 0.5 * name.height, reach = kMarkRadius + distance;
  // Diagonally the nearest corner of the box, otherwise one of its sides has this distance.
  const auto shift = [reach](double way, double half) { return reach * way + half * std::clamp(std::numbers::sqrt2 * way, -1.0, 1.0); };
  const PlotPoint middle{name.at.x + shift(std::cos(angle), half_x), name.at.y + shift(std::sin(angle), half_y)};
  return {{middle.x - half_x, middle.y - half_y}, {middle.x + half_x, middle.y + half_y}};
}

/// From the edge of the marker to the nearest point of the box.
PlotLine leader_to(const PlotPoint& at, const PlotBox& box) {
  const PlotPoint end = nearest_of(box, at);
  const double length = std::max(1e-9, std::hypot(end.x - at.x, end.y - at.y)), share = std::min(1.0, kMarkRadius / length);
  return {{at.x + share * (end.x - at.x), at.y + share * (end.y - at.y)}, end};
}

double cost_of(const PlacedName& place, const PanelContents& contents, const std::vector<std::optional<PlacedName>>& others) {
  double cost = 0.0;
  for (const PlotPoint& mark : contents.marks) {
    if (meets(mark, place.box)) cost += kOnMark;
    if (place.leader && meets(*place.leader, round_point(mark, 0.5 * kMarkRadius))) cost += kLeaderOverMark;
  }
  for (const PlotLine& line : contents.lines)
    if (meets(line, place.box)) cost += kOnLine;
  for (const auto& other : others) {
    if (!other) continue;
    if (place.leader && (meets(*place.leader, other->box) || (other->leader && cross(*place.leader, *other->leader))))
      cost += kLeaderCrosses;
    if (other->leader && meets(*other->leader, place.box)) cost += kLeaderCrosses;
  }
  return cost;
}

}  // namespace

std::vector<std::optional<PlacedName>> place_names(std::span<const PointName> names, const PanelContents& contents) {
  std::vector<std::optional<PlacedName>> out;
  for (const PointName& name : names) {
    std::optional<PlacedName> best;
    double least = INFINITY;
    for (const double distance : kSteps)
      for (int direction = 0; direction < kDirections; ++direction) {
        const PlotBox box = box_at(name, distance, direction);
        const auto taken = [&](const PlotBox& b) { return b.overlaps(box); };
        if (!contents.frame.contains(box) || std::ranges::any_of(contents.covered, taken)) continue;
        if (std::ranges::any_of(out, [&](const auto& other) { return other && taken(other->box); })) continue;
        PlacedName place{box};
        if (distance > kNear) place.leader = leader_to(name.at, box);
        const double cost = distance + cost_of(place, contents, out);
        if (cost >= least) continue;
        least = cost;
        best = place;
      }
    out.push_back(best);
  }
  return out;
}

}  // namespace burrhole
