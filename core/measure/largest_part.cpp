#include "core/measure/largest_part.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/contact/contact_view.h"

namespace burrhole {
namespace {

constexpr double kCube = 1.5e-3;  // [m] less than a scalp that is pressed flat on a headrest
constexpr std::uint8_t kEmpty = 0, kBone = 1, kSeen = 2, kLargest = 3;

Vec3i place_of(const VoxelBox& box, std::size_t n) {
  const auto width = static_cast<std::size_t>(box.hi.x), rows = static_cast<std::size_t>(box.hi.y);
  return {static_cast<int>(n % width), static_cast<int>(n / width % rows), static_cast<int>(n / (width * rows))};
}

Vec3i cube_of(const Vec3i& voxel, const Vec3i& edge) { return floor_int(Vec3(voxel) / Vec3(edge)); }

template <class F>
void for_each_bone_voxel(const BoneModel& bone, F f) {
  std::vector<float> occupancy;
  bone.for_each_region([&](const VoxelBox& region) {
    const VoxelBox inside = region.intersect(bone.bounds());
    occupancy.resize(inside.count());
    bone.read_occupancy(inside, occupancy);
    for_each_voxel(inside, [&](const Vec3i& v) {
      if (occupancy[inside.offset_of(v)] >= kSurfaceLevel) f(v);
    });
  });
}

}  // namespace

LargestPart::LargestPart(const BoneModel& bone) {
  for (std::size_t c = 0; c < 3; ++c)
    cube_[c] = std::max(1, static_cast<int>(std::lround(kCube / glm::length(bone.bone_from_index().linear[c]))));
  cubes_ = {Vec3i(0), (bone.dims() + cube_ - 1) / cube_};
  state_.assign(cubes_.count(), kEmpty);
  mark_bone(bone);
  std::vector<std::size_t> largest;
  for (std::size_t n = 0; n < state_.size(); ++n) {
    if (state_[n] != kBone) continue;
    std::vector<std::size_t> part = take_part(n);
    if (part.size() > largest.size()) largest = std::move(part);
  }
  for (const std::size_t n : largest) {
    state_[n] = kLargest;
    const Vec3i cube = place_of(cubes_, n);
    box_ = box_.unite({cube * cube_, glm::min((cube + 1) * cube_, bone.dims())});
  }
}

void LargestPart::mark_bone(const BoneModel& bone) {
  for_each_bone_voxel(bone, [&](const Vec3i& v) { state_[cubes_.offset_of(cube_of(v, cube_))] = kBone; });
}

LargestPart::Extent LargestPart::extent(const BoneModel& bone) const {
  Extent out;
  for_each_bone_voxel(bone, [&](const Vec3i& v) {
    if (state_[cubes_.offset_of(cube_of(v, cube_))] != kLargest) return;
    out.box.include(v);
    ++out.voxels;
  });
  return out;
}

std::vector<std::size_t> LargestPart::take_part(std::size_t first) {
  std::vector<std::size_t> part{first};
  state_[first] = kSeen;
  for (std::size_t next = 0; next < part.size(); ++next) {
    const Vec3i at = place_of(cubes_, part[next]);
    for (std::size_t c = 0; c < 3; ++c)
      for (const int step : {-1, 1}) {
        Vec3i beside = at;
        beside[c] += step;
        if (!cubes_.contains(beside)) continue;
        const std::size_t n = cubes_.offset_of(beside);
        if (state_[n] != kBone) continue;
        state_[n] = kSeen;
        part.push_back(n);
      }
  }
  return part;
}

bool LargestPart::is_near(const Vec3& index) const noexcept {
  const Vec3i cube = cube_of(voxel_of(index), cube_);
  bool found = false;
  for_each_voxel(VoxelBox{cube - 1, cube + 2}.intersect(cubes_),
                 [&](const Vec3i& c) { found = found || state_[cubes_.offset_of(c)] == kLargest; });
  return found;
}

}  // namespace burrhole
