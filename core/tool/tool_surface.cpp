#include "core/tool/tool_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/tool/tool_spec.h"

namespace burrhole {
namespace {

// [-] covering radius of a shell over its pitch: gaps along rings and between them are at most a pitch (point_shell.cpp), so a place is
// within half the diagonal of a square; a little more, because rings beside each other may differ in their count.
constexpr double kCellRadius = 0.78;
constexpr double kOnSurface = 1e-8;    // [m] from a face: a point of the shell lies on it
constexpr int kEllipseRounds = 3;      // each gains about two digits
constexpr double kBeside = 1e-6;       // [m] from an edge
constexpr double kSmoothJoint = 0.98;  // [-] cosine of 11 degrees: two faces that meet at less count as one

double pitch_of(const RegionSpec& region) noexcept {
  const ShellSampling& shell = region.shell;
  if (shell.stacks == 0) return shell.pitch;
  const double along = 2.0 * std::numbers::pi * region.solid.largest_radius() / shell.slices;
  const double slope = region.solid.high_radius - region.solid.low_radius;
  const double side = region.solid.kind == SolidKind::ellipsoid
                          ? 0.5 * std::numbers::pi * std::max(region.solid.height(), 2.0 * region.solid.largest_radius())
                          : std::hypot(region.solid.height(), slope);
  return std::max({along, side / shell.stacks, shell.voxel});
}

/// The outline of a solid of revolution that is no ellipsoid: straight edges, with the material to their left.
struct Polygon {
  std::array<Meridian, 4> corner;
};

Polygon polygon_of(const Solid& s) noexcept {
  return {
      {Meridian(s.low_bore, s.z_low), Meridian(s.low_radius, s.z_low), Meridian(s.high_radius, s.z_high), Meridian(s.high_bore, s.z_high)}};
}

/// Place of the polygon nearest to a point outside. The edge along the axis of a solid without a bore is no surface, but a point outside is
/// never nearest to its inside.
Meridian nearest_on(const Polygon& polygon, const Meridian& p) noexcept {
  Meridian best = polygon.corner[0];
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < 4; ++n) {
    const Meridian &a = polygon.corner[n], along = polygon.corner[(n + 1) % 4] - a;
    const double length2 = glm::dot(along, along);
    const Meridian at = length2 > 0.0 ? a + along * std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : a;
    const Meridian off = p - at;
    if (const double distance2 = glm::dot(off, off); distance2 < least) {
      least = distance2;
      best = at;
    }
  }
  return best;
}

/// Place of the ellipse (x / a)^2 + (y / b)^2 = 1 nearest to a point outside in the first quadrant. Each round goes to where the circle of
/// curvature of the last place is nearest.
Meridian nearest_on_ellipse(double a, double b, const Meridian& p) noexcept {
  if (a == b) return p * (a / glm::length(p));
  Meridian t = glm::normalize(Meridian(p.x / a, p.y / b));
  for (int round = 0; round < kEllipseRounds; ++round) {
    const Meridian at(a * t.x, b * t.y);
    const Meridian centre((a * a - b * b) * t.x * t.x * t.x / a, (b * b - a * a) * t.y * t.y * t.y / b);
    const Meridian way = p - centre;
    const double radius = glm::length(at - centre), length = glm::length(way);
    if (length == 0.0) break;
    const Meridian next(std::clamp((way.x * radius / length + centre.x) / a, 0.0, 1.0),
                        std::clamp((way.y * radius / length + centre.y) / b, 0.0, 1.0));
    const double size = glm::length(next);
    if (size == 0.0) break;
    t = next / size;
  }
  return {a * t.x, b * t.y};
}

Vec3 nearest_of(const Solid& solid, const Vec3& p) noexcept {
  if (solid.kind == SolidKind::box) {
    const Bounds box = solid.bounds();
    return glm::clamp(p, box.lo, box.hi);
  }
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  Meridian at;
  if (solid.kind == SolidKind::ellipsoid) {
    const double centre = 0.5 * (solid.z_low + solid.z_high), z = p.z - centre;
    at = nearest_on_ellipse(solid.low_radius, 0.5 * solid.height(), {r, std::abs(z)});
    at.y = centre + (z < 0.0 ? -at.y : at.y);
  } else {
    at = nearest_on(polygon_of(solid), {r, p.z});
  }
  if (r == 0.0) return {at.x, 0.0, at.y};
  return {p.x * (at.x / r), p.y * (at.x / r), at.y};
}

/// Adds a face that contains the meridian point (r, z), of a solid of revolution.
void add_revolved(const Meridian& outward, const Meridian& into, const Vec3& p, double r, ToolFaces& out) noexcept {
  const double cosine = r > 0.0 ? p.x / r : 1.0, sine = r > 0.0 ? p.y / r : 0.0;
  if (out.count < 2) out.face[out.count] = {{outward.x * cosine, outward.x * sine, outward.y}, {into.x * cosine, into.x * sine, into.y}};
  ++out.count;
}

void add_faces(const Solid& solid, const Vec3& p, ToolFaces& out) noexcept {
  if (solid.kind == SolidKind::box) {
    const Bounds box = solid.bounds();
    ToolFaces found;
    for (const BoxFace& face : box_faces()) {
      const double off = p[face.axis] - (face.sign < 0.0 ? box.lo : box.hi)[face.axis];
      if (std::abs(off) > kOnSurface) continue;
      Vec3 outward(0.0);
      outward[face.axis] = face.sign;
      if (found.count < 2) found.face[found.count].outward = outward;
      ++found.count;
    }
    if (found.count == 2) {
      found.face[0].into = -found.face[1].outward;
      found.face[1].into = -found.face[0].outward;
    }
    for (std::size_t n = 0; n < std::min<std::size_t>(found.count, 2); ++n)
      if (out.count + n < 2) out.face[out.count + n] = found.face[n];
    out.count += found.count;
    return;
  }
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  if (solid.kind == SolidKind::ellipsoid) {
    const double half = 0.5 * solid.height(), z = p.z - solid.z_low - half;
    const double square = r * r / (solid.low_radius * solid.low_radius) + z * z / (half * half);
    if (std::abs(square - 1.0) * std::min(half, solid.low_radius) > 2.0 * kOnSurface) return;
    add_revolved(glm::normalize(Meridian(r * half / solid.low_radius, z * solid.low_radius / half)), {}, p, r, out);
    return;
  }
  const Polygon polygon = polygon_of(solid);
  const Meridian at(r, p.z);
  for (std::size_t n = 0; n < 4; ++n) {
    const Meridian &a = polygon.corner[n], &b = polygon.corner[(n + 1) % 4];
    const double length = glm::length(b - a);
    if (length < kOnSurface || (a.x == 0.0 && b.x == 0.0)) continue;
    const Meridian along = (b - a) / length;
    const double part = glm::dot(at - a, along), off = along.y * (at.x - a.x) - along.x * (at.y - a.y);
    if (std::abs(off) > kOnSurface || part < -kOnSurface || part > length + kOnSurface) continue;
    if (r < kOnSurface && std::abs(along.x) < 1.0 - kOnSurface) {
      out.count = 3;  // the apex of a cone
      return;
    }
    const bool first = part < kOnSurface && a.x > 0.0, last = part > length - kOnSurface && b.x > 0.0;
    add_revolved({along.y, -along.x}, first ? along : last ? -along : Meridian(0.0), p, r, out);
  }
}

/// Two faces at one point: an edge if it is convex, one face if the joint is nearly smooth, else none.
void join(ToolFaces& faces) noexcept {
  const Vec3 &a = faces.face[0].outward, &b = faces.face[1].outward;
  if (glm::dot(a, b) > kSmoothJoint) {
    faces.face[0] = {glm::normalize(a + b), Vec3(0.0)};
    faces.count = 1;
  } else if (!(glm::dot(faces.face[0].into, b) < 0.0 && glm::dot(faces.face[1].into, a) < 0.0)) {
    faces.count = 0;
  }
}

}  // namespace

ToolSurface::ToolSurface(const ToolSpec& spec) {
  for (const RegionSpec& region : spec.regions)
    parts_.push_back({region.name, region.solid, kCellRadius * pitch_of(region), region.erosion.base > 0.0});
}

bool ToolSurface::cuts_at(const Vec3& p) const noexcept {
  if (!nodes_.empty()) return p.z >= cut_from_ && p.z <= cut_to_;
  const auto owner = std::ranges::find_if(parts_, [&](const Part& part) { return part.solid.contains(p); });
  return owner != parts_.end() && owner->cuts;
}

std::optional<std::size_t> ToolSurface::find_region(std::string_view name) const noexcept {
  std::optional<std::size_t> found;
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (parts_[n].name != name) continue;
    if (found) return std::nullopt;
    found = n;
  }
  return found;
}

std::size_t ToolSurface::region_at(const Vec3& p) const noexcept {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    if (parts_[n].solid.contains(p)) return n;
    const Vec3 off = p - nearest_of(parts_[n].solid, p);
    if (const double distance2 = glm::dot(off, off); distance2 < least) {
      least = distance2;
      best = n;
    }
  }
  return best;
}

std::vector<double> ToolSurface::region_heights() const {
  std::vector<double> out;
  if (!nodes_.empty()) out = {cut_from_, cut_to_};
  for (const Part& part : parts_) out.insert(out.end(), {part.solid.z_low, part.solid.z_high});
  return out;
}

std::optional<Vec3> ToolSurface::nearest(const Vec3& p) const noexcept {
  if (!nodes_.empty()) return nearest_of_mesh(p);
  Vec3 best(0.0);
  double least = std::numeric_limits<double>::infinity();
  for (const Part& part : parts_) {
    const double beyond = std::max(part.solid.z_low - p.z, p.z - part.solid.z_high);
    if (beyond > 0.0 && beyond * beyond >= least) continue;
    if (part.solid.contains(p)) return std::nullopt;
    const Vec3 at = nearest_of(part.solid, p), off = p - at;
    if (const double distance2 = glm::dot(off, off); distance2 < least) {
      least = distance2;
      best = at;
    }
  }
  return least > 0.0 ? std::optional(best) : std::nullopt;
}

ToolFaces ToolSurface::faces_at(const Vec3& p) const noexcept {
  ToolFaces out;
  out.cell_radius = mesh_cell_radius_;
  for (std::size_t n = 0; n < parts_.size(); ++n) {
    ToolFaces own;
    add_faces(parts_[n].solid, p, own);
    if (own.count > 0) out.cell_radius = std::max(out.cell_radius, parts_[n].cell_radius);
    if (own.count > 2) {
      out.count = 0;
      return out;
    }
    for (std::size_t k = 0; k < own.count; ++k) {
      const ToolFace& face = own.face[k];
      // A face that ends here, and whose inside lies in another solid, is not part of the surface.
      const bool covered = face.into != Vec3(0.0) && std::ranges::any_of(parts_, [&](const Part& other) {
                             return &other != &parts_[n] && other.solid.contains(p + kBeside * face.into - kOnSurface * face.outward);
                           });
      if (covered) continue;
      if (out.count < 2) out.face[out.count] = face;
      ++out.count;
    }
  }
  if (out.count == 2) join(out);
  if (out.count > 2) out.count = 0;
  return out;
}

}  // namespace burrhole
