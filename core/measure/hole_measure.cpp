#include "core/measure/hole_measure.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/bounds.h"
#include "core/contact/contact_view.h"
#include "core/measure/dense_field.h"

namespace burrhole {
namespace {

/// Smallest and largest of the 27 values round a voxel, on which the trilinear samples in its cell depend.
struct Around {
  float least = std::numeric_limits<float>::max(), most = std::numeric_limits<float>::lowest();
  Around(const DenseField& field, std::size_t at, std::size_t row, std::size_t slab) {
    for (std::size_t n = 0; n < 27; ++n) {
      const float value = field.values[at + n % 3 + n / 3 % 3 * row + n / 9 * slab - 1 - row - slab];
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
};

/// @param box at least a voxel inside those of the fields, which are the same.
double removed_volume(const DenseField& before, const DenseField& after, const VoxelBox& box, double cell_volume) {
  constexpr int kSub = 4;
  std::uint64_t gone = 0;
  const auto row = static_cast<std::size_t>(before.box.size().x), slab = row * static_cast<std::size_t>(before.box.size().y);
  const auto changed = [&](std::size_t at) {
    for (std::size_t n = 0; n < 9; ++n) {
      const std::size_t first = at + n % 3 * row + n / 3 * slab - 1 - row - slab;
      if (!std::equal(&before.values[first], &before.values[first] + 3, &after.values[first])) return true;
    }
    return false;
  };
  for_each_voxel(box, [&](const Vec3i& v) {
    const std::size_t at = before.box.offset_of(v);
    const Around was(before, at, row, slab), is(after, at, row, slab);
    if (was.most < kSurfaceLevel || is.least >= kSurfaceLevel || !changed(at)) return;
    if (was.least >= kSurfaceLevel && is.most < kSurfaceLevel) {
      gone += kSub * kSub * kSub;
      return;
    }
    for_each_voxel({Vec3i(0), Vec3i(kSub)}, [&](const Vec3i& o) {
      const Vec3 p = Vec3(v) + (Vec3(o) + 0.5) / static_cast<double>(kSub) - 0.5;
      if (before.sample(p) >= kSurfaceLevel && after.sample(p) < kSurfaceLevel) ++gone;
    });
  });
  return static_cast<double>(gone) / (kSub * kSub * kSub) * cell_volume;
}

/// Heights along the axis [m] of the first and the last bone on a ray, among those of `heights`, in falling order.
std::optional<std::pair<double, double>> bone_span(const DenseField& field, const Affine& index_from_approach, double x, double y,
                                                   const std::vector<double>& heights) {
  const auto is_bone = [&](double z) { return field.sample(index_from_approach * Vec3(x, y, z)) >= kSurfaceLevel; };
  const auto first = std::ranges::find_if(heights, is_bone);
  if (first == heights.end()) return std::nullopt;
  return std::pair{*first, *std::find_if(heights.rbegin(), std::make_reverse_iterator(first), is_bone)};
}

}  // namespace

HoleMeasure measure_hole(Voxmap& voxmap, const Approach& approach) {
  HoleMeasure out;
  const VoxelBox changed = voxmap.changed_bounds().grown(1).intersect(voxmap.bone().bounds().grown(1));
  if (voxmap.changed_bounds().empty()) return out;
  const Affine& bone_from_index = voxmap.bone().bone_from_index();
  const double edge = bone_from_index.mean_edge();
  const VoxelBox box = changed.grown(static_cast<int>(std::ceil(0.004 / edge)));
  DenseField before{box, std::vector<float>(box.count())}, after{box, std::vector<float>(box.count())};
  voxmap.read_start(box, before.values);
  voxmap.read_density(box, after.values);
  out.removed = removed_volume(before, after, changed, bone_from_index.cell_volume());
  for (std::size_t n = 0; n < before.values.size(); ++n)
    out.removed_mass += std::max(0.0, static_cast<double>(before.values[n]) - static_cast<double>(after.values[n]));
  out.removed_mass *= bone_from_index.cell_volume();

  const Affine approach_from_index = Affine::from_pose(approach.bone_from_approach.inverse()) * bone_from_index;
  const Affine index_from_approach = approach_from_index.inverse();
  const auto [lo, hi] = bounds_under(approach_from_index, {Vec3(box.lo), Vec3(box.hi)});
  const Bounds hole = bounds_under(approach_from_index, {Vec3(changed.lo), Vec3(changed.hi)});
  const double pitch = 0.5 * edge, step = 0.25 * edge;
  std::vector<double> heights;
  for (double z = hi.z; z > lo.z; z -= step) heights.push_back(z);
  std::uint64_t outer = 0, inner = 0;
  for (double y = lo.y; y < hi.y; y += pitch)
    for (double x = lo.x; x < hi.x; x += pitch) {
      if (x < hole.lo.x || x > hole.hi.x || y < hole.lo.y || y > hole.hi.y) continue;
      const auto span = bone_span(before, index_from_approach, x, y, heights);
      if (!span) continue;
      const auto gone = [&](double z) {
        const Vec3 p = index_from_approach * Vec3(x, y, z);
        return before.sample(p) >= kSurfaceLevel && after.sample(p) < kSurfaceLevel;
      };
      outer += gone(span->first - 0.5 * edge) ? 1 : 0;
      inner += gone(span->second + 0.5 * edge) ? 1 : 0;
    }
  const auto diameter = [&](std::uint64_t count) { return 2.0 * std::sqrt(static_cast<double>(count) * pitch * pitch / std::numbers::pi); };
  const auto resolved = [&](std::uint64_t count) { return diameter(count) >= 2.0 * edge; };
  if (resolved(outer)) out.outer_diameter = diameter(outer);
  if (resolved(inner)) out.inner_diameter = diameter(inner);
  return out;
}

}  // namespace burrhole
