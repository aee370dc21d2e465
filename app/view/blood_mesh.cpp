#include "app/view/blood_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "app/view/blood_film.h"
#include "app/view/tissue_texels.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr Vec3 kPoolColor(0.27, 0.008, 0.014), kBeadColor(0.50, 0.02, 0.03), kPaleColor(0.78, 0.42, 0.38);
constexpr Vec3 kThinColor(0.60, 0.05, 0.05), kThickColor(0.38, 0.01, 0.02), kWaxColor(0.90, 0.85, 0.72), kWaxEdge(0.84, 0.77, 0.64);
constexpr std::uint8_t kWet = 255, kDull = 40;   // shine
constexpr float kLeastPores = 0.3f;              // [-] share below which a bead is too small to see
constexpr double kRise = 0.3e-3, kDip = 0.2e-3;  // [m] of the surface where a wall stands beside it; below the level at a brim
constexpr double kMeniscus = 1e-3;               // [m] length over which both decay
constexpr int kHalvings = 10;                    // of a line of a diagonal of the lattice: 0.3 um
constexpr int kSweeps = 60;                      // of the surface's shape, which is smooth long before
constexpr double kInto = 1.5;                    // [pitches] to the last place of the lattice beyond the liquid, which is moved to the wall
constexpr double kWallLevel = 0.6;               // [-] density at the edge of the surface, a little in the bone
constexpr double kWave = 3e-5, kWaves = 1.1e3;   // [m], [1/m] of ripples on the surface, which make it shine
constexpr double kFar = 1e9;                     // [m]
constexpr double kDropHeight = 0.45;             // [-] of its radius
constexpr double kRim = -0.5;                    // [-] of its height, of the rim of a drop: in the bone
constexpr int kSides = 8;                        // of a drop
constexpr unsigned kDropOf = 37, kRunOf = 61;    // [voxels with pores] of which one carries a drop, and one starts a run
constexpr int kMostRun = 90, kAcross = 5;        // places along a run, points across it
constexpr double kDryLeast = 1.5, kWetLeast = 0.12;  // [-] of blood at the edge of a film, where there is hardly any, and at most

Rgba8 rgba(const Vec3& color, std::uint8_t shine) { return {to_byte(color.x), to_byte(color.y), to_byte(color.z), shine}; }

unsigned scatter(const Vec3i& voxel) {
  auto h = static_cast<std::uint32_t>(voxel.x) * 73856093u ^ static_cast<std::uint32_t>(voxel.y) * 19349663u ^
           static_cast<std::uint32_t>(voxel.z) * 83492791u;
  h ^= h >> 13;
  h *= 0x5bd1e995u;
  return h ^ (h >> 15);
}

/// A point of the surface and its normal, out of the bone.
struct Place {
  Vec3 at{0.0}, normal{0.0};
};

/// A lattice on the surface of the pool, with what is known at each of its places.
struct PoolLattice {
  Vec3 u{0.0}, v{0.0}, up{0.0};
  glm::dvec2 lo{0.0};  // [m] along u and v
  double level = 0.0, pitch = 0.0;
  int columns = 0, rows = 0;
  std::vector<double> in{}, out{}, depth{};  // [pitches] to the wall, and beyond it or to where blood hides nothing; [m] of the liquid
  [[nodiscard]] std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] Vec3 place(int i, int j) const { return u * (lo.x + pitch * i) + v * (lo.y + pitch * j) + up * level; }
};

class BloodShape {
 public:
  BloodShape(const SiteBone& bone, const BloodPicture& picture, AddedMesh& out)
      : bone_(bone),
        picture_(picture),
        out_(out),
        index_from_bone_(bone.bone_from_index.inverse()),
        edge_(bone.bone_from_index.mean_edge()) {
    density_.resize(bone.whole.size());
    gone_.resize(bone.whole.size());
    for (std::size_t n = 0; n < density_.size(); ++n) {
      gone_[n] = static_cast<float>(picture.removed[n]) / static_cast<float>(BloodSite::kWhole);
      density_[n] = std::max(0.0f, bone.whole[n] - gone_[n]);
    }
  }

  /// Blood or wax on the pores as layers.
  void append_films() {
    if (std::ranges::find(picture_.waxed, 1) != picture_.waxed.end()) append_wax();
    if (picture_.wetness > 0.0) append_bleeding();
  }
  void append_beads() {
    if (picture_.wetness <= 0.0) return;
    for_each_voxel(bone_.box, [&](const Vec3i& voxel) {
      const std::size_t at = bone_.box.offset_of(voxel);
      if (!(picture_.pore_area[at] > 0.0f) || bone_.pores[at] < kLeastPores || picture_.waxed[at] != 0) return;
      const unsigned dice = scatter(voxel);
      const bool drips = dice % kDropOf == 0, runs = picture_.wetness >= kRunWetness && dice / 1024 % kRunOf == 0;
      if (!drips && !runs) return;
      const auto place = surface_near(bone_.bone_from_index * Vec3(voxel));
      if (!place || voxel_of(index_from_bone_ * place->at) != voxel) return;
      const double size = edge_ * (0.55 + 0.65 * static_cast<double>(bone_.pores[at]));
      if (height(place->at) < picture_.level && picture_.blood > 0.0) return;  // under the pool
      const double swollen = size * (0.55 + 0.6 * std::sqrt(picture_.wetness));
      if (drips) append_drop(*place, swollen * (0.7 + 0.6 * (dice / 64 % 16) / 16.0), kDropHeight, rgba(kBeadColor * 0.85, kWet));
      if (runs) append_run(*place, edge_ * (0.9 + 0.9 * (dice / 64 % 16) / 16.0), dice);
    });
  }
  void append_pool();

 private:
  /// @returns the pores [-] of the voxels at the surface that wax closes, or of the others; 0: of other voxels.
  [[nodiscard]] std::vector<float> pores_of(bool waxed) const {
    std::vector<float> out(picture_.pore_area.size(), 0.0f);
    for (std::size_t n = 0; n < out.size(); ++n)
      if (picture_.pore_area[n] > 0.0f && bone_.pores[n] >= kLeastPores && (picture_.waxed[n] != 0) == waxed) out[n] = bone_.pores[n];
    return out;
  }
  void append_wax() {
    append_film(
        bone_, density_, pores_of(true),
        {.least = 0.22, .ragged = 0.1, .lift = 0.5, .uneven = 4e-5, .thin_color = kWaxEdge, .thick_color = kWaxColor, .shine = kDull},
        out_);
  }
  void append_bleeding() {
    append_film(bone_, density_, pores_of(false),
                {.least = glm::mix(kDryLeast, kWetLeast, std::sqrt(picture_.wetness)),
                 .ragged = 0.12,
                 .lift = 0.3,
                 .uneven = 2e-5,
                 .dry_below = picture_.blood > 0.0 ? std::optional(picture_.level) : std::nullopt,
                 .thin_color = kThinColor,
                 .thick_color = kThickColor,
                 .shine = kWet},
                out_);
  }
  [[nodiscard]] double height(const Vec3& p) const { return -glm::dot(bone_.down, p); }
  [[nodiscard]] double density(const Vec3& p) const { return trilinear(bone_.box, density_.data(), index_from_bone_ * p); }
  [[nodiscard]] bool inside(const Vec3& p) const {
    const Vec3 index = index_from_bone_ * p;
    const Vec3 lo(bone_.box.lo + 1), hi(bone_.box.hi - 3);
    return glm::all(glm::greaterThanEqual(index, lo)) && glm::all(glm::lessThanEqual(index, hi));
  }
  [[nodiscard]] std::optional<Place> surface_near(Vec3 p) const {
    Vec3 normal(0.0);
    for (int n = 0; n < 3; ++n) {
      if (!inside(p)) return std::nullopt;
      Vec3 slope;
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 step(0.0);
        step[axis] = 0.75 * edge_;
        slope[axis] = (density(p + step) - density(p - step)) / (1.5 * edge_);
      }
      const double steepness = glm::length(slope);
      if (steepness * edge_ < 0.02) return std::nullopt;
      normal = -slope / steepness;
      p += normal * std::clamp((density(p) - 0.5) / steepness, -edge_, edge_);
    }
    return Place{p, normal};
  }
  void add(const Vec3& p, const Rgba8& color) {
    out_.vertices.emplace_back(p);
    out_.colors.push_back(color);
  }
  /// A cap on the surface; its rim is in the bone.
  void append_drop(const Place& place, double radius, double flat, const Rgba8& color) {
    const auto first = static_cast<std::uint32_t>(out_.vertices.size());
    const Vec3 aside = glm::normalize(std::abs(place.normal.z) < 0.7 ? glm::cross(place.normal, Vec3(0.0, 0.0, 1.0))
                                                                     : glm::cross(place.normal, Vec3(1.0, 0.0, 0.0)));
    const Vec3 across = glm::cross(place.normal, aside);
    add(place.at + place.normal * (flat * radius), color);
    for (const auto& [wide, high] : {std::pair{0.65, 0.72}, std::pair{1.0, kRim}})
      for (int n = 0; n < kSides; ++n) {
        const double turn = 2.0 * std::numbers::pi * n / kSides;
        add(place.at + radius * (wide * (std::cos(turn) * aside + std::sin(turn) * across) + high * flat * place.normal), color);
      }
    for (std::uint32_t n = 0; n < kSides; ++n) {
      const std::uint32_t next = (n + 1) % kSides, a = first + 1 + n, b = first + 1 + next;
      out_.triangles.push_back({first, a, b});
      out_.triangles.push_back({a, a + kSides, b + kSides});
      out_.triangles.push_back({a, b + kSides, b});
    }
  }
  /// Blood runs down along the surface: a band that wanders, narrows, and ends in a drop.
  void append_run(Place place, double width, unsigned dice) {
    const double step = 0.5 * edge_;
    std::vector<Place> way;
    std::vector<Vec3> aside;
    for (int n = 0; n < kMostRun; ++n) {
      const Vec3 along = bone_.down - glm::dot(bone_.down, place.normal) * place.normal;
      if (glm::length(along) < 0.25) break;
      const Vec3 side = glm::normalize(glm::cross(place.normal, along));
      way.push_back(place);
      aside.push_back(side);
      const auto next = surface_near(place.at + step * (glm::normalize(along) + 0.35 * std::sin(0.37 * n + dice % 64) * side));
      if (!next || (picture_.blood > 0.0 && height(next->at) < picture_.level)) break;
      place = *next;
    }
    if (way.size() < 3) return;
    const auto first = static_cast<std::uint32_t>(out_.vertices.size());
    const auto last = static_cast<double>(way.size() - 1);
    for (std::size_t n = 0; n < way.size(); ++n) {
      const double left = (last - static_cast<double>(n)) * step / width;  // [widths] to the end
      const double drop = left < 2.0 ? std::sqrt(std::max(0.0, 1.0 - (left - 1.0) * (left - 1.0))) : 0.0;
      const double half = 0.5 * width * std::max({0.05, drop, left < 1.0 ? 0.0 : 0.7 - 0.25 * static_cast<double>(n) / last});
      for (const auto& [wide, high] :
           {std::pair{-1.0, -0.2}, std::pair{-0.6, 0.35}, std::pair{0.0, 0.5}, std::pair{0.6, 0.35}, std::pair{1.0, -0.2}})
        add(way[n].at + half * (wide * aside[n] + high * way[n].normal), rgba(kBeadColor * 0.9, kWet));
    }
    for (std::uint32_t n = 0; n + 1 < way.size(); ++n)
      for (std::uint32_t k = 0; k + 1 < kAcross; ++k) {
        const std::uint32_t a = first + n * kAcross + k, b = a + kAcross;
        out_.triangles.push_back({a, a + 1, b + 1});
        out_.triangles.push_back({a, b + 1, b});
      }
  }

  void sound(PoolLattice& pool) const;
  [[nodiscard]] Vec3 at_wall(const PoolLattice& pool, int i, int j) const;
  [[nodiscard]] std::vector<double> shape_of(const PoolLattice& pool, const std::vector<Vec3>& place) const;
  void append_sheet(const PoolLattice& pool, const Rgba8& color, bool ground);

  const SiteBone& bone_;
  const BloodPicture& picture_;
  AddedMesh& out_;
  Affine index_from_bone_;
  double edge_;
  std::vector<float> density_, gone_;
};

/// Distance [pitches] of each place of a lattice to the nearest that is not free, in two sweeps.
void measure_distance(std::vector<double>& distance, int columns, int rows) {
  const auto at = [&](int i, int j) -> double& {
    return distance[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i)];
  };
  const auto lower = [&](int i, int j, int di, int dj) {
    if (i + di < 0 || j + dj < 0 || i + di >= columns || j + dj >= rows) return;
    at(i, j) = std::min(at(i, j), at(i + di, j + dj) + std::hypot(di, dj));
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      for (const auto& [di, dj] : {std::pair{-1, 0}, std::pair{0, -1}, std::pair{-1, -1}, std::pair{1, -1}}) lower(i, j, di, dj);
  for (int j = rows - 1; j >= 0; --j)
    for (int i = columns - 1; i >= 0; --i)
      for (const auto& [di, dj] : {std::pair{1, 0}, std::pair{0, 1}, std::pair{1, 1}, std::pair{-1, 1}}) lower(i, j, di, dj);
}

void BloodShape::append_pool() {
  if (!(picture_.blood > 0.0)) return;
  PoolLattice pool{.up = -bone_.down, .level = picture_.level, .pitch = 0.75 * edge_};
  pool.u = glm::normalize(std::abs(pool.up.z) < 0.7 ? glm::cross(pool.up, Vec3(0.0, 0.0, 1.0)) : glm::cross(Vec3(0.0, 1.0, 0.0), pool.up));
  pool.v = glm::cross(pool.up, pool.u);
  pool.lo = glm::dvec2(kFar);
  glm::dvec2 hi(-kFar);
  for_each_voxel(bone_.box, [&](const Vec3i& voxel) {
    const Vec3 p = bone_.bone_from_index * Vec3(voxel);
    if (picture_.removed[bone_.box.offset_of(voxel)] == 0 || std::abs(height(p) - picture_.level) > edge_) return;
    const glm::dvec2 across(glm::dot(p, pool.u), glm::dot(p, pool.v));
    pool.lo = glm::min(pool.lo, across);
    hi = glm::max(hi, across);
  });
  if (pool.lo.x > hi.x) return;
  pool.lo -= 3.0 * pool.pitch;
  pool.columns = static_cast<int>((hi.x - pool.lo.x) / pool.pitch) + 5;
  pool.rows = static_cast<int>((hi.y - pool.lo.y) / pool.pitch) + 5;
  sound(pool);
  const Rgba8 color = rgba(glm::mix(kPaleColor, kPoolColor, std::sqrt(picture_.blood)), kWet);
  // The surface, and the ground of the liquid, which a section through it shows.
  append_sheet(pool, color, false);
  append_sheet(pool, color, true);
}

/// Finds where the liquid is, and how deep.
void BloodShape::sound(PoolLattice& pool) const {
  const auto wet = [&](const Vec3& p) {
    return inside(p) && density(p) < 0.5 && trilinear(bone_.box, gone_.data(), index_from_bone_ * p) > 0.4;
  };
  const std::size_t count = static_cast<std::size_t>(pool.columns) * static_cast<std::size_t>(pool.rows);
  const auto everywhere = static_cast<double>(pool.columns + pool.rows);
  pool.in.assign(count, 0.0);
  pool.out.assign(count, everywhere);
  pool.depth.assign(count, 0.0);
  const double step = 0.5 * edge_;
  for (int j = 0; j < pool.rows; ++j)
    for (int i = 0; i < pool.columns; ++i) {
      const std::size_t at = pool.at(i, j);
      const Vec3 p = pool.place(i, j) - pool.up * edge_;
      if (!wet(p)) continue;
      pool.in[at] = everywhere;
      pool.depth[at] = edge_;
      while (wet(p - pool.up * (pool.depth[at] - edge_))) pool.depth[at] += step;
      if (pool.depth[at] * picture_.blood >= picture_.hide) pool.out[at] = 0.0;
    }
  measure_distance(pool.in, pool.columns, pool.rows);
  measure_distance(pool.out, pool.columns, pool.rows);
}

/// @returns the least depth [m] beside a place, so that the ground lies over every step of the bone.
double shallowest(const PoolLattice& pool, int i, int j) {
  double out = pool.depth[pool.at(i, j)];
  for (const int dj : {-1, 0, 1})
    for (const int di : {-1, 0, 1})
      if (i + di >= 0 && j + dj >= 0 && i + di < pool.columns && j + dj < pool.rows)
        out = std::min(out, pool.depth[pool.at(i + di, j + dj)]);
  return out;
}

/// @returns where the line from a place in the bone to the nearest one in the liquid meets the wall, within the plane of the pool.
Vec3 BloodShape::at_wall(const PoolLattice& pool, int i, int j) const {
  Vec3 dry = pool.place(i, j), wet = dry;
  double nearest = kFar;
  for (const int dj : {-1, 0, 1})
    for (const int di : {-1, 0, 1}) {
      if (i + di < 0 || j + dj < 0 || i + di >= pool.columns || j + dj >= pool.rows) continue;
      if (pool.in[pool.at(i + di, j + dj)] <= 0.0 || std::hypot(di, dj) >= nearest) continue;
      nearest = std::hypot(di, dj);
      wet = pool.place(i + di, j + dj);
    }
  const Vec3 below = -pool.up * edge_;
  for (int n = 0; n < kHalvings; ++n) {
    const Vec3 middle = 0.5 * (dry + wet);
    (density(middle + below) < kWallLevel ? wet : dry) = middle;
  }
  return wet;
}

/// @returns the rise [m] of the surface at each place: given where it meets a wall or a brim, between them the shape of a liquid with surface
/// tension, of which h = kMeniscus^2 x the Laplacian of h, by Gauss and Seidel.
std::vector<double> BloodShape::shape_of(const PoolLattice& pool, const std::vector<Vec3>& place) const {
  std::vector<double> rise(pool.in.size(), 0.0);
  for (std::size_t at = 0; at < rise.size(); ++at) {
    if (pool.in[at] > 0.0 || pool.out[at] > kInto) continue;
    const double wall = density(place[at] + 0.75 * edge_ * pool.up);
    rise[at] = glm::mix(-kDip, kRise, std::clamp(2.0 * wall, 0.0, 1.0));
  }
  const double stiff = std::pow(kMeniscus / pool.pitch, 2);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int j = 1; j + 1 < pool.rows; ++j)
      for (int i = 1; i + 1 < pool.columns; ++i) {
        const std::size_t at = pool.at(i, j);
        if (pool.in[at] <= 0.0) continue;
        const double sum = rise[pool.at(i - 1, j)] + rise[pool.at(i + 1, j)] + rise[pool.at(i, j - 1)] + rise[pool.at(i, j + 1)];
        rise[at] = stiff * sum / (1.0 + 4.0 * stiff);
      }
  return rise;
}

void BloodShape::append_sheet(const PoolLattice& pool, const Rgba8& color, bool ground) {
  std::vector<std::uint32_t> vertex(pool.in.size(), 0);
  std::vector<Vec3> place(pool.in.size(), Vec3(0.0));
  for (int j = 0; j < pool.rows; ++j)
    for (int i = 0; i < pool.columns; ++i) {
      const std::size_t at = pool.at(i, j);
      if (pool.out[at] <= kInto) place[at] = pool.in[at] > 0.0 ? pool.place(i, j) : at_wall(pool, i, j);
    }
  const std::vector<double> shape = ground ? std::vector<double>{} : shape_of(pool, place);
  for (int j = 0; j < pool.rows; ++j)
    for (int i = 0; i < pool.columns; ++i) {
      const std::size_t at = pool.at(i, j);
      if (pool.out[at] > kInto) continue;
      Vec3 p = place[at];
      if (ground) {
        p -= pool.up * std::max(1.1 * kDip, shallowest(pool, i, j) - 0.5 * edge_);  // below the surface at a brim too
      } else {
        const double x = kWaves * glm::dot(p, pool.u), y = kWaves * glm::dot(p, pool.v);
        const double wave = kWave * (std::sin(x + 0.6 * y + std::sin(0.8 * y)) + std::sin(1.3 * y - 0.7 * x + std::sin(0.9 * x)));
        p += pool.up * (shape[at] + (pool.in[at] > 1.5 ? wave : 0.0));
      }
      add(p, color);
      vertex[at] = static_cast<std::uint32_t>(out_.vertices.size());
    }
  for (int j = 0; j + 1 < pool.rows; ++j)
    for (int i = 0; i + 1 < pool.columns; ++i) {
      std::array<std::uint32_t, 4> c{vertex[pool.at(i, j)], vertex[pool.at(i + 1, j)], vertex[pool.at(i + 1, j + 1)],
                                     vertex[pool.at(i, j + 1)]};
      if (std::ranges::find(c, 0u) != c.end()) continue;
      if (ground) std::swap(c[1], c[3]);
      out_.triangles.push_back({c[0] - 1, c[1] - 1, c[2] - 1});
      out_.triangles.push_back({c[0] - 1, c[2] - 1, c[3] - 1});
    }
}

}  // namespace

void append_blood(const SiteBone& bone, const BloodPicture& picture, AddedMesh& out) {
  BloodShape shape(bone, picture, out);
  shape.append_films();
  shape.append_beads();
  shape.append_pool();
}

}  // namespace burrhole
