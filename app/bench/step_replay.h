/// app/bench/step_replay.h: repeats recorded bone steps on a copy of their bone: sub-voxel removal, commit, publishing of what contact reads.
///   The first kWarmUp inputs bring memory and caches to their steady state and are neither timed nor counted. The window stays where it
///   holds all steps.
///   Frame  index.   Units  SI.   Thread  main.   Errors  those of copy_of_bone() and Erosion::create().
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/bench/step_recorder.h"
#include "core/drill/erosion.h"
#include "core/voxel/contact_window.h"

namespace burrhole {

/// CPU time of the parts of one or more steps.
struct StepTimes {
  double removal = 0.0, commit = 0.0, publishing = 0.0;  ///< [s]
};

/// What one step changes, and the bytes that it has to move.
struct StepCounts {
  VoxelBox box;                  ///< tight, of the voxels whose remaining changes
  std::size_t voxels = 0;        ///< whose remaining changes
  std::size_t nodes = 0;         ///< of the cut surface, that change
  std::size_t records = 0;       ///< that change
  std::size_t committed = 0;     ///< voxels of the boxes passed to commit()
  std::size_t copied = 0;        ///< voxels copied to the snapshot
  std::size_t copied_bytes = 0;  ///< of those voxels
  [[nodiscard]] std::size_t bytes_read() const noexcept;
  [[nodiscard]] std::size_t bytes_written() const noexcept;
};

class StepReplay {
 public:
  static constexpr std::size_t kWarmUp = 4;  ///< inputs

  /// @param recorded must outlive the replay.
  [[nodiscard]] static Result<StepReplay> create(RecordedSteps& recorded);

  /// Restores the bone before the first step and runs the warm-up.
  [[nodiscard]] Status begin();
  /// The inputs after the warm-up.
  [[nodiscard]] std::span<const StepInput> inputs() const noexcept { return std::span(recorded_->inputs).subspan(kWarmUp); }
  /// Runs one step and adds its times.
  void run(const StepInput& input, StepTimes& times);
  /// Runs one step and counts what it changes; slow.
  [[nodiscard]] StepCounts count(const StepInput& input);

  [[nodiscard]] const Voxmap& bone() const noexcept { return *bone_; }
  /// @returns hashes of `remaining` over the window, and of density and records of the newest snapshot.
  [[nodiscard]] std::vector<std::uint64_t> hashes();

 private:
  explicit StepReplay(RecordedSteps& recorded) : recorded_(&recorded) {}
  ErosionOutcome erode(const StepInput& input);
  /// Publishes, and takes the copy as a reader at full rate does.
  const ContactWindow& publish();

  RecordedSteps* recorded_;
  std::optional<Voxmap> bone_;
  std::optional<Erosion> erosion_;
  std::unique_ptr<ContactWindowPublisher> publisher_;
  std::size_t committed_ = 0;  // voxels, in the last step
};

}  // namespace burrhole
