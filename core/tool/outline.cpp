#include "core/tool/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kArcSteps = 128;

/// Angle in [0, pi] with cosine c, by bisection on portable_cos: std::acos may differ between machines.
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

/// Angle on an arc at a fraction of its length, from the table of lengths.
double arc_angle(const OutlinePiece& piece, double fraction) noexcept {
  const double along = fraction * piece.arc_length.back();
  const auto above = std::upper_bound(piece.arc_length.begin() + 1, piece.arc_length.end() - 1, along);
  const auto step = static_cast<double>(above - piece.arc_length.begin() - 1);
  const double part = (along - *(above - 1)) / (*above - *(above - 1));
  return piece.start_angle + (piece.end_angle - piece.start_angle) * ((step + part) / static_cast<double>(kArcSteps));
}

Meridian nearest_on_segment(const Meridian& p, const Meridian& a, const Meridian& b) noexcept {
  const Meridian along = b - a;
  const double t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
  return a + t * along;
}

/// Point of a piece nearest to p, and its distance.
struct Foot {
  Meridian at{0.0};
  double distance = std::numeric_limits<double>::infinity();
  void offer(const Meridian& p, const Meridian& candidate) noexcept {
    const double d = glm::length(p - candidate);
    if (d < distance) *this = {candidate, d};
  }
};

Foot find_foot(const OutlinePiece& piece, const Meridian& p) noexcept {
  Foot foot;
  if (!piece.curved) {
    foot.offer(p, nearest_on_segment(p, piece.start, piece.end));
    return foot;
  }
  Meridian before = piece.start;
  for (std::size_t i = 1; i <= kArcSteps; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(kArcSteps);
    const Meridian here = i == kArcSteps ? piece.end : arc_point(piece, piece.start_angle + (piece.end_angle - piece.start_angle) * part);
    foot.offer(p, nearest_on_segment(p, before, here));
    before = here;
  }
  return foot;
}

/// Outward normal of a piece near one of its points: exact on a line, from the gradient of the ellipse on an arc.
Meridian outward_at(const OutlinePiece& piece, const Meridian& at) noexcept {
  if (!piece.curved) return piece.outward(0.0);
  const Meridian gradient(at.x * piece.half_height / piece.radius, (at.y - piece.centre) * piece.radius / piece.half_height);
  return glm::normalize(gradient);
}

/// Point of a face of a box nearest to p.
Vec3 box_foot(const Bounds& box, const BoxFace& face, const Vec3& p) noexcept {
  Vec3 foot = glm::clamp(p, box.lo, box.hi);
  foot[face.axis] = face.sign < 0.0 ? box.lo[face.axis] : box.hi[face.axis];
  return foot;
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
    return {along.y, -along.x};  // the tip is at the bottom, so the outside is to the right of the upward direction
  }
  // Gradient of (r / A)^2 + ((z - centre) / C)^2, scaled by A C: no division by a small semi-axis.
  const double angle = fraction <= 0.0 ? start_angle : fraction >= 1.0 ? end_angle : arc_angle(*this, fraction);
  return glm::normalize(Meridian(half_height * portable_sin(angle), -radius * portable_cos(angle)));
}

OutlinePiece make_line_piece(std::size_t solid, Face face, const Meridian& start, const Meridian& end) {
  OutlinePiece piece;
  piece.solid = solid;
  piece.face = face;
  piece.start = start;
  piece.end = end;
  return piece;
}

OutlinePiece make_arc_piece(std::size_t solid, const Solid& ellipsoid, const Meridian& start, const Meridian& end) {
  OutlinePiece piece = make_line_piece(solid, Face::side, start, end);
  piece.curved = true;
  piece.radius = ellipsoid.low_radius;
  piece.half_height = 0.5 * ellipsoid.height();
  piece.centre = 0.5 * (ellipsoid.z_low + ellipsoid.z_high);
  piece.start_angle = portable_acos((piece.centre - start.y) / piece.half_height);
  piece.end_angle = portable_acos((piece.centre - end.y) / piece.half_height);
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

std::vector<OutlineChain> chains_of(std::span<const OutlinePiece> outline) {
  std::vector<OutlineChain> chains;
  std::size_t first = 0;
  for (std::size_t i = 1; i <= outline.size(); ++i) {
    // join_ends makes joints equal to the last bit: a ring is closed if its end equals its start.
    const bool closed = outline[i - 1].end == outline[first].start;
    if (i < outline.size() && !closed && outline[i].start == outline[i - 1].end) continue;
    chains.push_back(outline.subspan(first, i - first));
    first = i;
  }
  return chains;
}

bool is_covered(std::span<const Solid> solids, std::size_t owner, const Vec3& p, const Vec3& outward) noexcept {
  const Vec3 outside = p + kOutlineTolerance * outward;
  for (std::size_t i = 0; i < solids.size(); ++i)
    if (i != owner && solids[i].contains(outside)) return true;
  return false;
}

NearestFace find_nearest_face(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept {
  NearestFace best{std::numeric_limits<double>::infinity(), 0, Face::side};
  const bool mixed = std::any_of(solids.begin(), solids.end(), [](const Solid& solid) { return !solid.revolves(); });
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  const glm::dvec2 away = r > 0.0 ? glm::dvec2(p) / r : glm::dvec2(1.0, 0.0);
  for (const OutlinePiece& piece : outline) {
    const Foot foot = find_foot(piece, {r, p.z});
    if (foot.distance >= best.distance) continue;
    const Meridian out = outward_at(piece, foot.at);
    if (mixed && is_covered(solids, piece.solid, Vec3(foot.at.x * away, foot.at.y), Vec3(out.x * away, out.y))) continue;
    best = {foot.distance, piece.solid, piece.face};
  }
  for (std::size_t i = 0; i < solids.size(); ++i) {
    if (solids[i].revolves()) continue;
    const Bounds box = solids[i].bounds();
    for (const BoxFace& face : box_faces()) {
      const Vec3 foot = box_foot(box, face, p);
      const double distance = glm::length(p - foot);
      Vec3 outward(0.0);
      outward[face.axis] = face.sign;
      if (distance < best.distance && !is_covered(solids, i, foot, outward)) best = {distance, i, face.face};
    }
  }
  return best;
}

double signed_distance(std::span<const Solid> solids, std::span<const OutlinePiece> outline, const Vec3& p) noexcept {
  const double distance = find_nearest_face(solids, outline, p).distance;
  const bool inside = std::any_of(solids.begin(), solids.end(), [&](const Solid& solid) { return solid.contains(p); });
  return inside ? -distance : distance;
}

}  // namespace burrhole
