#include "core/tool/point_shell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

// Even sampling; own derivation. The outline of the tool is traversed from the tip. Each smooth piece is divided into equal lengths, and
// each division gives a ring about the axis. Gaps along a ring and between rings are to be similar:
//   by pitch p        rows = ceil(length / p), ring = smallest even n >= 2 pi r / p. Both gaps are <= p, so every point of the surface is
//                     within about p / sqrt(2) of a shell point.
//   by stacks/slices  rows = stacks on a whole side; on a flat face rows = length / (2 pi R / slices), the gap along its rim (or
//                     length / voxel); ring = even number nearest to slices * r / R, R the largest radius of the region.
// Rings have even counts, at least 4, and alternate between offsets of 0 and half a step: symmetric in x and y, and staggered.
// Checks: a sphere with 8 stacks and 14 slices has rings of 6, 10, 12, 14, 12, 10, 6 and two poles: 72. A cylinder with 8 stacks and
// 26 slices has flat faces of 1 + 6 + 14 + 20 and 9 rings of 26: 316. These are the two counts of [AcostaLiu07] Fig. 3.
// Boxes have rows along their axes at most a pitch apart, ends included. A point covered by another region is omitted.

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMinRing = 4.0;

/// A ring of the shell: `count` points at (r, z) with one meridian normal.
struct Ring {
  Meridian at{0.0};
  Meridian outward{0.0};
  double count = 0.0;  ///< a whole number; a double so that an extreme pitch cannot overflow
  bool cutting = false;
};

double nearest_even(double x) noexcept { return 2.0 * std::floor(0.5 * x + 0.5); }
double even_above(double x) noexcept { return 2.0 * std::ceil(0.5 * x - 1e-9); }

double ring_count(const RegionSpec& region, double r) noexcept {
  const ShellSampling& shell = region.shell;
  const double count =
      shell.stacks > 0 ? nearest_even(shell.slices * (r / region.solid.largest_radius())) : even_above(2.0 * kPi * r / shell.pitch);
  return std::max(kMinRing, count);
}

/// Length of a whole side (or wall of a bore) of the region; a piece may be a part of it.
double side_length(const RegionSpec& region, Face face) {
  const Solid alone[] = {region.solid};
  const Result<std::vector<OutlinePiece>> outline = make_outline(alone);
  double length = 0.0;
  if (outline)
    for (const OutlinePiece& piece : outline.value())
      if (piece.face == face) length += piece.length();
  return length;
}

double row_count(const RegionSpec& region, const OutlinePiece& piece) {
  const ShellSampling& shell = region.shell;
  const double length = piece.length();
  if (shell.stacks == 0) return std::max(1.0, std::ceil(length / shell.pitch - 1e-9));
  if (piece.face == Face::side || piece.face == Face::inner)
    return std::max(1.0, std::round(shell.stacks * (length / side_length(region, piece.face))));
  if (shell.voxel > 0.0) return std::max(1.0, std::ceil(length / shell.voxel - 1e-9));
  return std::max(1.0, std::round(length / (2.0 * kPi * region.solid.largest_radius() / shell.slices)));
}

/// Ring where two pieces meet: bisecting normal, the larger count.
Ring make_edge_ring(const Ring& below, const Ring& above) {
  Ring edge = above;
  const Meridian sum = below.outward + above.outward;
  edge.outward = glm::length(sum) > 1e-6 ? glm::normalize(sum) : above.outward;  // opposite faces of a blade have no bisector
  edge.count = std::max(below.count, above.count);
  edge.cutting = below.cutting || above.cutting;
  return edge;
}

bool cuts(const RegionSpec& region, Face face) noexcept { return region.erosion.base > 0.0 && region.erosion.of_face(face) > 0.0; }

Ring make_ring(const RegionSpec& region, const OutlinePiece& piece, double fraction) {
  const Meridian at = piece.point(fraction);
  return {at, piece.outward(fraction), ring_count(region, at.x), cuts(region, piece.face)};
}

/// All rings of one chain in order. A chain from axis to axis has poles with count 1 and normals along the axis. A closed chain has no
/// poles; its first ring is the edge ring between its last and its first piece.
std::vector<Ring> make_rings(const ToolSpec& spec, OutlineChain chain) {
  std::vector<Ring> rings;
  for (const OutlinePiece& piece : chain) {
    const RegionSpec& region = spec.regions[piece.solid];
    const double rows = row_count(region, piece);
    const Ring first = make_ring(region, piece, 0.0);
    if (rings.empty())
      rings.push_back(first);
    else
      rings.back() = make_edge_ring(rings.back(), first);
    for (double i = 1.0; i <= rows && rings.size() <= kMaxShellPoints; i += 1.0) rings.push_back(make_ring(region, piece, i / rows));
  }
  const auto make_pole = [](Ring& ring, double direction) {
    ring.count = 1.0;
    ring.outward = {0.0, direction};
  };
  if (chain.front().start == chain.back().end) {
    rings.front() = make_edge_ring(rings.back(), rings.front());
    rings.pop_back();
  } else {
    make_pole(rings.front(), -1.0);
    make_pole(rings.back(), 1.0);
  }
  return rings;
}

void append_point(PointShell& shell, const Vec3& position, const Vec3& outward, bool cutting) {
  shell.positions.push_back(position);
  shell.inward_normals.push_back(-outward);
  shell.cutting.push_back(cutting ? 1 : 0);
}

/// The parts of a ring that no box covers. Other solids of revolution cover nothing here: the outline contains surface only.
void append_ring(PointShell& shell, const Ring& ring, bool shifted, std::span<const Solid> boxes) {
  const int count = static_cast<int>(ring.count);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * ((i + (shifted ? 0.5 : 0.0)) / count);
    const double x = count == 1 ? 0.0 : portable_cos(angle), y = count == 1 ? 0.0 : portable_sin(angle);
    const Vec3 position(ring.at.x * x, ring.at.x * y, ring.at.y), outward(ring.outward.x * x, ring.outward.x * y, ring.outward.y);
    if (!is_covered(boxes, boxes.size(), position, outward)) append_point(shell, position, outward, ring.cutting);
  }
}

/// Even rows along each axis; faces share the points of their edges, whose normals bisect those of the faces.
struct BoxRows {
  Vec3 lo{0.0}, hi{0.0};
  std::array<double, 3> gaps{};  ///< whole numbers; doubles so that an extreme pitch cannot overflow

  [[nodiscard]] double points() const noexcept {
    const auto [a, b, c] = gaps;
    return 2.0 * (a * b + b * c + c * a) + 2.0;
  }
};

BoxRows rows_of(const RegionSpec& region) noexcept {
  const Bounds box = region.solid.bounds();
  BoxRows rows{box.lo, box.hi, {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    rows.gaps[axis] = std::max(1.0, std::ceil((box.hi[axis] - box.lo[axis]) / region.shell.pitch - 1e-9));
  return rows;
}

void append_box(PointShell& shell, const ToolSpec& spec, std::size_t index, std::span<const Solid> solids) {
  const RegionSpec& region = spec.regions[index];
  const BoxRows rows = rows_of(region);
  const Vec3i last(rows.gaps[0], rows.gaps[1], rows.gaps[2]);
  for (int k = 0; k <= last.z; ++k)
    for (int j = 0; j <= last.y; ++j)
      for (int i = 0; i <= last.x; ++i) {
        const Vec3i at(i, j, k);
        Vec3 outward(0.0);
        bool cutting = false;
        for (const BoxFace& face : box_faces()) {
          if (at[face.axis] != (face.sign < 0.0 ? 0 : last[face.axis])) continue;
          outward[face.axis] += face.sign;
          cutting = cutting || cuts(region, face.face);
        }
        if (outward == Vec3(0.0)) continue;
        outward = glm::normalize(outward);
        const Vec3 position = rows.lo + (rows.hi - rows.lo) * (Vec3(at) / Vec3(last));
        if (!is_covered(solids, index, position, outward)) append_point(shell, position, outward, cutting);
      }
}

Error too_many(double total, bool more) {
  return {
      ErrorCode::out_of_range,
      fmt::format("the point shell would have {}{:.0f} points, at most {} are allowed: take a larger pitch_mm or fewer stacks and slices",
                  more ? "over " : "", total, kMaxShellPoints),
      {}};
}

}  // namespace

Result<PointShell> make_point_shell(const ToolSpec& spec) {
  const std::vector<Solid> solids = spec.solids();
  std::vector<Solid> boxes;
  std::vector<Ring> rings;
  double total = 0.0;
  bool more = false;
  for (const OutlineChain chain : chains_of(spec.outline)) {
    const std::vector<Ring> own = make_rings(spec, chain);
    more = more || own.size() > kMaxShellPoints;
    rings.insert(rings.end(), own.begin(), own.end());
  }
  for (const Ring& ring : rings) total += ring.count;
  for (const RegionSpec& region : spec.regions) {
    if (region.solid.revolves()) continue;
    boxes.push_back(region.solid);
    total += rows_of(region).points();
  }
  if (total > static_cast<double>(kMaxShellPoints)) return too_many(total, more);
  PointShell shell;
  bool shifted = false;
  for (const Ring& ring : rings) {
    append_ring(shell, ring, shifted, boxes);
    shifted = !shifted;
  }
  for (std::size_t i = 0; i < spec.regions.size(); ++i)
    if (!spec.regions[i].solid.revolves()) append_box(shell, spec, i, solids);
  return shell;
}

}  // namespace burrhole
