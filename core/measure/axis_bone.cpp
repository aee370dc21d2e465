#include "core/measure/axis_bone.h"

#include <algorithm>

#include "core/base/trilinear.h"
#include "core/contact/contact_view.h"

namespace burrhole {

std::vector<std::uint8_t> bone_on_axis(const Approach& approach, const Voxmap& voxmap) {
  std::vector<std::uint8_t> out;
  std::vector<float> density(8);
  for (const Vec3& index : approach.axis_index) {
    const Vec3i base = floor_int(index);
    const VoxelBox cell{base, base + 2};
    voxmap.read_density(cell, density);
    out.push_back(trilinear(cell, density.data(), index) < kSurfaceLevel ? 0 : 1);
  }
  return out;
}

AxisBone::AxisBone(const Approach& approach) : approach_(&approach) {
  now_.bone.assign(approach.axis_index.size(), 1);
  for (AxisSamples& slot : buffer_.slots()) slot = now_;
}

void AxisBone::publish(const Voxmap& voxmap) noexcept {
  const MasterWindow& window = voxmap.window();
  for (std::size_t n = 0; n < now_.bone.size(); ++n) {
    const Vec3& index = approach_->axis_index[n];
    const Vec3i base = floor_int(index);
    if (!window.box.contains(base) || !window.box.contains(base + 1)) continue;
    now_.bone[n] = trilinear(window.box, window.density.data(), index) < kSurfaceLevel ? 0 : 1;
  }
  publish_now();
}

void AxisBone::set(std::span<const std::uint8_t> bone) noexcept {
  std::ranges::copy(bone, now_.bone.begin());
  publish_now();
}

void AxisBone::publish_now() noexcept {
  ++now_.number;
  AxisSamples& slot = buffer_.back();
  std::ranges::copy(now_.bone, slot.bone.begin());
  slot.number = now_.number;
  buffer_.publish();
}

}  // namespace burrhole
