/// tests/volumes/write/drilled_ball.h: a ball of bone with a straight hole, as a voxmap: what the writers are given. Its surface has a closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/base/geometry.h"
#include "core/voxel/voxmap.h"
#include "volumes/export_bone.h"

namespace burrhole::test {

inline constexpr double kEdge = 0.5e-3;              ///< [m] of a voxel
inline constexpr double kBallRadius = 20.0 * kEdge;  ///< [m]
inline constexpr double kHoleRadius = 10.0 * kEdge;  ///< [m] along k, through the centre
inline const Vec3i kBallDims{51, 50, 53};            ///< no multiple of a block
inline const Vec3 kBallCentre{25.3, 24.6, 26.2};     ///< [voxels]

/// Turned about two axes and far from the origin, as an oblique scan lies; its columns are at right angles.
inline Affine oblique_map() {
  const Quat turn = glm::angleAxis(0.3, Vec3(0, 0, 1)) * glm::angleAxis(-0.7, Vec3(1, 0, 0));
  return {glm::mat3_cast(turn) * kEdge, Vec3(-0.0731, 0.1207, 0.7983)};
}
/// Sheared like a tilted gantry, and left-handed.
inline Affine sheared_map() {
  return {Mat3(Vec3(kEdge, 0, 0), Vec3(0, -kEdge, 0.1e-3), Vec3(0, 0.13e-3, 1.25 * kEdge)), Vec3(0.01, -0.02, 0.03)};
}

/// The ramps are four voxels wide, so that no edge of a cell that meets a surface has an end that is clamped.
inline float ramp(double inside_voxels) { return static_cast<float>(std::clamp(0.5 + inside_voxels / 4.0, 0.0, 1.0)); }

inline DenseBone ball_of_bone(const Affine& bone_from_index) {
  DenseBone out;
  out.dims = kBallDims;
  out.bone_from_index = bone_from_index;
  for_each_voxel({Vec3i(0), out.dims}, [&](const Vec3i& v) {
    const double inside = kBallRadius / kEdge - glm::length(Vec3(v) - kBallCentre);
    const float occupancy = ramp(inside);
    out.occupancy.push_back(occupancy);
    out.hardness.push_back(occupancy > 0.0f ? 0.3f + 0.001f * static_cast<float>((v.x * 7 + v.y * 13 + v.z * 29) % 500) : 0.0f);
    const VoxelLabel label = inside > 10.0  ? VoxelLabel::brain
                             : inside > 6.0 ? VoxelLabel::inner_table
                             : inside > 3.0 ? VoxelLabel::diploe
                             : inside > 0.0 ? VoxelLabel::outer_table
                                            : VoxelLabel::none;
    out.labels.push_back(static_cast<std::uint8_t>(label));
  });
  return out;
}

/// @returns the ball, with the hole or without.
inline Voxmap ball_voxmap(const Affine& bone_from_index, bool drilled) {
  auto out = Voxmap::create(BoneModel::create(ball_of_bone(bone_from_index)).value(), {}).value();
  if (!drilled) return out;
  std::vector<std::unique_ptr<BlockValues>> values;
  std::vector<BlockChange> changes;
  for_each_voxel(blocks_of(VoxelBox{Vec3i(0), kBallDims}), [&](const Vec3i& block) {
    auto& left = *values.emplace_back(std::make_unique<BlockValues>());
    std::size_t n = 0;
    for_each_voxel(box_of_block(block), [&](const Vec3i& v) {
      const Vec3 from_axis = Vec3(v) - kBallCentre;
      left[n++] = ramp(std::hypot(from_axis.x, from_axis.y) - kHoleRadius / kEdge);
    });
    changes.push_back({block, &left});
  });
  out.put_blocks(changes);
  return out;
}

/// Volumes in voxels.
inline double ball_volume() { return 4.0 / 3.0 * std::numbers::pi * std::pow(kBallRadius / kEdge, 3); }
/// What a hole through the centre takes: the ball without the ring that is left, whose volume is that of a ball of half its height.
inline double hole_volume() {
  const double half_height2 = (kBallRadius * kBallRadius - kHoleRadius * kHoleRadius) / (kEdge * kEdge);
  return ball_volume() - 4.0 / 3.0 * std::numbers::pi * std::pow(half_height2, 1.5);
}

inline std::vector<float> field_of(const Voxmap& bone, ExportField field, bool undrilled, const VoxelBox& box) {
  std::vector<float> out(box.count());
  read_field(bone, field, undrilled, box, out);
  return out;
}

}  // namespace burrhole::test
