// What a client of the installed package does first: include by the same paths as inside the tree, call into the libraries.
#include <core/base/geometry.h>
#include <core/voxel/bone_model.h>
#include <volumes/phantom/phantom.h>

#include <cmath>
#include <cstdio>

int main() {
  burrhole::PhantomSpec spec;
  spec.kind = burrhole::PhantomKind::sphere;
  spec.extent = burrhole::Vec3(16e-3);
  const auto phantom = burrhole::make_phantom(spec);
  if (!phantom) return std::puts(phantom.error().text().c_str()), 1;
  // Stores into OpenVDB, a private part of core: a dependency that the export forgot would stop at the link.
  const auto bone = burrhole::BoneModel::create(phantom->bone);
  if (!bone) return std::puts(bone.error().text().c_str()), 1;

  const burrhole::Pose world_from_bone{burrhole::rotation_from_z({1.0, 0.0, 0.0}), {0.0, 0.0, 0.01}};
  const double volume_mm3 = 1e9 * static_cast<double>((*bone)->bone_voxels()) * (*bone)->bone_from_index().cell_volume();
  const double exact_mm3 = 4.0 / 3.0 * 3.14159265358979 * std::pow(spec.sphere_radius * 1e3, 3);
  // Counting whole voxels of a ball 48 voxels across errs by well under 1 %.
  if (std::abs(volume_mm3 / exact_mm3 - 1.0) > 0.01) return std::printf("client: %.1f mm3, not %.1f\n", volume_mm3, exact_mm3), 1;
  std::printf("client: ok, %.1f mm3 of bone, outward along world x = %.1f\n", volume_mm3, world_from_bone.rotate({0.0, 0.0, 1.0}).x);
  return 0;
}
