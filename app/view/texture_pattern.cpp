#include "app/view/texture_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/assert.h"

namespace burrhole {
namespace {

constexpr double kPi = std::numbers::pi;

std::uint32_t hash_of(const Vec3i& cell, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(cell.x) * 0x9E3779B1u ^ static_cast<std::uint32_t>(cell.y) * 0x85EBCA77u ^
                    static_cast<std::uint32_t>(cell.z) * 0xC2B2AE3Du ^ seed * 0x27D4EB2Fu;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return h ^ (h >> 15);
}

double smooth(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

int wrapped(int n, int period) { return (n % period + period) % period; }
Vec3i wrapped(const Vec3i& cell, const Vec3i& period) {
  return {wrapped(cell.x, period.x), wrapped(cell.y, period.y), wrapped(cell.z, period.z)};
}

/// Value noise 0..1 that repeats. @param at 0..1 along each edge. @param cells along each edge.
double noise(const Vec3& at, const Vec3i& cells, std::uint32_t seed) {
  const Vec3 x = at * Vec3(cells);
  const Vec3 base = glm::floor(x);
  Vec3 f = x - base;
  f = f * f * (3.0 - 2.0 * f);
  double sum = 0.0;
  for (int c = 0; c < 8; ++c) {
    const Vec3i corner(c & 1, (c >> 1) & 1, c >> 2);
    const Vec3 w = glm::mix(1.0 - f, f, Vec3(corner));
    sum += w.x * w.y * w.z * (hash_of(wrapped(Vec3i(base) + corner, cells), seed) >> 8) / 16777216.0;
  }
  return sum;
}

/// Sum of four octaves, 0..1, mean about 0.5.
double cloud(const Vec3& at, const Vec3i& cells, std::uint32_t seed) {
  double sum = 0.0, weight = 0.5;
  for (int octave = 0; octave < 4; ++octave, weight *= 0.5) sum += weight * noise(at, cells << octave, seed + 7u * octave);
  return sum / 0.9375;
}

/// Distances [cells] to the two nearest of points that repeat, one in each cell; across z where there is one layer of cells.
struct Nearest {
  double first = 4.0, second = 4.0;
};
Nearest nearest_points(const Vec3& at, const Vec3i& cells, std::uint32_t seed) {
  const Vec3 x = at * Vec3(cells);
  const Vec3i base(glm::floor(x));
  Nearest out;
  for (int n = 0; n < 27; ++n) {
    const Vec3i cell = base + Vec3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    const std::uint32_t h = hash_of(wrapped(cell, cells), seed);
    const Vec3 point = Vec3(cell) + 0.1 + 0.8 * Vec3(h & 1023u, (h >> 10) & 1023u, (h >> 20) & 1023u) / 1023.0;
    const Vec3 off = point - x;
    const double d = glm::length(cells.z == 1 ? Vec3(off.x, off.y, 0.0) : off);
    out.second = std::min(out.second, std::max(d, out.first));
    out.first = std::min(out.first, d);
  }
  return out;
}

Rgba8 texel(const Vec3& color) {
  const auto code = [](double c) { return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(c, 0.0, 1.0))); };
  return {code(color.x), code(color.y), code(color.z), 255};
}

/// Periosteal surface: fine fibres along the axis, pale patches, and the small dark openings of vessels. 20 mm.
Vec3 bone_outside(double u, double v) {
  const Vec3 at(u, v, 0.0);
  const double fibres = cloud(at, {48, 8, 1}, 1), patches = cloud(at, {4, 4, 1}, 2);
  const double pit = 1.0 - smooth(0.03, 0.10, nearest_points(at, {6, 6, 1}, 3).first);
  Vec3 color = Vec3(0.90, 0.84, 0.72) * (0.88 + 0.14 * fibres) + Vec3(0.06, 0.05, 0.03) * (patches - 0.5);
  return glm::mix(color, Vec3(0.50, 0.36, 0.27), 0.60 * pit);
}

/// Diploe: walls round pores with red marrow. 12 mm.
Vec3 bone_inside(const Vec3& at) {
  const Vec3 bent = at + 0.012 * Vec3(noise(at, Vec3i(16), 4), noise(at, Vec3i(16), 5), noise(at, Vec3i(16), 6));
  const Nearest pore = nearest_points(bent, Vec3i(11), 7);
  const double wall = 1.0 - smooth(0.14, 0.38, pore.second - pore.first);
  const Vec3 bone = Vec3(0.93, 0.83, 0.68) * (0.92 + 0.12 * cloud(at, Vec3i(12), 8));
  const Vec3 marrow = Vec3(0.50, 0.15, 0.11) * (0.75 + 0.5 * cloud(at, Vec3i(10), 9));
  return glm::mix(marrow, bone, wall);
}

/// Red streaks along the axis over yellow, with pale lenticels. 60 mm.
Vec3 apple_outside(double u, double v) {
  const Vec3 at(u, v, 0.0);
  const double streaks = cloud(at, {28, 3, 1}, 11), blush = cloud(at, {2, 2, 1}, 12);
  const double red = smooth(0.30, 0.62, 0.6 * streaks + 0.5 * blush);
  Vec3 color = glm::mix(Vec3(0.84, 0.70, 0.30), Vec3(0.70, 0.09, 0.10), red);
  color *= 0.90 + 0.2 * cloud(at, {40, 12, 1}, 13);
  const double dot = 1.0 - smooth(0.05, 0.13, nearest_points(at, {17, 17, 1}, 14).first);
  return glm::mix(color, Vec3(0.92, 0.80, 0.58), 0.55 * dot);
}

/// How much of a seed is at a place. @param along [-] 0 in its middle .. 1 at its tip. @param across the same.
double seed_share(double along, double across) { return 1.0 - smooth(0.75, 1.05, along * along + across * across); }

/// Flesh round a core with five cells that hold seeds. The axis is z.
Vec3 apple_inside(const Vec3& at) {
  const Vec3 p = 2.0 * at - 1.0;
  const double radius = std::hypot(p.x, p.y), angle = std::atan2(p.y, p.x);
  const double away = std::hypot(radius, 0.8 * p.z);
  Vec3 color = Vec3(0.95, 0.91, 0.74) * (0.95 + 0.08 * cloud(at, Vec3i(20), 21));
  color = glm::mix(color, Vec3(0.88, 0.90, 0.60), 0.5 * smooth(0.82, 1.0, away));
  const double line = std::abs(away - (0.46 + 0.03 * std::cos(5.0 * angle)));  // the line round the core
  color = glm::mix(color, Vec3(0.72, 0.77, 0.42), 0.55 * (1.0 - smooth(0.006, 0.028, line)));
  const double fifth = 2.0 * kPi / 5.0, turned = angle - fifth * std::round(angle / fifth);
  const double x = radius * std::cos(turned), y = radius * std::sin(turned);
  const double cell = std::hypot((x - 0.15) / 0.115, std::hypot(y / 0.055, p.z / 0.24));
  color = glm::mix(color, Vec3(0.80, 0.70, 0.46), 1.0 - smooth(0.85, 1.08, cell));
  const double seed = seed_share((p.z + 0.02) / 0.13, std::hypot((x - 0.155) / 0.060, y / 0.042));
  color = glm::mix(color, Vec3(0.27, 0.13, 0.06), seed);
  return glm::mix(color, Vec3(0.66, 0.62, 0.36), 0.6 * (1.0 - smooth(0.02, 0.05, radius)) * (1.0 - 0.7 * smooth(0.2, 0.5, std::abs(p.z))));
}

/// Dark green with paler lines along the axis, and bumps. 40 mm.
Vec3 cucumber_outside(double u, double v) {
  const Vec3 at(u, v, 0.0);
  const double lines = smooth(0.45, 0.75, cloud(at, {10, 2, 1}, 31));
  Vec3 color = glm::mix(Vec3(0.08, 0.24, 0.07), Vec3(0.36, 0.52, 0.18), 0.75 * lines);
  color *= 0.85 + 0.3 * cloud(at, {24, 24, 1}, 32);
  const double bump = nearest_points(at, {7, 5, 1}, 33).first;
  color = glm::mix(color, Vec3(0.05, 0.15, 0.05), 0.6 * (1.0 - smooth(0.08, 0.18, bump)));
  return glm::mix(color, Vec3(0.62, 0.72, 0.42), 0.7 * (1.0 - smooth(0.02, 0.07, bump)));
}

/// A rim, pale flesh, and a wet middle in three parts with seeds in rows. The axis is z.
Vec3 cucumber_inside(const Vec3& at) {
  const Vec3 p = 2.0 * at - 1.0;
  const double radius = std::hypot(p.x, p.y), angle = std::atan2(p.y, p.x);
  Vec3 color = Vec3(0.80, 0.88, 0.60) * (0.94 + 0.10 * cloud(at, {24, 24, 12}, 41));
  color = glm::mix(color, Vec3(0.42, 0.62, 0.24), smooth(0.86, 0.98, radius));
  const double third = 2.0 * kPi / 3.0, turned = angle - third * std::round(angle / third);
  const double edge = 0.56 + 0.05 * std::cos(3.0 * angle);
  const double wet = 1.0 - smooth(edge - 0.05, edge + 0.02, radius);
  color = glm::mix(color, Vec3(0.62, 0.76, 0.42) * (0.92 + 0.16 * cloud(at, {12, 12, 6}, 42)), wet);
  const double gap = radius * std::abs(std::sin(0.5 * third - std::abs(turned)));  // to the wall between two parts
  color = glm::mix(color, Vec3(0.84, 0.90, 0.66), wet * 0.8 * (1.0 - smooth(0.015, 0.05, gap)));
  constexpr double kSeeds = 10.0;  // along the axis
  const double row = std::abs(turned) > 0.30 ? 0.5 : 0.0, along = kSeeds * at.z + row;
  const double side = radius * (std::abs(turned) - (row > 0.0 ? 0.62 : 0.0));
  const double seed = seed_share((along - std::round(along)) / 0.30, std::hypot((radius - 0.36) / 0.13, side / 0.055));
  return glm::mix(color, Vec3(0.93, 0.91, 0.72), 0.9 * seed);
}

struct Pattern {
  const char* name;
  PatternScale scale;
  Vec3 (*outside)(double u, double v);
  Vec3 (*inside)(const Vec3& at);
};
constexpr Pattern kPatterns[] = {{"bone", {0.020, 0.012}, bone_outside, bone_inside},
                                 {"apple", {0.060, std::nullopt}, apple_outside, apple_inside},
                                 {"cucumber", {0.040, std::nullopt}, cucumber_outside, cucumber_inside}};

const Pattern& find_pattern(const std::string& name) {
  const auto* const found = std::ranges::find_if(kPatterns, [&](const Pattern& p) { return name == p.name; });
  BH_ASSERT(found != std::end(kPatterns));
  return *found;
}

}  // namespace

const std::vector<std::string>& pattern_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Pattern& p : kPatterns) out.emplace_back(p.name);
    return out;
  }();
  return names;
}

bool is_pattern(const std::string& name) { return std::ranges::find(pattern_names(), name) != pattern_names().end(); }

PatternScale pattern_scale(const std::string& name) { return find_pattern(name).scale; }

Image make_exterior_pattern(const std::string& name) {
  const Pattern& pattern = find_pattern(name);
  Image out{kPatternImageSide, kPatternImageSide, {}};
  const auto place = [](int n) { return (n + 0.5) / kPatternImageSide; };
  for (int row = 0; row < out.height; ++row)
    for (int column = 0; column < out.width; ++column) out.pixels.push_back(texel(pattern.outside(place(column), place(row))));
  return out;
}

VolumeImage make_interior_pattern(const std::string& name) {
  const Pattern& pattern = find_pattern(name);
  VolumeImage out{Vec3i(kPatternVolumeSide), {}};
  const VoxelBox all{Vec3i(0), out.dims};
  out.pixels.reserve(all.count());
  for_each_voxel(all, [&](const Vec3i& v) { out.pixels.push_back(texel(pattern.inside((Vec3(v) + 0.5) / Vec3(out.dims)))); });
  return out;
}

}  // namespace burrhole
