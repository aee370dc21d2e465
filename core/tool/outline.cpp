#include "core/tool/outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kArcSteps = 128;

/// Angle in [0, pi] whose cosine is c, by bisection on portable_cos: std::acos may differ between machines.
double portable_acos(double c) noexcept {
  if (c >= 1.0) return 0.0;
  if (c <= -1.0) return kPi;
  double low = 0.0, high = kPi;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (portable_cos(middle) > c ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Meridian arc_point(const OutlinePiece& piece, double angle) noexcept {
  return {piece.radius * portable_sin(angle), piece.centre - piece.half_height * portable_cos(angle)};
}

/// Angle on an arc at a fraction of its length, by the table of lengths.
double arc_angle(const OutlinePiece& piece, double fraction) noexcept {
  const double along = fraction * piece.arc_length.back();
  const auto above = std::upper_bound(piece.arc_length.begin() + 1, piece.arc_length.end() - 1, along);
  const auto step = static_cast<double>(above - piece.arc_length.begin() - 1);
  const double part = (along - *(above - 1)) / (*above - *(above - 1));
  return piece.start_angle + (piece.end_angle - piece.start_angle) * ((step + part) / static_cast<double>(kArcSteps));
}

OutlinePiece make_line(std::size_t solid, Face face, const Meridian& start, const Meridian& end) {
  OutlinePiece piece;
  piece.solid = solid;
  piece.face = face;
  piece.start = start;
  piece.end = end;
  return piece;
}

/// Side of one solid between two heights.
OutlinePiece make_side(const Solid& shape, std::size_t solid, double z_start, double z_end) {
  OutlinePiece piece = make_line(solid, Face::side, {shape.radius(z_start), z_start}, {shape.radius(z_end), z_end});
  if (shape.kind != SolidKind::ellipsoid) return piece;
  piece.curved = true;
  piece.radius = shape.low_radius;
  piece.half_height = 0.5 * shape.height();
  piece.centre = 0.5 * (shape.z_low + shape.z_high);
  piece.start_angle = portable_acos((piece.centre - z_start) / piece.half_height);
  piece.end_angle = portable_acos((piece.centre - z_end) / piece.half_height);
  piece.arc_length.push_back(0.0);
  Meridian before = piece.start;
  for (std::size_t i = 1; i <= kArcSteps; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(kArcSteps);
    const Meridian here = arc_point(piece, piece.start_angle + (piece.end_angle - piece.start_angle) * part);
    piece.arc_length.push_back(piece.arc_length.back() + glm::length(here - before));
    before = here;
  }
  return piece;
}

/// Heights where the widest solid may change: ends of solids, and crossings of two profiles, where r_a^2(z) - r_b^2(z) = 0, a quadratic.
std::vector<double> find_breaks(std::span<const Solid> solids) {
  std::vector<double> breaks;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    breaks.push_back(solids[i].z_low);
    breaks.push_back(solids[i].z_high);
    for (std::size_t j = i + 1; j < solids.size(); ++j) {
      const auto p = solids[i].squared_radius_form(), q = solids[j].squared_radius_form();
      const double a = p.a - q.a, b = p.b - q.b, c = p.c - q.c;
      const double low = std::max(solids[i].z_low, solids[j].z_low), high = std::min(solids[i].z_high, solids[j].z_high);
      const auto keep = [&](double z) {
        if (z > low && z < high) breaks.push_back(z);
      };
      if (a == 0.0) {
        if (b != 0.0) keep(-c / b);
      } else if (const double d = b * b - 4.0 * a * c; d > 0.0) {
        const double w = -0.5 * (b + (b < 0.0 ? -std::sqrt(d) : std::sqrt(d)));  // the root that does not cancel, then by c / w
        keep(w / a);
        if (w != 0.0) keep(c / w);
      }
    }
  }
  std::sort(breaks.begin(), breaks.end());
  const auto same = [](double x, double y) { return y - x < kOutlineTolerance; };
  breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
  return breaks;
}

/// Widest solid over a whole interval between breaks, the first listed when equal.
std::optional<std::size_t> find_owner(std::span<const Solid> solids, double z_low, double z_high) {
  const double middle = 0.5 * (z_low + z_high);
  std::optional<std::size_t> owner;
  double widest = 0.0;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const bool covers = solids[i].z_low < middle && solids[i].z_high > middle;
    const double r = solids[i].radius(middle);
    if (covers && (!owner || r > widest + 1e-3 * kOutlineTolerance)) {
      owner = i;
      widest = r;
    }
  }
  return owner;
}

double distance_to_segment(const Meridian& p, const Meridian& a, const Meridian& b) noexcept {
  const Meridian along = b - a;
  const double t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
  return glm::length(p - (a + t * along));
}

double distance_to_piece(const OutlinePiece& piece, const Meridian& p) noexcept {
  if (!piece.curved) return distance_to_segment(p, piece.start, piece.end);
  double nearest = std::numeric_limits<double>::infinity();
  Meridian before = piece.start;
  for (std::size_t i = 1; i <= kArcSteps; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(kArcSteps);
    const Meridian here = i == kArcSteps ? piece.end : arc_point(piece, piece.start_angle + (piece.end_angle - piece.start_angle) * part);
    nearest = std::min(nearest, distance_to_segment(p, before, here));
    before = here;
  }
  return nearest;
}

/// Flat face between two sides at one height, or the cap at an end; nothing where the profile goes on without a step.
void add_ledge(std::vector<OutlinePiece>& outline, double r_below, double r_above, double z, std::size_t below, std::size_t above) {
  // A profile is continuous within its solid: a step outward is the bottom of the solid that begins here, one inward the top of one ending.
  if (r_above > r_below + kOutlineTolerance) outline.push_back(make_line(above, Face::bottom, {r_below, z}, {r_above, z}));
  if (r_below > r_above + kOutlineTolerance) outline.push_back(make_line(below, Face::top, {r_below, z}, {r_above, z}));
}

/// Makes neighbours share their point, and the poles lie on the axis, to the last bit: a mesh made from the line is then closed.
void join_ends(std::vector<OutlinePiece>& outline) {
  for (std::size_t i = 1; i < outline.size(); ++i) outline[i].start = outline[i - 1].end;
  if (outline.front().start.x < kOutlineTolerance) outline.front().start.x = 0.0;
  if (outline.back().end.x < kOutlineTolerance) outline.back().end.x = 0.0;
}

}  // namespace

double OutlinePiece::length() const noexcept { return curved ? arc_length.back() : glm::length(end - start); }

Meridian OutlinePiece::point(double fraction) const noexcept {
  if (fraction <= 0.0) return start;
  if (fraction >= 1.0) return end;
  return curved ? arc_point(*this, arc_angle(*this, fraction)) : start + fraction * (end - start);
}

Meridian OutlinePiece::outward(double fraction) const noexcept {
  if (!curved) {
    const Meridian along = glm::normalize(end - start);
    return {along.y, -along.x};  // the tip is below: outside lies to the right of the way up
  }
  // Gradient of (r / A)^2 + ((z - centre) / C)^2, scaled by A C: no division where a semi-axis is small.
  const double angle = fraction <= 0.0 ? start_angle : fraction >= 1.0 ? end_angle : arc_angle(*this, fraction);
  return glm::normalize(Meridian(half_height * portable_sin(angle), -radius * portable_cos(angle)));
}

Result<std::vector<OutlinePiece>> make_outline(std::span<const Solid> solids) {
  if (solids.empty()) return bad_input("a tool needs at least one region");
  const std::vector<double> breaks = find_breaks(solids);
  std::vector<OutlinePiece> outline;
  double r_below = 0.0;
  std::size_t below = 0;
  double side_from = breaks.front();  // where the side now growing began
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const auto owner = find_owner(solids, breaks[i], breaks[i + 1]);
    const double r_here = owner ? solids[*owner].radius(breaks[i]) : 0.0;
    if (!owner || (i > 0 && std::min(r_here, r_below) < kOutlineTolerance))
      return bad_input(fmt::format("regions do not hold together at z = {:g} mm", breaks[i] * 1e3));
    const bool goes_on = i > 0 && *owner == below && std::abs(r_here - r_below) <= kOutlineTolerance;
    if (goes_on) {
      outline.pop_back();
    } else {
      add_ledge(outline, r_below, r_here, breaks[i], below, *owner);
      side_from = breaks[i];
    }
    outline.push_back(make_side(solids[*owner], *owner, side_from, breaks[i + 1]));
    below = *owner;
    r_below = solids[below].radius(breaks[i + 1]);
  }
  add_ledge(outline, r_below, 0.0, breaks.back(), below, below);
  join_ends(outline);
  return outline;
}

NearestPiece find_nearest(std::span<const OutlinePiece> outline, const Meridian& p) noexcept {
  NearestPiece best{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const double distance = distance_to_piece(outline[i], p);
    if (distance < best.distance) best = {distance, i};
  }
  return best;
}

double signed_distance(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept {
  const double distance = find_nearest(outline, {std::sqrt(p.x * p.x + p.y * p.y), p.z}).distance;
  const bool inside = std::any_of(solids.begin(), solids.end(), [&](const Solid& solid) { return solid.contains(p); });
  return inside ? -distance : distance;
}

}  // namespace burrhole
