#include "core/heat/heat_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace burrhole {
namespace {

constexpr int kParts = 4;  // along each axis of a cell
constexpr std::size_t kPoints = kParts * kParts * kParts;
constexpr std::array<Vec3i, 3> kAxes{Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1)};

/// The dose on a scale on which it is linear in the temperature: two doublings a degree below 43 C, one above.
/// A dose of a minute is taken as the border, that of a minute at 43 C.
double level_of(double minutes) noexcept {
  const double doublings = std::log2(minutes);
  return doublings < 0.0 ? 0.5 * doublings : doublings;
}
double minutes_of(double level) noexcept { return std::exp2(level < 0.0 ? 2.0 * level : level); }

bool holds(const HeatField& field, const Vec3i& cell) noexcept { return field.share(cell) >= HeatField::kLeastShare; }
/// Bone without a dose was put back cold or never warmed: its level has no limit below, so no slope leads to it.
bool has_level(const HeatField& field, const Vec3i& cell) noexcept { return holds(field, cell) && field.dose(cell) > 0.0f; }

/// @returns the slope of the level along an axis [1/cell], from the cells that have one.
double slope_of(const HeatField& field, const Vec3i& cell, const Vec3i& step) noexcept {
  const double here = level_of(static_cast<double>(field.dose(cell)));
  double rise = 0.0, way = 0.0;
  for (const int side : {-1, 1}) {
    const Vec3i other = cell + step * side;
    if (!has_level(field, other)) continue;
    rise += side * (level_of(static_cast<double>(field.dose(other))) - here);
    way += 1.0 - 0.5 * std::abs(field.filled(other) - field.filled(cell));  // between the middles of their bone
  }
  return way > 0.0 ? rise / way : 0.0;
}

/// @returns the part of a cell's bone with at least that level [-].
double part_above(const HeatField& field, const Vec3i& cell, double least) {
  struct Point {
    double order = 0.0;
    Vec3 at{0.0};
  };
  Vec3 slope(0.0), fuller(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    slope[static_cast<int>(axis)] = slope_of(field, cell, kAxes[axis]);
    fuller[static_cast<int>(axis)] = field.filled_beside(cell, cell + kAxes[axis]) - field.filled_beside(cell, cell - kAxes[axis]);
  }
  const double here = level_of(static_cast<double>(field.dose(cell)));
  constexpr double kWay = 1.0 - 1.0 / kParts;  // [cells] along an axis, the farthest from the middle of points to one of them
  if (here + kWay * (std::abs(slope.x) + std::abs(slope.y) + std::abs(slope.z)) < least) return 0.0;
  std::array<Point, kPoints> points;
  for (std::size_t n = 0; n < kPoints; ++n) {
    const auto place = [](std::size_t index) { return (static_cast<double>(index) + 0.5) / kParts - 0.5; };
    const Vec3 at(place(n % kParts), place(n / kParts % kParts), place(n / (kParts * kParts)));
    points[n] = {glm::dot(fuller, at), at};
  }
  const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(field.filled(cell) * kPoints)), 1, kPoints);
  std::ranges::stable_sort(points, std::greater<>{}, &Point::order);
  Vec3 middle(0.0);
  for (std::size_t n = 0; n < count; ++n) middle += points[n].at / static_cast<double>(count);
  std::size_t above = 0;
  for (std::size_t n = 0; n < count; ++n) above += here + glm::dot(slope, points[n].at - middle) >= least ? 1 : 0;
  return static_cast<double>(above) / static_cast<double>(count);
}

}  // namespace

double volume_with_dose(const HeatField& field, double minutes) {
  const double least = level_of(minutes);
  double sum = 0.0;
  for_each_voxel(field.domain(), [&](const Vec3i& cell) {
    if (!has_level(field, cell)) return;
    sum += static_cast<double>(field.share(cell)) * part_above(field, cell, least);
  });
  return sum * field.edges().x * field.edges().y * field.edges().z;
}

double hottest_mean(const HeatField& field, double volume) {
  std::vector<std::pair<float, float>> cells;  // peak, share
  for_each_voxel(field.domain(), [&](const Vec3i& cell) {
    if (holds(field, cell) && field.peak(cell) > 0.0f) cells.emplace_back(field.peak(cell), field.share(cell));
  });
  std::ranges::sort(cells, std::greater<>{});
  double rest = volume / (field.edges().x * field.edges().y * field.edges().z), sum = 0.0, taken = 0.0;
  for (const auto& [peak, share] : cells) {
    const double part = std::min(rest, static_cast<double>(share));
    sum += part * static_cast<double>(peak);
    taken += part;
    rest -= part;
    if (!(rest > 0.0)) break;
  }
  return taken > 0.0 ? sum / taken : 0.0;
}

double dose_at_face(const HeatField& field, const Vec3i& cell, const Vec3i& inwards) {
  const Vec3i next = cell + inwards;
  const double here = static_cast<double>(field.dose(cell));
  if (!(here > 0.0)) return 0.0;
  if (!has_level(field, next)) return here;
  // a + b x^2, its means over 0 to f and f to f + g: differ by b ((f + g)^3 - f^3) / (3 g) - b f^2 / 3 = b (2 f + g) (f + g) / 3.
  const double f = static_cast<double>(field.share(cell)), g = static_cast<double>(field.share(next));
  const double level = level_of(here), difference = level_of(static_cast<double>(field.dose(next))) - level;
  return minutes_of(level - difference * f * f / ((2.0 * f + g) * (f + g)));
}

}  // namespace burrhole
