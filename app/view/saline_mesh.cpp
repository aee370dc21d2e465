#include "app/view/saline_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/view/clipped_patch.h"
#include "app/view/tissue_texels.h"
#include "core/base/bounds.h"

namespace burrhole {
namespace {

constexpr double kMoved = 5e-5;                     // [m] of the tip, above which the next picture shows it
constexpr std::uint8_t kWet = 255;                  // shine
constexpr Vec3 kSoaked(0.75, 0.71, 0.66);           // [-] of the colour of dry bone
constexpr Vec3 kGlint(0.93, 0.93, 0.92);            // of a lamp overhead, mirrored by the crests of ripples
constexpr double kRipple = 2e-5, kRipples = 3.0e3;  // [m], [1/m] of the film
constexpr double kDull = 0.75, kBright = 1.05;      // [-] of the highest crest, between which glints begin and would be full

/// Height of the ripples at a point of the surface [-], 0..1.
double crest(const Vec3& p) {
  const Vec3 x = kRipples * p;
  return 0.5 + 0.25 * (std::sin(x.x + 0.6 * x.y + std::sin(0.8 * x.z + x.y)) + std::sin(1.3 * x.y - 0.7 * x.z + std::sin(0.9 * x.x)));
}

}  // namespace

double inside_film(const SalineFilm& film, const Vec3& p) noexcept {
  const Vec3 way = p - film.tip;
  return std::min(film.reach - glm::length(way), glm::dot(way, film.up) + film.below);
}

SalinePicture::SalinePicture(const VoxelBox& voxels, std::vector<Rgba8> colors, const Affine& bone_from_index)
    : density_(voxels), colors_(std::move(colors)), bone_from_index_(bone_from_index), index_from_bone_(bone_from_index.inverse()) {}

bool SalinePicture::copy_for_picture(bool exactly) {
  const bool flows = film_.reach > 0.0, flowed = shown_.reach > 0.0;
  const double seen = exactly ? 0.0 : kMoved;
  const bool moved = glm::length(film_.tip - shown_.tip) > seen || glm::length(film_.up - shown_.up) * film_.reach > seen;
  const bool first = std::exchange(first_, false);
  if (!first && flows == flowed && (!flows || (!moved && !bone_moved_))) return false;
  bone_moved_ = false;
  shown_ = film_;
  box_ = {};
  if (flows) {
    const Bounds ball = bounds_under(index_from_bone_, {film_.tip - film_.reach, film_.tip + film_.reach});
    box_ = VoxelBox{floor_int(ball.lo) - 1, floor_int(ball.hi) + 3}.intersect(density_.box());
    if (box_.empty()) box_ = {};
  }
  density_.copy(box_, copied_);
  return true;
}

Rgba8 SalinePicture::wet_color(const Vec3& p) const noexcept {
  const VoxelBox& all = density_.box();
  const Vec3i voxel = glm::clamp(voxel_of(index_from_bone_ * p), all.lo, all.hi - 1);
  const Rgba8& dry = colors_[all.offset_of(voxel)];
  const double glint = glm::smoothstep(kDull, kBright, crest(p));
  const Vec3 wet = glm::mix(kSoaked * Vec3(dry.r, dry.g, dry.b) / 255.0, kGlint, glint);
  return {to_byte(wet.x), to_byte(wet.y), to_byte(wet.z), kWet};
}

void SalinePicture::append_mesh(AddedMesh& out) const {
  if (box_.empty()) return;
  TriangleMesh mesh = make_bone_patch({.box = box_, .density = copied_, .bone_from_index = bone_from_index_});
  std::vector<double> inside;
  inside.reserve(mesh.positions.size());
  for (std::size_t n = 0; n < mesh.positions.size(); ++n) {
    const Vec3 p(mesh.positions[n]);
    inside.push_back(inside_film(shown_, p));
    mesh.positions[n] = Vec3f(p + 4.0 * kRipple * crest(p) * Vec3(mesh.normals[n]));
  }
  append_clipped(
      mesh, inside, [this](const Vec3f& p, double) { return wet_color(Vec3(p)); }, out);
}

}  // namespace burrhole
