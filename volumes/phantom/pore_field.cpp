#include "volumes/phantom/pore_field.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace burrhole {
namespace {

/// Lattice edge over mean pore width: at porosity 0.4, random lines cross pores in chords of 1.49 lattice edges on average (measured, and
/// checked by a test).
constexpr double kEdgePerPore = 1.0 / 1.49;

/// Typical slope of the field across the wall of a pore, in 1/lattice edge. For lattice values uniform in [0, 1) (variance 1/12) and
/// weights f(t) = t^3 (10 - 15 t + 6 t^2), the derivative along one axis has the mean square 2/12 * mean(f'^2) * mean(f^2 + (1-f)^2)^2 =
/// 1/6 * 10/7 * (0.783)^2 = 0.146; three axes give sqrt(0.438).
constexpr double kTypicalSlope = 0.66;

/// Rotates the lattice relative to the grid: otherwise its planes are visible on level cuts. The entries are rational, so they are exact.
Vec3 turned(const Vec3& p) noexcept {
  return Vec3(2.0 * p.x - p.y + 2.0 * p.z, 2.0 * p.x + 2.0 * p.y - p.z, -p.x + 2.0 * p.y + 2.0 * p.z) / 3.0;
}

/// Weight of the upper lattice value. First and second derivatives vanish at both ends, so the field is smooth at lattice planes.
double fade(double t) noexcept { return t * t * t * (10.0 + t * (6.0 * t - 15.0)); }

/// One counter per lattice point; 21 bits per axis hold a million edges in either direction.
std::uint64_t counter_of(std::int64_t i, std::int64_t j, std::int64_t k) noexcept {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(i) & kMask) | ((static_cast<std::uint64_t>(j) & kMask) << 21) |
         ((static_cast<std::uint64_t>(k) & kMask) << 42);
}

double mix(double a, double b, double t) noexcept { return a + t * (b - a); }

}  // namespace

PoreField PoreField::calibrated(std::uint64_t seed, double pore_size, double porosity, std::span<const Vec3> samples) {
  PoreField field(seed, kEdgePerPore * pore_size);
  // The field lies in [0, 1): threshold 0 gives no pores, and threshold 2, far above the ramp, gives pores only.
  const auto rank = static_cast<std::ptrdiff_t>(porosity * static_cast<double>(samples.size()));
  if (rank <= 0) {
    field.threshold_ = porosity > 0.0 ? 0.0 : -2.0;
  } else if (rank >= std::ssize(samples)) {
    field.threshold_ = 2.0;
  } else {
    std::vector<double> values;
    values.reserve(samples.size());
    for (const Vec3& p : samples) values.push_back(field.value(p));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    field.threshold_ = values[static_cast<std::size_t>(rank)];
  }
  return field;
}

double PoreField::value(const Vec3& p_bone) const noexcept {
  const Vec3 q = turned(p_bone) / lattice_edge_;
  const Vec3 base(std::floor(q.x), std::floor(q.y), std::floor(q.z));
  const Vec3 f(fade(q.x - base.x), fade(q.y - base.y), fade(q.z - base.z));
  const auto i = static_cast<std::int64_t>(base.x), j = static_cast<std::int64_t>(base.y), k = static_cast<std::int64_t>(base.z);
  const auto row = [&](std::int64_t jj, std::int64_t kk) {
    return mix(uniform01(seed_, counter_of(i, jj, kk)), uniform01(seed_, counter_of(i + 1, jj, kk)), f.x);
  };
  return mix(mix(row(j, k), row(j + 1, k), f.y), mix(row(j, k + 1), row(j + 1, k + 1), f.y), f.z);
}

double PoreField::share(const Vec3& p_bone, double width) const noexcept {
  const double depth = (threshold_ - value(p_bone)) * lattice_edge_ / kTypicalSlope;  // [m] approximate distance from the wall
  return std::clamp(0.5 + depth / width, 0.0, 1.0);
}

}  // namespace burrhole
