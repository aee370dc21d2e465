/// app/scene/memory_plan.h: predicts the largest resident memory of a run, import and drawing included, from headers and tables alone.
///   Frame  bone frame.   Units  bytes.   Errors  none.   Thread  any.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/scene/scene.h"
#include "app/stage/effect.h"

namespace burrhole {

struct MemoryItem {
  std::string name;         ///< "program", "volume", or the table of an effect
  std::uint64_t bytes = 0;  ///< [bytes]
};

struct MemoryPlan {
  std::vector<MemoryItem> items;  ///< of the run, in the order of the effects
  std::uint64_t import = 0;       ///< [bytes] needed while bone is made, besides the bone: the scan, slabs; released before the run
  std::uint64_t peak = 0;         ///< [bytes] largest resident memory of the process: of the run, of its start, or of the import

  /// @returns "412 MB: program 55, volume 36, ..." with all items [MB].
  [[nodiscard]] std::string text() const;
};

/// What a run needs beyond a run in lockstep without inputs.
struct MemoryRun {
  bool live = false;                    ///< on threads: larger windows, bone read in advance, rows on their way to the session
  bool locked = false;                  ///< live: pages of libraries and stacks are locked in memory too; see may_lock_memory()
  bool inputs = false;                  ///< a history for undo and checkpoints
  std::vector<const Tool*> tools = {};  ///< that inputs change to; not owned
};

/// @returns the voxels of the master window at the entry, under the scene's thrust.
[[nodiscard]] std::uint64_t window_voxels(const Scene& scene, const Needs& needs, const Tool& tool, const Affine& bone_from_index);
/// @returns the bytes of the bone model and the master window.
[[nodiscard]] std::uint64_t volume_bytes(const BoneShape& bone, std::uint64_t window_voxels) noexcept;
/// @returns the bytes of the copies of bone that the contact clock reads; 0 if nothing reads one.
[[nodiscard]] std::uint64_t publish_bytes(const PlanContext& context) noexcept;
/// @returns an upper bound of a bone model's bytes, if every voxel differs from its neighbours. @param soft whether there may be soft tissue.
[[nodiscard]] std::uint64_t dense_bone_bytes(const Vec3i& dims, bool soft) noexcept;

/// @returns the bytes of the dense fields from which the bone of a phantom is made.
[[nodiscard]] std::uint64_t dense_fields_bytes(const Vec3i& dims) noexcept;

/// @returns the memory of a tool's points and meshes; its cutting field belongs to erosion.
[[nodiscard]] std::uint64_t tool_bytes(const Tool& tool) noexcept;

/// @param import [bytes] see MemoryPlan.
[[nodiscard]] MemoryPlan plan_memory(const Scene& scene, const Tool& tool, const BoneShape& bone, std::uint64_t import,
                                     const MemoryRun& run = {});

}  // namespace burrhole
