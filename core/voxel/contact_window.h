/// core/voxel/contact_window.h: the published copy of the window that contact reads: density and gradient, never half a step.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/snapshot_buffer.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Dense fields over `box`, i fastest; gradient valid inside box.grown(-1).
struct ContactWindow {
  VoxelBox box;
  std::vector<float> density;
  std::vector<Vec3f> gradient;
  std::uint64_t window_epoch = 0;
  std::uint64_t growth_epoch = 0;
};

/// Writer's side: keeps three copies, each with the boxes that it missed; publishing catches one up and swaps an index.
/// Thread: publish() by the simulation; exchange().latest() by contact.
class ContactWindowPublisher {
 public:
  /// `voxmap` must have its window placed; registers itself as a listener.
  explicit ContactWindowPublisher(Voxmap& voxmap) : listener_(voxmap.add_listener()) {}

  void publish(Voxmap& voxmap) {
    for (const VoxelBox& box : voxmap.take_dirty(listener_))
      for (DirtyBoxes& missed : missed_) missed.add(box);
    const std::size_t slot = buffer_.back_index();
    catch_up(buffer_.back(), missed_[slot], voxmap);
    missed_[slot].clear();
    buffer_.publish();
  }
  [[nodiscard]] SnapshotBuffer<ContactWindow>& exchange() noexcept { return buffer_; }
  /// Window epoch of the newest copy handed over.
  [[nodiscard]] std::uint64_t published_epoch() const noexcept { return published_epoch_; }
  [[nodiscard]] std::uint64_t copied_voxels() const noexcept { return copied_voxels_; }

 private:
  void catch_up(ContactWindow& copy, const DirtyBoxes& missed, const Voxmap& voxmap) {
    const MasterWindow& master = voxmap.window();
    if (copy.window_epoch != voxmap.window_epoch()) {
      copy.box = master.box;
      copy.density = master.density;
      copy.gradient = master.gradient;
      copied_voxels_ += master.box.count();
    } else {
      for (const VoxelBox& dirty : missed.boxes()) {
        const VoxelBox part = dirty.intersect(master.box);
        if (part.empty()) continue;
        copied_voxels_ += part.count();
        const auto row = static_cast<std::size_t>(part.size().x);
        for (int k = part.lo.z; k < part.hi.z; ++k)
          for (int j = part.lo.y; j < part.hi.y; ++j) {
            const std::size_t at = master.box.offset_of({part.lo.x, j, k});
            std::copy_n(master.density.data() + at, row, copy.density.data() + at);
            std::copy_n(master.gradient.data() + at, row, copy.gradient.data() + at);
          }
      }
    }
    copy.window_epoch = published_epoch_ = voxmap.window_epoch();
    copy.growth_epoch = voxmap.growth_epoch();
  }

  std::size_t listener_;
  SnapshotBuffer<ContactWindow> buffer_;
  std::array<DirtyBoxes, 3> missed_;
  std::uint64_t published_epoch_ = 0;
  std::uint64_t copied_voxels_ = 0;
};

}  // namespace burrhole
