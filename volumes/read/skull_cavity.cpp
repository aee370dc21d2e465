#include "volumes/read/skull_cavity.h"

#include <algorithm>
#include <array>

#include "core/base/bounds.h"

namespace burrhole {
namespace {

/// Visits all voxels of a box so that each comes after its neighbour in the direction `step`.
template <class F>
void for_each_after(const VoxelBox& box, const Vec3i& step, const F& f) {
  const Vec3i size = box.size();
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i)
        f(Vec3i(step.x > 0 ? size.x - 1 - i : i, step.y > 0 ? size.y - 1 - j : j, step.z > 0 ? size.z - 1 - k : k));
}

/// The faces of the grid that have bone in their outermost two layers: bone is cut there. Order: -x, +x, -y, +y, -z, +z.
std::array<bool, 6> cut_faces(const VoxelBox& all, const std::vector<std::uint8_t>& state, std::uint8_t bone) {
  constexpr int kLayers = 2;
  std::array<bool, 6> out{};
  for_each_voxel(all, [&](const Vec3i& v) {
    if ((state[all.offset_of(v)] & bone) == 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (v[axis] < kLayers) out[2 * axis] = true;
      if (v[axis] >= all.hi[axis] - kLayers) out[2 * axis + 1] = true;
    }
  });
  return out;
}

/// Takes the mark of bone off all cubes but those of the connected part, neighbours across corners included, with the most voxels of bone.
void keep_largest_bone(const VoxelBox& all, const std::vector<std::int32_t>& voxels, std::uint8_t bone, std::vector<std::uint8_t>& state) {
  std::vector<std::int32_t> part(state.size(), 0);
  std::vector<std::int64_t> sums{0};  // [voxels] of each part; 0: no part
  std::vector<Vec3i> open;
  const auto enter = [&](const Vec3i& v) {
    const std::size_t n = all.offset_of(v);
    if ((state[n] & bone) == 0 || part[n] != 0) return;
    part[n] = static_cast<std::int32_t>(sums.size()) - 1;
    sums.back() += voxels[n];
    open.push_back(v);
  };
  for_each_voxel(all, [&](const Vec3i& start) {
    if ((state[all.offset_of(start)] & bone) == 0 || part[all.offset_of(start)] != 0) return;
    sums.push_back(0);
    enter(start);
    while (!open.empty()) {
      const Vec3i v = open.back();
      open.pop_back();
      for_each_voxel(VoxelBox{v - 1, v + 2}.intersect(all), enter);
    }
  });
  const auto largest = std::ranges::max_element(sums) - sums.begin();
  for (std::size_t n = 0; n < state.size(); ++n)
    if (part[n] != largest) state[n] &= static_cast<std::uint8_t>(~bone);
}

}  // namespace

void SkullCavity::sort_voxels(const Scan& scan, const TissueLevels& levels) {
  const auto [lo, hi] = bounds_under(scan.bone_from_index, {Vec3(0.0), Vec3(scan.dims - 1)});
  cube_ = std::max(kCube, 1.01 * scan.bone_from_index.longest_edge());
  origin_ = lo;
  dims_ = floor_int((hi - lo) / cube_ + 0.5) + 1;
  const VoxelBox all = bounds(), voxels{Vec3i(0), scan.dims};
  state_.assign(all.count(), 0);
  std::vector<std::int32_t> air(all.count()), bone(all.count()), count(all.count());
  for_each_voxel(voxels, [&](const Vec3i& v) {
    const Vec3i cube = glm::clamp(floor_int((scan.bone_from_index * Vec3(v) - origin_) / cube_ + 0.5), Vec3i(0), dims_ - 1);
    const std::size_t n = all.offset_of(cube);
    const auto value = static_cast<double>(scan.values[voxels.offset_of(v)]);
    if (value >= levels.bone) {
      state_[n] |= kBone;
      ++bone[n];
    }
    air[n] += value < levels.air ? 1 : 0;
    ++count[n];
  });
  for (std::size_t n = 0; n < state_.size(); ++n)
    if (2 * air[n] > count[n] || count[n] == 0) state_[n] |= kAir;
  keep_largest_bone(all, bone, kBone, state_);
}

void SkullCavity::find_enclosed() {
  const VoxelBox all = bounds();
  const std::array<bool, 6> cut = cut_faces(all, state_, kBone);
  enum : std::uint8_t { kMiss, kHit, kUnknown };
  std::vector<std::uint8_t> hits(state_.size()), counted(state_.size()), seen(state_.size());
  for_each_voxel({Vec3i(-1), Vec3i(2)}, [&](const Vec3i& step) {
    if (step == Vec3i(0)) return;
    for_each_after(all, step, [&](const Vec3i& v) {
      const std::size_t n = all.offset_of(v);
      const Vec3i next = v + step;
      if (all.contains(next)) {
        const std::size_t m = all.offset_of(next);
        seen[n] = (state_[m] & kBone) != 0 ? std::uint8_t{kHit} : seen[m];
      } else {
        seen[n] = kMiss;
        for (std::size_t axis = 0; axis < 3; ++axis)
          if ((next[axis] < 0 && cut[2 * axis]) || (next[axis] >= dims_[axis] && cut[2 * axis + 1])) seen[n] = kUnknown;
      }
      if (seen[n] == kHit) ++hits[n];
      if (seen[n] != kUnknown) ++counted[n];
    });
  });
  constexpr int kLeastCounted = 9;  // of 26
  for (std::size_t n = 0; n < state_.size(); ++n)
    if ((state_[n] & kBone) == 0 && counted[n] >= kLeastCounted && hits[n] >= kLeastShare * counted[n]) state_[n] |= kEnclosed;
}

void SkullCavity::take_largest() {
  const VoxelBox all = bounds();
  std::vector<std::int32_t> part(state_.size(), 0);
  std::vector<Vec3i> open;
  std::int32_t parts = 0, best = 0;
  std::size_t most = 0;
  const std::array<Vec3i, 6> steps{Vec3i(1, 0, 0), Vec3i(-1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, -1, 0), Vec3i(0, 0, 1), Vec3i(0, 0, -1)};
  for_each_voxel(all, [&](const Vec3i& start) {
    const std::size_t first = all.offset_of(start);
    if ((state_[first] & kEnclosed) == 0 || part[first] != 0) return;
    const std::uint8_t kind = state_[first];
    std::size_t count = 0;
    part[first] = ++parts;
    open.assign(1, start);
    while (!open.empty()) {
      const Vec3i v = open.back();
      open.pop_back();
      ++count;
      for (const Vec3i& step : steps) {
        if (!all.contains(v + step)) continue;
        const std::size_t n = all.offset_of(v + step);
        if (state_[n] != kind || part[n] != 0) continue;
        part[n] = parts;
        open.push_back(v + step);
      }
    }
    if (count <= most) return;
    most = count;
    best = parts;
  });
  if (static_cast<double>(most) * cube_ * cube_ * cube_ < kLeastVolume) return;
  for (std::size_t n = 0; n < state_.size(); ++n)
    if (part[n] == best) state_[n] |= kCavity;
  cubes_ = most;
}

SkullCavity SkullCavity::find(const Scan& scan, const TissueLevels& levels) {
  SkullCavity out;
  out.sort_voxels(scan, levels);
  out.find_enclosed();
  out.take_largest();
  return out;
}

bool SkullCavity::holds(const Vec3& p_bone) const noexcept {
  const Vec3i v = floor_int((p_bone - origin_) / cube_ + 0.5);
  return bounds().contains(v) && (state_[bounds().offset_of(v)] & kCavity) != 0;
}

}  // namespace burrhole
