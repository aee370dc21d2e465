/// tests/core/contact/true_records.h: surface records filled from a phantom's closed form: what contact does with perfect records.
#pragma once

#include "contact_support.h"
#include "core/contact/constrained_tool.h"

namespace burrhole::contact_test {

class TrueRecords {
 public:
  /// Over the phantom's grid and `margin` voxels round it.
  explicit TrueRecords(const Phantom& phantom, const Pose& world_from_bone = {}, int margin = 12)
      : box_(VoxelBox{Vec3i(0), phantom.bone.dims}.grown(margin)), map_(phantom.bone.bone_from_index), world_from_bone_(world_from_bone) {
    const double edge = map_.mean_edge();
    for_each_voxel(box_, [&](const Vec3i& v) {
      const SurfaceDistance near = phantom.truth.nearest(map_ * Vec3(v));
      const double distance = near.signed_distance / edge;
      const bool inside_band = std::abs(distance) < kRecordBand;
      const auto stored = [](double value) { return static_cast<std::int16_t>(std::lround(value)); };
      const Vec3 normal = inside_band ? near.normal / kRecord16Normal : Vec3(0.0);
      records_.push_back({stored(std::clamp(distance, -kRecordBand, kRecordBand) / kRecord16Distance), stored(normal.x), stored(normal.y),
                          stored(normal.z)});
    });
  }
  [[nodiscard]] SurfaceView view() const { return {{box_, box_, nullptr, records_.data(), map_}, nullptr, world_from_bone_}; }
  void move_bone(const Pose& world_from_bone) { world_from_bone_ = world_from_bone; }

 private:
  VoxelBox box_;
  Affine map_;
  Pose world_from_bone_;
  std::vector<Record16> records_;
};

}  // namespace burrhole::contact_test
