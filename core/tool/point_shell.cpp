#include "core/tool/point_shell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/portable_math.h"

// Even sampling, own derivation. The outline of the tool is walked from the tip; each smooth piece of it is cut into equal lengths, and
// each cut turns into a ring about the axis. Gaps along a ring and between rings should be alike:
//   by pitch p        rows = ceil(length / p), ring = least even n >= 2 pi r / p. Both gaps are <= p, so no point of the surface is
//                     further than about p / sqrt(2) from a shell point.
//   by stacks/slices  rows = stacks on a whole side; on a flat face rows = length / (2 pi R / slices), the gap round its rim (or
//                     length / voxel); ring = even number nearest to slices * r / R, R the widest radius of the region.
// Rings have even counts, at least 4, and stand alternately at 0 and half a step: symmetric in x and y, and staggered like bricks.
// Checks: a sphere with 8 stacks and 14 slices has rings of 6, 10, 12, 14, 12, 10, 6 and two poles: 72. A cylinder with 8 stacks and
// 26 slices has flat faces of 1 + 6 + 14 + 20 and 9 rings of 26: 316. These are the two counts of [AcostaLiu07] Fig. 3.

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMinRing = 4.0;

/// A ring of the shell: count points at (r, z), all with one meridian normal.
struct Ring {
  Meridian at{0.0};
  Meridian outward{0.0};
  double count = 0.0;  ///< whole; a double so that absurd pitches cannot overflow
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

/// Length of a whole side of the region, of which a piece may be a part.
double side_length(const RegionSpec& region) {
  const Solid alone[] = {region.solid};
  const Result<std::vector<OutlinePiece>> outline = make_outline(alone);
  double length = 0.0;
  if (outline)
    for (const OutlinePiece& piece : outline.value())
      if (piece.face == Face::side) length += piece.length();
  return length;
}

double row_count(const RegionSpec& region, const OutlinePiece& piece) {
  const ShellSampling& shell = region.shell;
  const double length = piece.length();
  if (shell.stacks == 0) return std::max(1.0, std::ceil(length / shell.pitch - 1e-9));
  if (piece.face == Face::side) return std::max(1.0, std::round(shell.stacks * (length / side_length(region))));
  if (shell.voxel > 0.0) return std::max(1.0, std::ceil(length / shell.voxel - 1e-9));
  return std::max(1.0, std::round(length / (2.0 * kPi * region.solid.largest_radius() / shell.slices)));
}

/// Ring where two pieces meet: halfway normal, the denser count.
Ring make_edge_ring(const Ring& below, const Ring& above) {
  Ring edge = above;
  const Meridian sum = below.outward + above.outward;
  edge.outward = glm::length(sum) > 1e-6 ? glm::normalize(sum) : above.outward;  // opposite faces of a blade have no halfway
  edge.count = std::max(below.count, above.count);
  edge.cutting = below.cutting || above.cutting;
  return edge;
}

Ring make_ring(const RegionSpec& region, const OutlinePiece& piece, double fraction) {
  const Meridian at = piece.point(fraction);
  const bool cutting = region.erosion.base > 0.0 && region.erosion.of_face(piece.face) > 0.0;
  return {at, piece.outward(fraction), ring_count(region, at.x), cutting};
}

/// All rings from the tip's pole to the shaft's; poles have count 1 and look along the axis.
std::vector<Ring> make_rings(const ToolSpec& spec) {
  std::vector<Ring> rings;
  for (const OutlinePiece& piece : spec.outline) {
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
  make_pole(rings.front(), -1.0);
  make_pole(rings.back(), 1.0);
  return rings;
}

void append_ring(PointShell& shell, const Ring& ring, bool shifted) {
  const int count = static_cast<int>(ring.count);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * ((i + (shifted ? 0.5 : 0.0)) / count);
    const double x = count == 1 ? 0.0 : portable_cos(angle), y = count == 1 ? 0.0 : portable_sin(angle);
    shell.positions.emplace_back(ring.at.x * x, ring.at.x * y, ring.at.y);
    shell.inward_normals.emplace_back(-ring.outward.x * x, -ring.outward.x * y, -ring.outward.y);
    shell.cutting.push_back(ring.cutting ? 1 : 0);
  }
}

}  // namespace

Result<PointShell> make_point_shell(const ToolSpec& spec) {
  const std::vector<Ring> rings = make_rings(spec);
  double total = 0.0;
  for (const Ring& ring : rings) total += ring.count;
  if (total > static_cast<double>(kMaxShellPoints))
    return Error{
        ErrorCode::out_of_range,
        fmt::format("the point shell would have {}{:.0f} points, at most {} are allowed: take a larger pitch_mm or fewer stacks and slices",
                    rings.size() > kMaxShellPoints ? "over " : "", total, kMaxShellPoints),
        {}};
  PointShell shell;
  bool shifted = false;
  for (const Ring& ring : rings) {
    append_ring(shell, ring, shifted);
    shifted = !shifted;
  }
  return shell;
}

}  // namespace burrhole
