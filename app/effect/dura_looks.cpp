#include "app/effect/dura_looks.h"

#include <algorithm>
#include <cmath>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr double kDarkFrom = 4e-3, kLeastLight = 0.35;  // [m], [-] depth at which a pit is dark, and by how much (an assumption)
constexpr double kGyrus = 7e-3, kSulcus = 0.3e-3;       // [m] width of a gyrus; depth of the groove beside it that is seen (assumptions)
constexpr double kShade = 0.45;                         // [-] of light on the brain under the edge of a rent
constexpr std::uint8_t kDuraShine = 200;

std::uint32_t mixed(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ z * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  return h ^ (h >> 13);
}

Rgba8 rgba(const Vec3& color, std::uint8_t shine) {
  const auto byte = [](double share) { return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0))); };
  return {byte(color.x), byte(color.y), byte(color.z), shine};
}

/// Distance [-] to wavy lines at unit spacing across `way`.
double off_line(const Vec3& x, const Vec3& way) {
  const double along = glm::dot(x, way) + 0.5 * tissue_noise(x) + 0.12 * tissue_noise(2.3 * x);
  return std::abs(along - std::floor(along) - 0.5);
}

/// As shaders/tissue.glsl, which colours the dura of voxels.
double vessel(const Vec3& x, const Vec3& way, double width) {
  return (1.0 - smooth_step(0.4 * width, width, off_line(x, way))) * smooth_step(0.35, 0.6, tissue_noise(0.43 * x + 17.0));
}

/// Distance [-] from the middle of a sulcus, in widths of a gyrus.
double off_sulcus(const Vec3& p) { return std::abs(tissue_noise(p / kGyrus + 3.0) - 0.5); }

}  // namespace

double smooth_step(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double tissue_noise(const Vec3& x) {
  const Vec3i cell = floor_int(x);
  Vec3 f = x - Vec3(cell);
  f = f * f * (3.0 - 2.0 * f);
  double sum = 0.0;
  for (unsigned c = 0; c < 8; ++c) {
    const Vec3i at = cell + cell_corner(c);
    const Vec3 w = glm::mix(1.0 - f, f, Vec3(cell_corner(c)));
    const std::uint32_t h = mixed(static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y), static_cast<std::uint32_t>(at.z));
    sum += w.x * w.y * w.z * static_cast<double>(h >> 8) / 16777216.0;
  }
  return sum;
}

Rgba8 dura_color(const Vec3& p, double depth, double lip) {
  const double trunk = vessel(p / 6.0e-3, Vec3(0.8, 0.36, 0.48), 0.06);
  const double branch = vessel(p / 2.8e-3 + 5.0, Vec3(0.28, 0.96, 0.0), 0.08);
  Vec3 color = Vec3(0.80, 0.65, 0.61) * (0.92 + 0.14 * tissue_noise(p / Vec3(0.5e-3, 2.2e-3, 0.5e-3)));
  color = glm::mix(color, Vec3(0.60, 0.16, 0.15), std::max(0.85 * trunk, 0.6 * branch) * (1.0 - 0.6 * lip));
  color = glm::mix(color, Vec3(0.87, 0.76, 0.71), 0.7 * lip);
  color *= 1.0 - kLeastLight * smooth_step(0.0, kDarkFrom, depth);
  return rgba(color, kDuraShine);
}

Rgba8 dura_inside_color(const Vec3& p, double bloody) {
  Vec3 color = Vec3(0.86, 0.75, 0.70) * (0.92 + 0.12 * tissue_noise(p / Vec3(0.25e-3, 0.9e-3, 0.25e-3)));
  const double stain = smooth_step(0.5, 0.72, tissue_noise(p / 0.9e-3 + 31.0));
  return rgba(glm::mix(color, Vec3(0.52, 0.07, 0.07), 0.85 * bloody * stain), kDuraShine);
}

double sulcus_depth(const Vec3& p) { return kSulcus * (1.0 - smooth_step(0.0, 0.12, off_sulcus(p))); }

Rgba8 brain_color(const Vec3& p, double open) {
  const double groove = 1.0 - smooth_step(0.0, 0.09, off_sulcus(p));
  Vec3 color = Vec3(0.86, 0.62, 0.56) * (0.93 + 0.12 * tissue_noise(p / 1.7e-3 + 9.0));
  color = glm::mix(color, Vec3(0.60, 0.27, 0.27), 0.6 * groove);
  const double fine = vessel(p / 1.3e-3 + 7.0, Vec3(0.55, -0.8, 0.2), 0.09);
  color = glm::mix(color, Vec3(0.74, 0.18, 0.15), 0.5 * fine);
  // A vein along the groove, arteries across the gyri.
  const double artery = 1.0 - smooth_step(0.012, 0.03, off_line(p / 4.5e-3 + 2.0, Vec3(0.34, 0.9, 0.27)));
  color = glm::mix(color, Vec3(0.66, 0.07, 0.08), 0.9 * artery);
  const double vein = 1.0 - smooth_step(0.016, 0.036, off_line(p / 6.5e-3 + 11.0, Vec3(0.86, -0.45, 0.2)));
  color = glm::mix(color, Vec3(0.38, 0.12, 0.20), 0.85 * vein);
  return rgba(color * glm::mix(kShade, 1.0, open), kBrainShine);
}

}  // namespace burrhole
