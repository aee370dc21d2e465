#include "core/drill/field_sampler.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

/// Maximum within `reach` nodes along each axis, one axis after another.
void spread_largest(std::vector<float>& values, const Vec3i& dims, int reach) {
  const VoxelBox all{Vec3i(0), dims};
  std::vector<float> line;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3i step(0), face = dims;
    step[axis] = 1;
    face[axis] = 1;
    const std::size_t stride = all.offset_of(step), length = static_cast<std::size_t>(dims[axis]), wide = static_cast<std::size_t>(reach);
    for_each_voxel({Vec3i(0), face}, [&](const Vec3i& v) {
      line.resize(length);
      float* first = values.data() + all.offset_of(v);
      for (std::size_t n = 0; n < length; ++n) line[n] = first[n * stride];
      for (std::size_t n = 0; n < length; ++n) {
        const std::size_t lo = n > wide ? n - wide : 0, hi = std::min(length, n + wide + 1);
        first[n * stride] =
            *std::max_element(line.begin() + static_cast<std::ptrdiff_t>(lo), line.begin() + static_cast<std::ptrdiff_t>(hi));
      }
    });
  }
}

}  // namespace

std::vector<float> bends_of(const CuttingField& field, double sign, int spread) {
  const VoxelBox all{Vec3i(0), field.dims};
  std::vector<float> out(field.distance.size(), 0.0f);
  for_each_voxel(all.grown(-1), [&](const Vec3i& v) {
    const std::size_t at = all.offset_of(v);
    for (int n = 14; n < 27; ++n) {  // one of each pair of opposite directions
      const Vec3i step(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      const double length = field.pitch * glm::length(Vec3(step));
      const float bend = field.distance[all.offset_of(v + step)] - 2.0f * field.distance[at] + field.distance[all.offset_of(v - step)];
      out[at] = std::max(out[at], static_cast<float>(sign * static_cast<double>(bend) / (length * length)));
    }
  });
  spread_largest(out, field.dims, spread);
  return out;
}

double steepest_of(const CuttingField& field) {
  const VoxelBox all{Vec3i(0), field.dims};
  const std::size_t row = static_cast<std::size_t>(field.dims.x), slab = row * static_cast<std::size_t>(field.dims.y);
  float most = 0.0f;
  for_each_voxel({Vec3i(0), field.dims - 1}, [&](const Vec3i& v) {
    const float* a = field.distance.data() + all.offset_of(v);
    const auto steepest = [a](std::size_t along, std::size_t b, std::size_t c) {
      float edge = 0.0f;
      for (const std::size_t at : {std::size_t{0}, b, c, b + c}) edge = std::max(edge, std::abs(a[at + along] - a[at]));
      return edge;
    };
    float farthest = a[0];
    for (const std::size_t at : {std::size_t{1}, row, row + 1, slab, slab + 1, slab + row, slab + row + 1})
      farthest = std::max(farthest, a[at]);
    if (farthest < 0.0f) return;
    const Vec3f edges(steepest(1, row, slab), steepest(row, 1, slab), steepest(slab, 1, row));
    most = std::max(most, glm::dot(edges, edges));
  });
  return std::max(1.0, std::sqrt(static_cast<double>(most)) / field.pitch);
}

}  // namespace burrhole
