#include "app/lab/oracle/contact_reference.h"

#include <algorithm>

namespace burrhole {

Vec3 exact_average_force(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool, double stiffness) noexcept {
  Vec3 sum(0.0);
  int inside = 0;
  for (const Vec3& position : shell.positions) {
    const SurfaceDistance surface = truth.nearest(bone_from_tool * position);
    if (surface.signed_distance > 0.0) continue;
    ++inside;
    sum -= surface.normal * surface.signed_distance;
  }
  return inside > 0 ? sum * (stiffness / inside) : sum;
}

Vec3 exact_deepest_force(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool, double stiffness) noexcept {
  SurfaceDistance deepest{.signed_distance = 0.0, .normal = Vec3(0.0)};
  for (const Vec3& position : shell.positions)
    if (const SurfaceDistance surface = truth.nearest(bone_from_tool * position); surface.signed_distance < deepest.signed_distance)
      deepest = surface;
  return deepest.normal * (-deepest.signed_distance * stiffness);
}

double exact_translation_distance(const Truth& truth, const PointShell& shell, const Pose& bone_from_tool, const Vec3& out) noexcept {
  double way = 0.0;
  for (const Vec3& position : shell.positions) {
    const Vec3 p = bone_from_tool * position;
    if (truth.signed_distance(p) < 0.0) way = std::max(way, truth.thickness_along(p, out));
  }
  return way;
}

}  // namespace burrhole
