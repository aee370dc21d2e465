#include "core/measure/hole_measure.h"

#include <cmath>
#include <numbers>

#include "core/base/bounds.h"
#include "core/base/trilinear.h"
#include "core/contact/contact_view.h"

namespace burrhole {
namespace {

/// Dense field over a box with trilinear sampling; 0 outside.
struct Field {
  VoxelBox box;
  std::vector<float> values;

  [[nodiscard]] float at(const Vec3i& v) const { return box.contains(v) ? values[box.offset_of(v)] : 0.0f; }
  [[nodiscard]] double sample(const Vec3& p) const {
    const Vec3i base = floor_int(p);
    return trilinear(p - Vec3(base), [&](unsigned n) { return static_cast<double>(at(base + cell_corner(n))); });
  }
};

double removed_volume(const Field& before, const Field& after, const VoxelBox& box, double cell_volume) {
  constexpr int kSub = 4;
  std::uint64_t gone = 0;
  for_each_voxel(box, [&](const Vec3i& v) {
    bool same = true;  // trilinear samples in this cell depend on its 27 neighbours only
    for_each_voxel({v - 1, v + 2}, [&](const Vec3i& n) { same = same && before.at(n) == after.at(n); });
    if (same) return;
    for_each_voxel({Vec3i(0), Vec3i(kSub)}, [&](const Vec3i& o) {
      const Vec3 p = Vec3(v) + (Vec3(o) + 0.5) / static_cast<double>(kSub) - 0.5;
      if (before.sample(p) >= kSurfaceLevel && after.sample(p) < kSurfaceLevel) ++gone;
    });
  });
  return static_cast<double>(gone) / (kSub * kSub * kSub) * cell_volume;
}

/// Depths along the axis [m] of the first and the last bone as loaded on a ray from `top` down to `bottom`.
std::optional<std::pair<double, double>> bone_span(const Field& field, const Affine& index_from_approach, double x, double y, double top,
                                                   double bottom, double step) {
  std::optional<std::pair<double, double>> span;
  for (double z = top; z > bottom; z -= step) {
    if (field.sample(index_from_approach * Vec3(x, y, z)) < kSurfaceLevel) continue;
    if (!span) span = std::pair{z, z};
    span->second = z;
  }
  return span;
}

}  // namespace

HoleMeasure measure_hole(Voxmap& voxmap, const Approach& approach) {
  HoleMeasure out;
  const VoxelBox changed = voxmap.changed_bounds().grown(1).intersect(voxmap.bone().bounds().grown(1));
  if (voxmap.changed_bounds().empty()) return out;
  const Affine& bone_from_index = voxmap.bone().bone_from_index();
  const double edge = bone_from_index.mean_edge();
  const VoxelBox box = changed.grown(static_cast<int>(std::ceil(0.004 / edge)));
  Field before{box, std::vector<float>(box.count())}, after{box, std::vector<float>(box.count())};
  voxmap.bone().read_occupancy(box, before.values);
  voxmap.read_density(box, after.values);
  out.removed = removed_volume(before, after, changed, bone_from_index.cell_volume());
  for (std::size_t n = 0; n < before.values.size(); ++n)
    out.removed_mass += static_cast<double>(before.values[n]) - static_cast<double>(after.values[n]);
  out.removed_mass *= bone_from_index.cell_volume();

  const Affine approach_from_index = Affine::from_pose(approach.bone_from_approach.inverse()) * bone_from_index;
  const Affine index_from_approach = approach_from_index.inverse();
  const auto [lo, hi] = bounds_under(approach_from_index, {Vec3(box.lo), Vec3(box.hi)});
  const double pitch = 0.5 * edge, step = 0.25 * edge;
  std::uint64_t outer = 0, inner = 0;
  for (double y = lo.y; y < hi.y; y += pitch)
    for (double x = lo.x; x < hi.x; x += pitch) {
      const auto span = bone_span(before, index_from_approach, x, y, hi.z, lo.z, step);
      if (!span) continue;
      const auto gone = [&](double z) { return after.sample(index_from_approach * Vec3(x, y, z)) < kSurfaceLevel; };
      outer += gone(span->first - 0.5 * edge) ? 1 : 0;
      inner += gone(span->second + 0.5 * edge) ? 1 : 0;
    }
  const auto diameter = [&](std::uint64_t count) { return 2.0 * std::sqrt(static_cast<double>(count) * pitch * pitch / std::numbers::pi); };
  if (outer > 0) out.outer_diameter = diameter(outer);
  if (inner > 0) out.inner_diameter = diameter(inner);
  return out;
}

}  // namespace burrhole
