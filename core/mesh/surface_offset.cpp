#include "core/mesh/surface_offset.h"

#include "core/base/bounds.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr int kSteps = 6;  // of the search, of a quarter of a voxel
constexpr double kStep = kLongestOffset / kSteps;
constexpr int kHalvings = 8;             // of a step, to a thousandth of a voxel; then linear: 1e-6 voxel
constexpr double kLeastGradient = 1e-4;  // [1/voxel] rounding of a symmetric neighbourhood is smaller

double density_at(const DensityBlock& block, const Vec3i& v) {
  return block.box.contains(v) ? static_cast<double>(block.density[block.box.offset_of(v)]) : 0.0;
}

}  // namespace

double sample_density(const DensityBlock& block, const Vec3& p) {
  const Vec3i base = floor_int(p);
  if (block.box.contains(base) && block.box.contains(base + 1)) return trilinear(block.box, block.density.data(), p);
  return trilinear(p - Vec3(base), [&](unsigned n) { return density_at(block, base + cell_corner(n)); });
}

std::optional<Vec3> offset_to_surface(const DensityBlock& block, const Vec3i& voxel) {
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i step(0);
    step[axis] = 1;
    gradient[axis] = 0.5 * (density_at(block, voxel + step) - density_at(block, voxel - step));
  }
  if (!(glm::length(gradient) > kLeastGradient)) return std::nullopt;
  return offset_along(block, voxel, -gradient);
}

std::optional<Vec3> offset_along(const DensityBlock& block, const Vec3i& voxel, const Vec3& direction) {
  const double length = glm::length(direction);
  if (!(length > 0.0)) return std::nullopt;
  const Vec3 outward = direction / length, centre(voxel);
  const auto above = [&](double way) { return sample_density(block, centre + way * outward) - 0.5; };
  double inside = 0.0, at_inside = density_at(block, voxel) - 0.5;
  for (int step = 1; step <= kSteps; ++step) {
    double outside = kStep * step;
    double at_outside = above(outside);
    if (at_outside >= 0.0) {
      inside = outside;
      at_inside = at_outside;
      continue;
    }
    for (int n = 0; n < kHalvings; ++n) {
      const double middle = 0.5 * (inside + outside), at_middle = above(middle);
      (at_middle >= 0.0 ? inside : outside) = middle;
      (at_middle >= 0.0 ? at_inside : at_outside) = at_middle;
    }
    return (inside + (outside - inside) * at_inside / (at_inside - at_outside)) * outward;
  }
  return std::nullopt;
}

}  // namespace burrhole
