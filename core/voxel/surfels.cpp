// One surfel a cell that the surface passes (steps 1 and 2 of surface_records.cpp). Same bits at every level (surface_vectors-inl.h says
// how).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/surfels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/voxel/surface_tile.h"
#include "core/voxel/surface_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace {

/// Mean of the points where the edges of the cell pass 0.5.
HWY_INLINE F3 mean_crossing(const Corners& c) {
  const D d;
  const F level = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f);
  F count = hn::Zero(d);
  F sum[3] = {count, count, count};
  for (int axis = 0; axis < 3; ++axis)
    for (int a = 0; a < 8; ++a) {
      if ((a >> axis) & 1) continue;
      const F from = c.v[a], to = c.v[a | (1 << axis)];
      const auto crosses = hn::Xor(hn::Ge(from, level), hn::Ge(to, level));
      const F here = hn::IfThenElseZero(crosses, one);
      count = hn::Add(count, here);
      sum[axis] = hn::Add(sum[axis], hn::IfThenElseZero(crosses, hn::Div(hn::Sub(level, from), hn::Sub(to, from))));
      for (int other = 0; other < 3; ++other)
        if (other != axis && ((a >> other) & 1)) sum[other] = hn::Add(sum[other], here);
    }
  return {hn::Div(sum[0], count), hn::Div(sum[1], count), hn::Div(sum[2], count)};
}

// Cosine of 14 degrees. Plain differences on a ramp one voxel wide alias by less; where they are further from the smoothed direction, that
// has mixed the face with another, up to two voxels from an edge.
constexpr float kSameFace = 0.97f;

/// Normal of the smoothed field; where it is not that of the face in the cell (an edge near by, detail finer than the smoothing), the
/// density's own.
HWY_INLINE F3 normal_at(const SurfaceMap& map, const Cell& cell, const F3& p) {
  const D d;
  const F3 smooth = unit(outward(map, {interpolate(cell.gx, p), interpolate(cell.gy, p), interpolate(cell.gz, p)}));
  const F3 sharp = unit(outward(map, slope(cell.density, p)));
  const auto same = hn::Gt(dot(smooth, sharp), hn::Set(d, kSameFace)), flat = hn::Eq(dot(sharp, sharp), hn::Zero(d));
  return choose(hn::Or(same, flat), smooth, sharp);
}

/// Moves p along the normal to where the trilinear density is 0.5, at most to the walls of its cell.
HWY_INLINE F3 project(const SurfaceMap& map, const Corners& density, const F3& normal, F3 p) {
  const D d;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const F3 along = times(map.index_from_metric, normal);
  for (int step = 0; step < 3; ++step) {
    const F off = hn::Sub(hn::Set(d, 0.5f), interpolate(density, p));
    const F rate = dot(slope(density, p), along);
    // Where the density hardly changes along the normal a step would only leave the cell: the mean of the crossings stays.
    const F t = hn::IfThenElseZero(hn::Gt(hn::Abs(rate), hn::Set(d, 1e-3f)), hn::Div(off, rate));
    p = add(p, scale(hn::Clamp(t, hn::Set(d, -1.0f), one), along));
    p = {hn::Clamp(p.x, zero, one), hn::Clamp(p.y, zero, one), hn::Clamp(p.z, zero, one)};
  }
  return p;
}

/// How far the normals at the cell's corners turn from that at its surfel (the sine, at most 1), as a rate.
HWY_INLINE F bend_of(const SurfaceMap& map, const Cell& cell, const F3& normal) {
  const D d;
  F least = hn::Set(d, 1.0f);
  for (int n = 0; n < 8; ++n) least = hn::Min(least, dot(normal, unit(outward(map, {cell.gx.v[n], cell.gy.v[n], cell.gz.v[n]}))));
  least = hn::Max(least, hn::Zero(d));
  return hn::Sqrt(hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1.0f), hn::Mul(least, least))));
}

void MakeSurfels(const SurfaceMap& map, SurfaceTile& tile) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN float x[kMaxLanes], y[kMaxLanes], z[kMaxLanes], nx[kMaxLanes], ny[kMaxLanes], nz[kMaxLanes], bend[kMaxLanes];
  for (std::size_t n = 0; n < tile.found; n += lanes) {
    const Cell cell = read_cells(tile.samples.data(), tile.cell_offsets.data() + n, tile.row, tile.slab);
    F3 p = mean_crossing(cell.density);
    p = project(map, cell.density, normal_at(map, cell, p), p);
    const F3 normal = normal_at(map, cell, p);
    hn::Store(p.x, d, x), hn::Store(p.y, d, y), hn::Store(p.z, d, z);
    hn::Store(normal.x, d, nx), hn::Store(normal.y, d, ny), hn::Store(normal.z, d, nz);
    hn::Store(bend_of(map, cell, normal), d, bend);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      Surfel& s = tile.surfels[n + lane];
      s = {x[lane], y[lane], z[lane], s.cell, nx[lane], ny[lane], nz[lane], bend[lane]};
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(MakeSurfels);

void make_surfels(const SurfaceMap& map, SurfaceTile& tile) noexcept { HWY_DYNAMIC_DISPATCH(MakeSurfels)(map, tile); }

}  // namespace burrhole
#endif
