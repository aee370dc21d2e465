#include "volumes/phantom/skull_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burrhole {
namespace {

/// Counter stream of the sample points, different from that of the pores.
constexpr std::uint64_t kSampleStream = 0x706f726573616d70ull;

/// Points distributed over the diploe of this patch. They depend on the dimensions of the bone and the seed, not on the pitch, so a finer
/// grid has the same pores. They are uniform across the box and in depth. The true volume element differs by 1/cos of the slope, a few
/// percent at the corners, which is neglected.
std::vector<Vec3> diploe_samples(const PhantomSpec& spec) {
  constexpr std::uint64_t kCount = 1u << 15;
  std::vector<Vec3> points;
  points.reserve(kCount);
  const std::uint64_t seed = static_cast<std::uint64_t>(spec.seed) ^ kSampleStream;
  const double diploe = spec.thickness - spec.outer_table - spec.inner_table;
  for (std::uint64_t n = 0; n < kCount; ++n) {
    const double x = 0.5 * spec.extent.x * uniform11(seed, 3 * n);
    const double y = 0.5 * spec.extent.y * uniform11(seed, 3 * n + 1);
    const double r = spec.curvature - spec.outer_table - diploe * uniform01(seed, 3 * n + 2);
    const double height_squared = r * r - x * x - y * y;
    if (height_squared > 0.0) points.emplace_back(x, y, std::sqrt(height_squared) - spec.curvature);
  }
  // Of a head: those around its entry, whose radius of curvature is about that of a patch.
  if (spec.kind == PhantomKind::head) {
    const Quat turn = rotation_from_z(-spec.head_axis);
    for (Vec3& p : points) p = spec.head_entry + turn * p;
  }
  return points;
}

/// 1 well above the border, 0 well below, a ramp over one voxel.
double share_above(double distance_above, double pitch) noexcept { return std::clamp(0.5 + distance_above / pitch, 0.0, 1.0); }

}  // namespace

SkullSite skull_site(const PhantomSpec& spec, const Vec3& p_bone) noexcept {
  const Vec3 q = p_bone + Vec3(0.0, 0.0, spec.curvature);
  const double r = glm::length(q);
  const double rho = std::sqrt(q.x * q.x + q.y * q.y);
  SkullSite site;
  site.depth = spec.curvature - r;
  if (r > 0.0) site.up = q / r;
  if (rho > 0.0) site.out = Vec3(q.x, q.y, 0.0) / rho;
  site.past_rim = spec.rim_radius > 0.0 ? rho - spec.rim_radius : -std::numeric_limits<double>::infinity();
  return site;
}

VoxelLabel skull_label(const PhantomSpec& spec, const SkullSite& site) noexcept {
  if (site.depth < 0.0 || site.past_rim > 0.0) return VoxelLabel::none;
  if (site.depth <= spec.outer_table) return VoxelLabel::outer_table;
  if (site.depth <= spec.thickness - spec.inner_table) return VoxelLabel::diploe;
  if (site.depth <= spec.thickness) return VoxelLabel::inner_table;
  return site.depth <= spec.thickness + spec.dura ? VoxelLabel::dura : VoxelLabel::brain;
}

SurfaceDistance soft_surface(const PhantomSpec& spec, const SkullSite& site) noexcept {
  const double above = spec.thickness - site.depth;
  return above >= site.past_rim ? SurfaceDistance{above, site.up} : SurfaceDistance{site.past_rim, site.out};
}

SkullHardness::SkullHardness(const PhantomSpec& spec)
    : spec_(spec),
      pores_(PoreField::calibrated(static_cast<std::uint64_t>(spec.seed), spec.pore_size, spec.porosity, diploe_samples(spec))) {}

double SkullHardness::at(const Vec3& p_bone, double depth) const noexcept {
  const double in_outer = share_above(spec_.outer_table - depth, spec_.pitch);
  const double in_inner = share_above(depth - (spec_.thickness - spec_.inner_table), spec_.pitch);
  // Without diploe both borders coincide and the shares add to 1; with less than a voxel of diploe their sum may exceed 1.
  const double in_diploe = std::max(0.0, 1.0 - in_outer - in_inner);
  if (in_diploe <= 0.0) return spec_.table_hardness;
  const double in_pore = pores_.share(p_bone, spec_.pitch);
  const double diploe = spec_.trabecula_hardness + in_pore * (spec_.pore_hardness - spec_.trabecula_hardness);
  return spec_.table_hardness + in_diploe * (diploe - spec_.table_hardness);
}

}  // namespace burrhole
