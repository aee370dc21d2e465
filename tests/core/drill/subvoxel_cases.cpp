#include "tests/core/drill/subvoxel_cases.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/base/random.h"
#include "tests/support/plain_trilinear.h"

namespace burrhole::test {
namespace {

constexpr double kVoxel = 0.25e-3;

int edge_for(const SolidCase& one) { return static_cast<int>(std::ceil(3.2 * one.radius + one.way)) + 10; }

}  // namespace

std::shared_ptr<const CuttingField> field_of(const SweptSolid& solid, float factor) {
  const double r = solid.radius, h = solid.ball ? 2.0 * r : solid.height;
  const auto distance = [=, ball = solid.ball](const Vec3& p) {
    if (ball) return glm::length(p - Vec3(0.0, 0.0, r)) - r;
    const double side = std::sqrt(p.x * p.x + p.y * p.y) - r, end = std::max(-p.z, p.z - h);
    return std::min(std::max(side, end), 0.0) + std::hypot(std::max(side, 0.0), std::max(end, 0.0));
  };
  auto field = make_cutting_field(
      {Vec3(-r, -r, 0.0), Vec3(r, r, h)}, distance, [=](const Vec3&) { return static_cast<double>(factor); },
      cutting_field_size(solid.voxel, std::min(r, 0.5 * h)));
  if (!field) std::abort();
  return std::make_shared<const CuttingField>(std::move(field).value());
}

Erosion subvoxel_erosion(const SweptSolid& solid, float factor, ErosionConfig config) {
  auto erosion = Erosion::create(config, solid.points(0.5 * solid.voxel, factor), field_of(solid, factor));
  if (!erosion) std::abort();
  return std::move(erosion).value();
}

SweptSolid random_solid(const SolidCase& one) {
  SweptSolid solid{.ball = one.ball, .radius = one.radius * kVoxel, .height = 2.0 * one.radius * kVoxel, .voxel = kVoxel};
  const auto u = [&](std::uint64_t n) { return uniform11(one.seed, 100 + n); };
  solid.way = one.way * glm::normalize(Vec3(u(0), u(1), u(2)));
  solid.from = turned_pose(kVoxel, Vec3(0.0), one.seed);
  const Vec3 centre = Vec3(0.5 * edge_for(one)) + Vec3(u(3), u(4), u(5));
  solid.from.offset = centre - 0.5 * solid.way - solid.from.linear * Vec3(0.0, 0.0, solid.radius);
  return solid;
}

Voxmap block_for(const SolidCase& one) { return Block{.dims = Vec3i(edge_for(one)), .pitch = kVoxel}.make(); }

double sweep_through(Voxmap& voxmap, Erosion& erosion, const SweptSolid& solid, int steps) {
  const Drilling drilling = drill(voxmap, erosion, solid.path(), 1.0, 1e-3 * steps, steps);
  return drilling.mass / (solid.voxel * solid.voxel * solid.voxel);
}

double density_at(const MasterWindow& window, const Vec3& p) {
  return plain_trilinear(p, [&](const Vec3i& v) { return window.density[window.box.offset_of(v)]; });
}

Vec3 rise_at(const MasterWindow& window, const Vec3& p) {
  Vec3 rise;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 step(0.0);
    step[axis] = 1.0;
    rise[axis] = density_at(window, p + step) - density_at(window, p - step);
  }
  return glm::normalize(rise);
}

double hollow(const MasterWindow& window) {
  double sum = 0.0;
  for_each_voxel({window.box.lo + 4, window.box.hi - 5}, [&](const Vec3i& v) {
    float least = 1.0f, most = 0.0f;
    for_each_voxel({v, v + 2}, [&](const Vec3i& corner) {
      const float d = window.density[window.box.offset_of(corner)];
      least = std::min(least, d);
      most = std::max(most, d);
    });
    if (least >= 0.5f) return;
    if (most < 0.5f) {
      sum += 1.0;
      return;
    }
    for_each_voxel({Vec3i(0), Vec3i(8)},
                   [&](const Vec3i& part) { sum += density_at(window, Vec3(v) + (Vec3(part) + 0.5) / 8.0) < 0.5 ? 1.0 / 512.0 : 0.0; });
  });
  return sum;
}

double surface_offset(const MasterWindow& window, const Vec3& p, const Vec3& outward) {
  const auto excess = [&](double s) { return density_at(window, p + s * outward) - 0.5; };
  for (double s = -2.0; s < 2.0; s += 0.02) {
    if (!(excess(s) < 0.0 && excess(s + 0.02) >= 0.0)) continue;
    double lo = s, hi = s + 0.02;
    for (int n = 0; n < 20; ++n) (excess(0.5 * (lo + hi)) < 0.0 ? lo : hi) = 0.5 * (lo + hi);
    return 0.5 * (lo + hi);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace burrhole::test
