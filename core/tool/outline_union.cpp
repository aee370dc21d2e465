#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/tool/outline.h"

// Own derivation. Each solid of revolution is a closed profile in the half-plane (r, z), traversed with the material on the left: bottom,
// outer side, top, and down the bore. Every profile is cut where it meets another one. A part is surface unless the point just outside it
// lies in another solid. The remaining parts are joined end to end. An edge is either level (z fixed) or has r^2(z) of degree two, so two
// edges meet at roots of a quadratic: no iteration, and no tolerance other than that of coinciding ends.

namespace burrhole {
namespace {

/// One edge of a profile. Level: from start.x to end.x at one height; otherwise r^2(z) between the heights of its ends.
struct Edge {
  std::size_t solid = 0;
  Face face = Face::side;
  bool level = false;
  Meridian start{0.0}, end{0.0};
  Solid::Quadratic form{};

  [[nodiscard]] double low() const noexcept { return std::min(start.y, end.y); }
  [[nodiscard]] double high() const noexcept { return std::max(start.y, end.y); }
  [[nodiscard]] double radius(double z) const noexcept { return std::sqrt(std::max(0.0, (form.a * z + form.b) * z + form.c)); }
  /// Position of a point along its edge, 0 at start, 1 at end.
  [[nodiscard]] double along(const Meridian& p) const noexcept {
    return level ? (p.x - start.x) / (end.x - start.x) : (p.y - start.y) / (end.y - start.y);
  }
  [[nodiscard]] bool holds(const Meridian& p) const noexcept {
    const double from = std::min(start.x, end.x), to = std::max(start.x, end.x);
    if (level) return std::abs(p.y - start.y) < kOutlineTolerance && p.x > from - kOutlineTolerance && p.x < to + kOutlineTolerance;
    return p.y > low() - kOutlineTolerance && p.y < high() + kOutlineTolerance &&
           std::abs(radius(std::clamp(p.y, low(), high())) - p.x) < kOutlineTolerance;
  }
};

std::vector<Edge> profile_of(const Solid& solid, std::size_t index) {
  std::vector<Edge> edges;
  const auto level = [&](Face face, double from, double to, double z) {
    if (std::abs(to - from) > kOutlineTolerance) edges.push_back({index, face, true, {from, z}, {to, z}, {}});
  };
  const bool round = solid.kind == SolidKind::ellipsoid;
  if (!round) level(Face::bottom, solid.low_bore, solid.low_radius, solid.z_low);
  edges.push_back({index,
                   Face::side,
                   false,
                   {round ? 0.0 : solid.low_radius, solid.z_low},
                   {round ? 0.0 : solid.high_radius, solid.z_high},
                   solid.squared_radius_form()});
  if (!round) level(Face::top, solid.high_radius, solid.high_bore, solid.z_high);
  if (solid.bored()) {
    const Solid hole =
        make_frustum({.z_low = solid.z_low, .height = solid.height(), .low_radius = solid.low_bore, .high_radius = solid.high_bore});
    edges.push_back(
        {index, Face::inner, false, {solid.high_bore, solid.z_high}, {solid.low_bore, solid.z_low}, hole.squared_radius_form()});
  }
  return edges;
}

/// Heights at which two edges that are not level have the same r^2.
std::vector<double> equal_radius(const Solid::Quadratic& p, const Solid::Quadratic& q) {
  const double a = p.a - q.a, b = p.b - q.b, c = p.c - q.c;
  if (a == 0.0) return b != 0.0 ? std::vector<double>{-c / b} : std::vector<double>{};
  const double d = b * b - 4.0 * a * c;
  if (d <= 0.0) return {};
  const double w = -0.5 * (b + (b < 0.0 ? -std::sqrt(d) : std::sqrt(d)));  // the root without cancellation, the other one is c / w
  return w != 0.0 ? std::vector<double>{w / a, c / w} : std::vector<double>{w / a};
}

/// Points of `edge` where it meets the inside of `other`; ends are handled separately.
std::vector<Meridian> crossings(const Edge& edge, const Edge& other) {
  std::vector<Meridian> points;
  const auto offer = [&](const Meridian& p) {
    if (edge.holds(p) && other.holds(p)) points.push_back(p);
  };
  if (!edge.level && !other.level) {
    for (const double z : equal_radius(edge.form, other.form)) offer({edge.radius(z), z});
  } else if (edge.level != other.level) {
    const Edge& line = edge.level ? edge : other;
    const Edge& curve = edge.level ? other : edge;
    if (line.start.y >= curve.low() && line.start.y <= curve.high()) offer({curve.radius(line.start.y), line.start.y});
  }
  return points;
}

/// The part of an edge between two cuts.
struct Part {
  const Edge* edge = nullptr;
  Meridian start{0.0}, end{0.0};
};

std::vector<Part> cut(const Edge& edge, std::span<const Edge> edges) {
  std::vector<Meridian> points{edge.start, edge.end};
  const auto add = [&](const Meridian& p) {
    const auto same = [&](const Meridian& q) { return glm::length(p - q) < kOutlineTolerance; };
    if (edge.holds(p) && std::none_of(points.begin(), points.end(), same)) points.push_back(p);
  };
  // Ends of other edges first: if they lie on this edge their own bits are used, so that neighbours share a point exactly.
  for (const Edge& other : edges) {
    if (other.solid == edge.solid) continue;
    add(other.start);
    add(other.end);
  }
  for (const Edge& other : edges)
    if (other.solid != edge.solid)
      for (const Meridian& p : crossings(edge, other)) add(p);
  std::sort(points.begin(), points.end(), [&](const Meridian& p, const Meridian& q) { return edge.along(p) < edge.along(q); });
  std::vector<Part> parts;
  for (std::size_t i = 1; i < points.size(); ++i) parts.push_back({&edge, points[i - 1], points[i]});
  return parts;
}

/// Points just outside and just inside the middle of a part.
struct Probes {
  Vec3 outside{0.0}, inside{0.0};
};

Probes probe(const Part& part) noexcept {
  const Edge& edge = *part.edge;
  Meridian middle = 0.5 * (part.start + part.end);
  Meridian along = part.end - part.start;
  if (!edge.level) {
    const double z = middle.y;
    middle.x = edge.radius(z);
    // r^2 = a z^2 + b z + c: r r' = a z + b / 2.
    const double rise = edge.form.a * z + 0.5 * edge.form.b;
    along = (edge.end.y > edge.start.y ? 1.0 : -1.0) * Meridian(rise, middle.x);
  }
  along = glm::normalize(along) * kOutlineTolerance;
  return {{middle.x + along.y, 0.0, middle.y - along.x}, {middle.x - along.y, 0.0, middle.y + along.x}};
}

/// Connected components of the solids: union-find by the lowest index.
class Bodies {
 public:
  explicit Bodies(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  [[nodiscard]] std::size_t find(std::size_t i) const noexcept {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }
  void join(std::size_t i, std::size_t j) noexcept { parent_[std::max(find(i), find(j))] = std::min(find(i), find(j)); }

 private:
  std::vector<std::size_t> parent_;
};

/// Surface points of a solid, dense enough to detect contact with another solid.
template <class F>
void for_each_surface_point(const Solid& solid, F&& f) {
  constexpr int kSteps = 32;
  const auto at = [](double lo, double hi, int i) { return lo + (hi - lo) * ((i + 0.5) / kSteps); };
  const Bounds box = solid.bounds();
  for (const BoxFace& face : box_faces())
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const std::size_t u = (face.axis + 1) % 3, v = (face.axis + 2) % 3;
        Vec3 p(0.0);
        p[face.axis] = (face.sign < 0.0 ? box.lo : box.hi)[face.axis] + face.sign * kOutlineTolerance;
        p[u] = at(box.lo[u], box.hi[u], i);
        p[v] = at(box.lo[v], box.hi[v], j);
        f(p);
      }
}

/// Boxes against boxes: their closed boxes share more than an edge.
bool boxes_touch(const Bounds& a, const Bounds& b) noexcept {
  int wide = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double shared = std::min(a.hi[axis], b.hi[axis]) - std::max(a.lo[axis], b.lo[axis]);
    if (shared < -kOutlineTolerance) return false;
    wide += shared > kOutlineTolerance ? 1 : 0;
  }
  return wide >= 2;
}

/// A box and a solid of revolution are connected if a point just outside the faces of the box lies in the other solid, or a point just
/// outside the other profile, rotated about the axis, lies in the box.
bool box_touches(const Solid& box, const Solid& round) {
  bool touch = false;
  for_each_surface_point(box, [&](const Vec3& p) { touch = touch || round.contains(p); });
  constexpr int kSteps = 32, kTurns = 32;
  for (const Edge& edge : profile_of(round, 0))
    for (int i = 0; i < kSteps && !touch; ++i) {
      const auto between = [&](int n) {
        Meridian p = edge.start + (edge.end - edge.start) * (static_cast<double>(n) / kSteps);
        if (!edge.level) p.x = edge.radius(p.y);
        return p;
      };
      const Vec3 p = probe({&edge, between(i), between(i + 1)}).outside;
      for (int turn = 0; turn < kTurns && !touch; ++turn) {
        const double angle = 2.0 * std::numbers::pi * turn / kTurns;
        touch = box.contains({p.x * std::cos(angle), p.x * std::sin(angle), p.z});
      }
    }
  return touch;
}

/// Makes neighbours share their point, and poles lie on the axis, to the last bit: a mesh made from the outline is then closed.
void join_ends(std::vector<OutlinePiece>& chain) {
  for (std::size_t i = 1; i < chain.size(); ++i) chain[i].start = chain[i - 1].end;
  if (glm::length(chain.front().start - chain.back().end) < kOutlineTolerance) {
    chain.front().start = chain.back().end;
    return;
  }
  if (chain.front().start.x < kOutlineTolerance) chain.front().start.x = 0.0;
  if (chain.back().end.x < kOutlineTolerance) chain.back().end.x = 0.0;
}

/// Parts that are surface; neighbours on one edge are merged.
std::vector<Part> surface_parts(std::span<const Solid> solids, std::span<const Edge> edges, Bodies& bodies) {
  std::vector<Part> kept;
  for (const Edge& edge : edges) {
    bool before = false;
    for (const Part& part : cut(edge, edges)) {
      const Probes at = probe(part);
      bool surface = true;
      for (std::size_t j = 0; j < solids.size(); ++j) {
        if (j == edge.solid || !solids[j].revolves()) continue;
        const bool outside = solids[j].contains(at.outside), inside = solids[j].contains(at.inside);
        if (outside || inside) bodies.join(edge.solid, j);
        // Inside j just under the part and outside j just above it: the two surfaces coincide, and the solid listed first owns the part.
        surface = surface && !outside && !(inside && j < edge.solid);
      }
      if (surface && before)
        kept.back().end = part.end;
      else if (surface)
        kept.push_back(part);
      before = surface;
    }
  }
  return kept;
}

OutlinePiece make_piece(const Part& part, std::span<const Solid> solids) {
  const Edge& edge = *part.edge;
  const Solid& solid = solids[edge.solid];
  if (solid.kind == SolidKind::ellipsoid) return make_arc_piece(edge.solid, solid, part.start, part.end);
  return make_line_piece(edge.solid, edge.face, part.start, part.end);
}

/// Joins parts end to end from `first` until the axis or the start is reached. Nothing if no part continues the chain.
std::vector<Part> take_chain(std::vector<Part>& parts, std::size_t first) {
  std::vector<Part> chain;
  std::size_t next = first;
  while (next < parts.size()) {
    chain.push_back(parts[next]);
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(next));
    const Meridian end = chain.back().end;
    if (end.x < kOutlineTolerance || glm::length(end - chain.front().start) < kOutlineTolerance) return chain;
    const auto begins_here = [&](const Part& part) { return glm::length(part.start - end) < kOutlineTolerance; };
    next = static_cast<std::size_t>(std::find_if(parts.begin(), parts.end(), begins_here) - parts.begin());
  }
  return {};
}

/// Start of the next chain: on the axis if possible, nearest to the tip.
std::size_t next_start(const std::vector<Part>& parts) {
  const auto rank = [](const Part& part) { return std::pair(part.start.x < kOutlineTolerance ? 0 : 1, part.start.y); };
  return static_cast<std::size_t>(
      std::min_element(parts.begin(), parts.end(), [&](const Part& a, const Part& b) { return rank(a) < rank(b); }) - parts.begin());
}

void join_boxes(std::span<const Solid> solids, Bodies& bodies) {
  for (std::size_t i = 0; i < solids.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (solids[i].revolves() && solids[j].revolves()) continue;
      const bool both = !solids[i].revolves() && !solids[j].revolves();
      const Solid& box = solids[i].revolves() ? solids[j] : solids[i];
      const Solid& other = solids[i].revolves() ? solids[i] : solids[j];
      if (both ? boxes_touch(box.bounds(), other.bounds()) : box_touches(box, other)) bodies.join(i, j);
    }
}

/// Height at which the body that contains the lowest solid ends, if there are other bodies.
std::optional<double> find_gap(std::span<const Solid> solids, const Bodies& bodies) {
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < solids.size(); ++i)
    if (solids[i].z_low < solids[lowest].z_low) lowest = i;
  double top = solids[lowest].z_high;
  bool whole = true;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const bool same = bodies.find(i) == bodies.find(lowest);
    whole = whole && same;
    if (same) top = std::max(top, solids[i].z_high);
  }
  return whole ? std::nullopt : std::optional(top);
}

}  // namespace

Result<std::vector<OutlinePiece>> make_outline(std::span<const Solid> solids) {
  if (solids.empty()) return bad_input("a tool needs at least one region");
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < solids.size(); ++i)
    if (solids[i].revolves())
      for (const Edge& edge : profile_of(solids[i], i)) edges.push_back(edge);
  Bodies bodies(solids.size());
  std::vector<Part> parts = surface_parts(solids, edges, bodies);
  join_boxes(solids, bodies);
  if (const auto gap = find_gap(solids, bodies)) return bad_input(fmt::format("regions do not hold together at z = {:g} mm", *gap * 1e3));
  std::vector<OutlinePiece> outline;
  while (!parts.empty()) {
    const double z = parts[next_start(parts)].start.y;
    const std::vector<Part> taken = take_chain(parts, next_start(parts));
    if (taken.empty()) return bad_input(fmt::format("regions meet in an edge only near z = {:g} mm", z * 1e3));
    std::vector<OutlinePiece> chain;
    for (const Part& part : taken) chain.push_back(make_piece(part, solids));
    join_ends(chain);
    outline.insert(outline.end(), chain.begin(), chain.end());
  }
  return outline;
}

}  // namespace burrhole
