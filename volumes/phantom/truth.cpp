#include "volumes/phantom/truth.h"

#include <algorithm>

#include "core/base/portable_math.h"
#include "volumes/phantom/skull_layers.h"

namespace burrhole {
namespace {

std::variant<ShellShape, BoxShape, SlabShape, BallShape, CapsuleShape, WedgeShape, PitShape> shape_of(const PhantomSpec& spec) {
  switch (spec.kind) {
    case PhantomKind::block:
      return BoxShape{Vec3(0.0, 0.0, -0.5 * spec.block_size.z), 0.5 * spec.block_size};
    case PhantomKind::plate:
      return SlabShape{spec.plate_normal / glm::length(spec.plate_normal), spec.thickness};
    case PhantomKind::sphere:
      return BallShape{Vec3(0.0, 0.0, -spec.sphere_radius), spec.sphere_radius};
    case PhantomKind::capsule:
      return CapsuleShape{0.5 * spec.capsule_length - spec.sphere_radius, spec.sphere_radius};
    case PhantomKind::wedge:
      return WedgeShape{portable_sin(0.5 * spec.wedge_angle), portable_cos(0.5 * spec.wedge_angle)};
    case PhantomKind::pit:
      return PitShape{spec.thickness, spec.hole_radius, spec.hole_depth};
    case PhantomKind::skull_patch:
    case PhantomKind::head:  // not built as a dense phantom: head_bone.h
      break;
  }
  return ShellShape{spec.curvature, spec.curvature - spec.thickness, spec.rim_radius};
}

}  // namespace

Truth::Truth(const PhantomSpec& spec) : shape_(shape_of(spec)), spec_(spec) {
  const Affine bone_from_index = phantom_bone_from_index(spec);
  box_lo_ = bone_from_index * Vec3(-0.5);
  box_hi_ = bone_from_index * (Vec3(phantom_dims(spec)) - 0.5);
}

SurfaceDistance Truth::nearest(const Vec3& p_bone) const noexcept {
  return std::visit([&](const auto& shape) { return shape.nearest(p_bone); }, shape_);
}

RaySpans Truth::stretches(const Vec3& origin, const Vec3& direction) const noexcept {
  const Ray ray{origin, direction / glm::length(direction)};
  const RaySpan in_box = clip_box({}, ray, box_lo_, box_hi_);
  return std::visit([&](const auto& shape) { return shape.along(ray, in_box); }, shape_);
}

double Truth::thickness_along(const Vec3& origin, const Vec3& direction) const noexcept {
  const RaySpans s = stretches(origin, direction);
  return (s.first.empty() ? 0.0 : s.first.exit - s.first.enter) + (s.second.empty() ? 0.0 : s.second.exit - s.second.enter);
}

std::optional<double> Truth::entry_distance(const Vec3& origin, const Vec3& direction) const noexcept {
  const RaySpans s = stretches(origin, direction);
  if (s.first.empty()) return std::nullopt;
  return s.first.enter;
}

VoxelLabel Truth::label(const Vec3& p_bone) const noexcept {
  if (spec_.kind == PhantomKind::skull_patch) return skull_label(spec_, skull_site(spec_, p_bone));
  return signed_distance(p_bone) <= 0.0 ? VoxelLabel::bone : VoxelLabel::none;
}

}  // namespace burrhole
