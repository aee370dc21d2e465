#include "app/view/blood_film.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/view/bone_patch.h"
#include "app/view/clipped_patch.h"
#include "app/view/tissue_texels.h"
#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr int kReach = 2;                        // [voxels] of the sum round a point
constexpr double kFiner = 1.4e3, kWide = 420.0;  // [1/m] of what makes edge and surface uneven
constexpr double kThick = 0.9;                   // [-] of how much there is, from which the colour is that of a thick layer

/// Slow change over the surface [-], -1..1, so that a layer has no pattern of voxels.
double uneven(const Vec3& p, double rate) {
  const Vec3 x = 2.0 * std::numbers::pi * rate * p;
  return 0.5 * (std::sin(x.x + 0.7 * x.z + std::sin(0.8 * x.y + 1.0)) + std::sin(1.2 * x.y - 0.6 * x.x + std::sin(1.1 * x.z)));
}

/// The voxels with pores that are covered, with those round them.
VoxelBox covered(const VoxelBox& all, std::span<const float> pores) {
  Vec3i lo = all.hi, hi = all.lo;
  for_each_voxel(all, [&](const Vec3i& voxel) {
    if (!(pores[all.offset_of(voxel)] > 0.0f)) return;
    lo = glm::min(lo, voxel);
    hi = glm::max(hi, voxel + 1);
  });
  const VoxelBox out{lo - (kReach + 1), hi + (kReach + 1)};
  return glm::all(glm::lessThan(lo, hi)) ? out.intersect(all) : VoxelBox{};
}

}  // namespace

void append_film(const SiteBone& bone, std::span<const float> density, std::span<const float> pores, const FilmLook& look, AddedMesh& out) {
  const VoxelBox box = covered(bone.box, pores);
  if (box.empty()) return;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(box.count());
  for_each_voxel(box, [&](const Vec3i& voxel) {
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(density[bone.box.offset_of(voxel)], 0.0f, 1.0f))));
  });
  TriangleMesh mesh = make_bone_patch({.box = box, .density = bytes, .bone_from_index = bone.bone_from_index, .lift = look.lift});
  const Affine index_from_bone = bone.bone_from_index.inverse();
  const auto amount_at = [&](const Vec3& p) {
    const Vec3 index = index_from_bone * p;
    const Vec3i middle = voxel_of(index);
    double sum = 0.0;
    for_each_voxel(VoxelBox{middle - kReach, middle + (kReach + 1)}.intersect(bone.box), [&](const Vec3i& voxel) {
      const double share = static_cast<double>(pores[bone.box.offset_of(voxel)]);
      if (share <= 0.0) return;
      const Vec3 way = index - Vec3(voxel);
      sum += share * std::exp(-0.5 * glm::dot(way, way) / (kFilmBlur * kFilmBlur));
    });
    return sum / (2.0 * std::numbers::pi * kFilmBlur * kFilmBlur);
  };
  std::vector<double> inside;
  inside.reserve(mesh.positions.size());
  for (std::size_t n = 0; n < mesh.positions.size(); ++n) {
    const Vec3 p(mesh.positions[n]);
    const double enough = amount_at(p) - look.least + look.ragged * uneven(p, kWide);
    const double above = look.dry_below ? (-glm::dot(bone.down, p) - *look.dry_below) / bone.bone_from_index.mean_edge() : enough;
    inside.push_back(std::min(enough, above));
    mesh.positions[n] = Vec3f(p + look.uneven * uneven(p, kFiner) * Vec3(mesh.normals[n]));
  }
  append_clipped(
      mesh, inside,
      [&](const Vec3f& p, double enough) {
        const Vec3 color =
            glm::mix(look.thin_color, look.thick_color, std::clamp(enough / kThick, 0.0, 1.0)) * (0.95 + 0.05 * uneven(Vec3(p), kFiner));
        return Rgba8{to_byte(color.x), to_byte(color.y), to_byte(color.z), look.shine};
      },
      out);
}

}  // namespace burrhole
