#include "tests/volumes/read/scanned_skull.h"

#include <cmath>
#include <random>

#include "core/base/parallel.h"

namespace burrhole::test {

VoxelLabel Skull::label(const Vec3& p_bone) const noexcept {
  const double depth = radius - glm::length(p_bone);
  if (depth < 0.0 || depth > thickness()) return VoxelLabel::none;
  if (depth <= outer_table) return VoxelLabel::outer_table;
  return depth <= outer_table + diploe ? VoxelLabel::diploe : VoxelLabel::inner_table;
}

Scan scan_skull(const Skull& skull, const Scanner& scanner) {
  const double half = skull.radius + skull.skin + 6e-3;
  Scan out;
  out.quantity = Quantity::hounsfield;
  out.dims = Vec3i(glm::floor(2.0 * half / scanner.spacing)) + 1;
  out.bone_from_index.linear = Mat3(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) out.bone_from_index.linear[axis][axis] = scanner.spacing[axis];
  out.bone_from_index.offset = -0.5 * scanner.spacing * Vec3(out.dims - 1) + Vec3(0.0, 0.0, scanner.phase * scanner.spacing.z);
  // Values from outside to inside; each border is blurred. At 45 mm the curvature changes a blur of 0.5 mm by a hundredth.
  const std::array<double, 5> depth{-skull.skin, 0.0, skull.borders()[1], skull.borders()[2], skull.borders()[3]};
  const std::array<double, 6> value{skull.air_hu, skull.tissue_hu, skull.table_hu, skull.diploe_hu, skull.table_hu, skull.tissue_hu};
  const auto at = [&](double d) {
    double sum = value[0];
    for (std::size_t n = 0; n < depth.size(); ++n)
      sum += (value[n + 1] - value[n]) * 0.5 * std::erfc(-(d - depth[n]) / (scanner.blur * std::sqrt(2.0)));
    return sum;
  };
  const VoxelBox all{Vec3i(0), out.dims};
  out.values.resize(all.count());
  for_each_number(out.dims.z, [&](int k) {
    std::mt19937 noise(static_cast<unsigned>(k) + 1u);
    std::normal_distribution<double> draw(0.0, 1.0);
    for_each_voxel({{0, 0, k}, {out.dims.x, out.dims.y, k + 1}}, [&](const Vec3i& v) {
      const Vec3 centre = out.bone_from_index * Vec3(v);
      double sum = 0.0;
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b)
          for (int c = 0; c < 4; ++c)
            sum += at(skull.radius - glm::length(centre + scanner.spacing * Vec3(0.5 * a - 0.25, 0.5 * b - 0.25, 0.25 * c - 0.375)));
      out.values[all.offset_of(v)] = static_cast<float>(sum / 16.0 + scanner.noise * draw(noise));
    });
  });
  return out;
}

}  // namespace burrhole::test
