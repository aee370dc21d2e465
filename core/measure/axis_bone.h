/// core/measure/axis_bone.h: which samples of the approach axis are bone now, published to the drill monitor of a scene in which nothing
///   else reads a copy of bone.
///   Frame  index.   Errors  none.   Thread  publish(): simulation; exchange().latest(): contact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/snapshot_buffer.h"
#include "core/measure/approach.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// State of the samples of Approach::axis_index.
struct AxisSamples {
  std::vector<std::uint8_t> bone;  ///< 1: the density at the sample is 0.5 or more
  std::uint64_t number = 0;        ///< of the publication, from 1
};

/// @returns for each sample of the axis 1 where the present density is 0.5 or more; reads the whole bone, not only the window.
[[nodiscard]] std::vector<std::uint8_t> bone_on_axis(const Approach& approach, const Voxmap& voxmap);

class AxisBone {
 public:
  /// `approach` must outlive it. Before the first publication every sample is bone, as loaded.
  explicit AxisBone(const Approach& approach);

  /// Samples the axis where the master window holds it; elsewhere the last known state remains. Allocates nothing.
  void publish(const Voxmap& voxmap) noexcept;
  /// Replaces the known state, where bone may have grown outside the window. Call it while no clock runs.
  void set(std::span<const std::uint8_t> bone) noexcept;
  [[nodiscard]] SnapshotBuffer<AxisSamples>& exchange() noexcept { return buffer_; }

 private:
  void publish_now() noexcept;
  const Approach* approach_;
  AxisSamples now_;
  SnapshotBuffer<AxisSamples> buffer_;
};

}  // namespace burrhole
