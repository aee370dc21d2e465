#include "volumes/phantom/phantom.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "volumes/phantom/skull_layers.h"

namespace burrhole {
namespace {

/// Counter streams of the noise on the two densities.
constexpr std::uint64_t kOccupancyStream = 0x6f63637570616e63ull;
constexpr std::uint64_t kHardnessStream = 0x686172646e657373ull;

double ramp(const SurfaceDistance& s, double pitch) noexcept {
  const double reach = pitch * (std::abs(s.normal.x) + std::abs(s.normal.y) + std::abs(s.normal.z));
  return std::clamp(0.5 - s.signed_distance / (2.0 * reach), 0.0, 1.0);
}

void allocate(DenseBone& bone, bool with_soft) {
  const std::size_t count = VoxelBox{Vec3i(0), bone.dims}.count();
  bone.occupancy.resize(count);
  bone.hardness.resize(count);
  if (with_soft) bone.soft.resize(count);
  bone.labels.resize(count);
}

/// Calls f(box, offset of its first voxel) for each layer of voxels along k, on all cores. f must not throw.
template <class F>
void for_each_layer(const DenseBone& bone, const F& f) {
  const std::size_t layer = static_cast<std::size_t>(bone.dims.x) * static_cast<std::size_t>(bone.dims.y);
  constexpr std::size_t kLeast = 50'000;  // [voxels] for which a thread is worth starting
  for_each_number(bone.dims.z, std::max<std::size_t>(bone.occupancy.size() / kLeast, 1), [&](int k) {
    f(VoxelBox{Vec3i(0, 0, k), Vec3i(bone.dims.x, bone.dims.y, k + 1)}, static_cast<std::size_t>(k) * layer);
  });
}

/// Calls f(offset, p_bone) for each voxel, on all cores.
template <class F>
void for_each_centre(const DenseBone& bone, const F& f) {
  for_each_layer(bone, [&](const VoxelBox& layer, std::size_t at) {
    for_each_voxel(layer, [&](const Vec3i& v) { f(at++, bone.bone_from_index * Vec3(v)); });
  });
}

void fill_uniform(const Truth& truth, const PhantomSpec& spec, DenseBone& bone) {
  for_each_centre(bone, [&](std::size_t at, const Vec3& p) {
    const SurfaceDistance surface = truth.nearest(p);
    const double occupancy = ramp(surface, spec.pitch);
    bone.occupancy[at] = static_cast<float>(occupancy);
    bone.hardness[at] = occupancy > 0.0 ? static_cast<float>(spec.hardness) : 0.0f;
    bone.labels[at] = static_cast<std::uint8_t>(surface.signed_distance <= 0.0 ? VoxelLabel::bone : VoxelLabel::none);
  });
}

void fill_patch(const Truth& truth, const PhantomSpec& spec, DenseBone& bone) {
  const SkullHardness hardness(spec);
  for_each_centre(bone, [&](std::size_t at, const Vec3& p) {
    const SkullSite site = skull_site(spec, p);
    const double occupancy = ramp(truth.nearest(p), spec.pitch);
    bone.occupancy[at] = static_cast<float>(occupancy);
    bone.hardness[at] = occupancy > 0.0 ? static_cast<float>(hardness.at(p, site.depth)) : 0.0f;
    // At most 1 - occupancy: at the edge of the rim the two ramps overlap, and their sum would exceed 1.
    bone.soft[at] = static_cast<float>(std::min(1.0 - occupancy, ramp(soft_surface(spec, site), spec.pitch)));
    bone.labels[at] = static_cast<std::uint8_t>(skull_label(spec, site));
  });
}

void add_noise(const PhantomSpec& spec, DenseBone& bone) {
  const auto seed = static_cast<std::uint64_t>(spec.seed);
  const auto shaken = [&](float density, std::uint64_t stream, std::size_t at) {
    const double factor = (1.0 - spec.noise) + spec.noise * uniform11(seed ^ stream, at);
    return static_cast<float>(std::clamp(density * factor, 0.0, 1.0));
  };
  for_each_layer(bone, [&](const VoxelBox& layer, std::size_t from) {
    for (std::size_t at = from; at < from + layer.count(); ++at) {
      bone.occupancy[at] = shaken(bone.occupancy[at], kOccupancyStream, at);
      bone.hardness[at] = shaken(bone.hardness[at], kHardnessStream, at);
    }
  });
}

std::optional<Error> first_error(const PhantomSpec& spec) {
  if (spec.kind == PhantomKind::head) return Error{ErrorCode::bad_input, "a head is not a dense phantom: make_head_bone() builds it", {}};
  const Issues issues = validate(spec);
  if (issues.empty()) return std::nullopt;
  Error all = issues.front();
  for (std::size_t i = 1; i < issues.size(); ++i) all.message += "; " + issues[i].message;
  return all;
}

}  // namespace

Result<Phantom> make_phantom(const PhantomSpec& spec) {
  if (std::optional<Error> error = first_error(spec)) return *std::move(error);
  try {
    Phantom phantom{spec, Truth(spec), {}};
    DenseBone& bone = phantom.bone;
    bone.dims = phantom_dims(spec);
    bone.bone_from_index = phantom_bone_from_index(spec);
    const bool patch = spec.kind == PhantomKind::skull_patch;
    allocate(bone, patch);
    if (patch)
      fill_patch(phantom.truth, spec, bone);
    else
      fill_uniform(phantom.truth, spec, bone);
    if (spec.noise > 0.0) add_noise(spec, bone);
    return phantom;
  } catch (const std::bad_alloc&) {
    const Vec3i n = phantom_dims(spec);
    return Error{ErrorCode::unavailable,
                 fmt::format("no memory for a phantom of {} x {} x {} voxels: use a larger volume.spacing_mm", n.x, n.y, n.z),
                 {}};
  }
}

}  // namespace burrhole
