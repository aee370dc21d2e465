/// core/voxel/bone_prefetch.h: bone as loaded in a shell round the window, read from OpenVDB before the window slides there.
///   Threads  the owner of the window calls aim(), copy() and copy_labels(): wait-free, without allocation. One other thread of normal
///            priority calls fill(). The bone as loaded is constant, so a block that was read remains valid.
///   Frame    index; blocks as in block_store.h.   Source  own.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/triple_buffer.h"
#include "core/voxel/block_store.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

class BonePrefetch {
 public:
  /// [voxels] thickness of the shell that is read ahead on each side of the window; twice this on the sides of the latest motion.
  static constexpr int kAhead = 8;

  /// @param bone must outlive the prefetch. @param with_labels reads labels too, for a contact model that scales stiffness by label.
  explicit BonePrefetch(const BoneModel& bone, bool with_labels = false);
  ~BonePrefetch();
  BonePrefetch(const BonePrefetch&) = delete;
  BonePrefetch& operator=(const BonePrefetch&) = delete;

  /// Owner: sets the present box of the window.
  void aim(const VoxelBox& window) noexcept;
  /// Owner: copies occupancy and hardness of `part`, which must lie in one block, into dense arrays over `to`. If the block was not read
  /// ahead, copies nothing, counts a miss and @returns false.
  [[nodiscard]] bool copy(const VoxelBox& part, const VoxelBox& to, float* occupancy, float* hardness) noexcept;
  /// Owner: the same for labels, as numbers.
  [[nodiscard]] bool copy_labels(const VoxelBox& part, const VoxelBox& to, float* labels) noexcept;

  /// Other thread: reads up to `most` missing blocks of the shell. @returns the number of blocks read; 0: none is missing.
  std::size_t fill(std::size_t most);

  [[nodiscard]] std::uint64_t hits() const noexcept { return hits_.load(std::memory_order_relaxed); }      ///< blocks
  [[nodiscard]] std::uint64_t misses() const noexcept { return misses_.load(std::memory_order_relaxed); }  ///< blocks
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_.load(std::memory_order_relaxed); }

 private:
  struct Loaded {
    BlockValues occupancy, hardness;
    std::array<std::uint8_t, kBlockVoxels> labels;
  };
  /// fill() sets empty and ready; the owner sets reading while it copies. Neither changes a slot that the other uses.
  enum class State : std::uint8_t { empty, ready, reading };
  struct Slot {
    std::atomic<std::uint64_t> key{0};
    std::atomic<State> state{State::empty};
    std::unique_ptr<Loaded> loaded;
  };
  struct Aim {
    VoxelBox window;
    Vec3i moved{0};
    std::uint64_t number = 0;
  };
  static constexpr std::size_t kWays = 4, kSets = 1 << 13;

  [[nodiscard]] Slot* set_of(std::uint64_t key) noexcept;
  template <class F>
  [[nodiscard]] bool read_slot(const Vec3i& block, F&& f) noexcept;
  [[nodiscard]] bool wanted(const Vec3i& block) const noexcept;
  void follow(const Aim& aim);
  [[nodiscard]] bool present(std::uint64_t key) noexcept;
  void load(const Vec3i& block);

  const BoneModel* bone_;
  bool with_labels_;
  std::vector<Slot> slots_;
  TripleBuffer<Aim> aim_;
  Aim last_aim_;  // used by the owner only
  std::atomic<std::uint64_t> hits_{0}, misses_{0};

  // Used by the thread that calls fill().
  VoxelBox shell_, known_;                      // [voxels] a block is read if it intersects shell_ and is not inside known_
  std::uint64_t followed_ = 0;                  // number of the aim
  std::vector<Vec3i> missing_;                  // blocks that are still to be read
  std::vector<std::size_t> filled_;             // slots that hold a block
  std::vector<std::unique_ptr<Loaded>> spare_;  // of blocks that were dropped
  std::vector<float> labels_read_;              // scratch
  std::atomic<std::size_t> bytes_{0};
};

}  // namespace burrhole
