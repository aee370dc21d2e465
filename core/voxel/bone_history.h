/// core/voxel/bone_history.h: undo and named checkpoints of a bone, stored as the blocks of 8^3 voxels that changed.
///   Step      begins when the drill starts to spin and ends when it stops. At the first change of a block the step stores the values that
///             the block had at the begin of the step: 16 bytes if the block was as loaded, otherwise 2 KiB more. Changes between two steps
///             belong to the earlier one.
///   Memory    bounded. When it is full, the oldest steps are dropped and counted, the open step last. Checkpoints are never dropped.
///   Frame     index, in blocks.   Errors  bad_input, out_of_range: see the functions.
///   Thread    simulation. After create() with `preallocate`, begin_step() and end_step() allocate nothing. The other functions may
///             allocate; call them only while no other thread runs.
///   Source    own.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/voxel/voxmap.h"

namespace burrhole {

struct BoneHistoryConfig {
  std::size_t memory = std::size_t{32} << 20;  ///< [byte] upper limit of bytes(); at least kLeastHistoryMemory
  bool preallocate = false;                    ///< allocate all memory in create(), so that no step allocates; otherwise on demand
};
inline constexpr std::size_t kLeastHistoryMemory = std::size_t{256} << 10;

class BoneHistory final : public BlockKeeper {
 public:
  static constexpr std::size_t kMostSteps = 1024;
  static constexpr std::size_t kMostCheckpoints = 32;
  static constexpr std::size_t kLongestName = 64;  ///< [characters] of a checkpoint

  /// Registers itself as the keeper of `voxmap`, which must outlive the history at the same address. out_of_range: `memory` is too small.
  [[nodiscard]] static Result<std::unique_ptr<BoneHistory>> create(Voxmap& voxmap, const BoneHistoryConfig& config);
  ~BoneHistory() override;
  BoneHistory(const BoneHistory&) = delete;
  BoneHistory& operator=(const BoneHistory&) = delete;

  /// Begins a step; called when the drill starts to spin. A preceding step without changes is reused, not stored.
  void begin_step();
  /// Ends the step; called when the drill stops.
  void end_step();
  [[nodiscard]] bool step_open() const noexcept { return open_; }

  /// Restores the bone as it was at the begin of the latest step with changes, and deletes that step. Ends an open step first.
  /// @returns false if there is no such step.
  [[nodiscard]] bool undo();

  /// Stores the present bone under a name; replaces a checkpoint of the same name. bad_input: the name is empty or too long.
  /// out_of_range: too many checkpoints, or not enough memory even without any step. On an error nothing changes.
  [[nodiscard]] Status checkpoint(std::string_view name);
  /// Restores a checkpoint, as a separate step that can be undone. bad_input: no checkpoint of that name.
  [[nodiscard]] Status restore(std::string_view name);
  /// Restores the bone as loaded, with BoneModel::drilled(), as a separate step that can be undone.
  void reset();

  [[nodiscard]] std::size_t steps() const noexcept;  ///< number of steps that can be undone
  [[nodiscard]] std::size_t checkpoints() const noexcept { return checkpoints_.size(); }
  [[nodiscard]] std::uint64_t dropped_steps() const noexcept { return dropped_; }  ///< steps dropped because memory was full
  [[nodiscard]] std::size_t kept_blocks() const noexcept { return kept_.size(); }  ///< blocks in all steps
  [[nodiscard]] std::size_t bytes() const noexcept;                                ///< allocated memory, without the object

  void keep(const Vec3i& block, const BlockValues* before) override;

 private:
  struct Checkpoint {
    std::string name;
    std::vector<BlockEntry> blocks;  // sorted by key
  };
  BoneHistory(Voxmap& voxmap, std::size_t most_entries, std::size_t most_blocks);
  [[nodiscard]] bool drop_oldest() noexcept;
  [[nodiscard]] bool make_room(bool with_values) noexcept;
  void release(std::vector<BlockEntry>& blocks) noexcept;
  void bring_back(const std::vector<BlockEntry>& blocks);

  Voxmap* voxmap_;
  std::size_t most_entries_, most_blocks_;
  std::vector<BlockEntry> kept_;    // of all steps, the oldest first; sorted by key within a step
  std::vector<std::size_t> steps_;  // index in kept_ of the first block of each step
  std::vector<Checkpoint> checkpoints_;
  BlockPool pool_;
  std::uint64_t dropped_ = 0;
  bool open_ = false;
  bool undoing_ = false;  // changes are not stored
};

}  // namespace burrhole
