/// core/voxel/voxmap.h: present state of the bone. Inside its box, the master window is authoritative. Outside, blocks of 8^3 voxels store
/// `remaining` where it differs from the bone as loaded. The window is written back to the blocks when it slides, at checkpoints and on
/// save. OpenVDB stores the bone as loaded and is the file format.
///   Frame   index.   Units  remaining [-]: 1 as loaded .. 0 removed; density [-] = occupancy x remaining.
///   Errors  out_of_range, bad_input.   Thread  one writer, the simulation.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/box_list.h"
#include "core/base/geometry.h"
#include "core/base/hash.h"
#include "core/base/result.h"
#include "core/voxel/block_store.h"
#include "core/voxel/bone_model.h"
#include "core/voxel/bone_prefetch.h"
#include "core/voxel/cut_surface.h"
#include "core/voxel/window_size.h"

namespace burrhole {

struct VoxmapConfig {
  float gradient_dead_zone = 0.08f;  ///< [1/voxel] shorter gradients of the density are zero
};

/// Dense fields over `box`, i fastest. Gradients are not stored: readers compute them from the density in the form that they need (packed
/// words, floats of a published copy, texels). Gradients are defined inside valid_box(). Erosion may write inside erodible_box() only, so
/// every gradient that it changes is in the window.
struct MasterWindow {
  VoxelBox box;
  std::vector<float> occupancy, hardness, remaining, density;  ///< [-] 0..1
  float gradient_dead_zone = 0.0f;                             ///< [1/voxel] as VoxmapConfig

  [[nodiscard]] VoxelBox valid_box() const noexcept { return box.grown(-1); }
  [[nodiscard]] VoxelBox erodible_box() const noexcept { return box.grown(-2); }
  [[nodiscard]] std::size_t bytes() const noexcept { return 4 * sizeof(float) * box.count(); }
};

/// Computes float gradients [1/voxel] of `part` from the window's density, into an array over window.box; zero in the outermost layer,
/// where they are undefined.
void derive_gradient(const MasterWindow& window, const VoxelBox& part, std::span<Vec3f> gradient) noexcept;

/// Receives each block of the store before it changes. Undo stores these blocks.
class BlockKeeper {
 public:
  virtual ~BlockKeeper() = default;
  /// @param before values before the change; null: the block was as loaded.
  virtual void keep(const Vec3i& block, const BlockValues* before) = 0;
};

/// A block and its new values of `remaining`; null: as loaded.
struct BlockChange {
  Vec3i block{0};  ///< [-] block coordinates, unit of 8 voxels
  const BlockValues* values = nullptr;
};

/// Contents of a saved file: bone as loaded and its present state; or the blocks that differ from as loaded alone.
enum class SavedBone { whole, changes };

class Voxmap {
 public:
  [[nodiscard]] static Result<Voxmap> create(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config);

  [[nodiscard]] const BoneModel& bone() const noexcept { return *bone_; }
  [[nodiscard]] const VoxmapConfig& config() const noexcept { return config_; }
  [[nodiscard]] const MasterWindow& window() const noexcept { return window_; }

  /// Moves the window: writes the old window back, keeps the values of the intersection and loads the others. out_of_range:
  /// !fits_window(). unavailable: a read of a paged bone has failed, now or before.
  [[nodiscard]] Status place_window(const VoxelBox& box);

  /// Slides read blocks from `prefetch` if it holds them, otherwise from OpenVDB. Null: always from OpenVDB. The values are the same.
  void set_prefetch(BonePrefetch* prefetch) noexcept;
  /// Reserves memory for windows of up to `window_voxels` and for `blocks` changed blocks. Up to these limits, sliding and writing back
  /// allocate nothing.
  void reserve(std::size_t window_voxels, std::size_t blocks);

  /// The surface where tools have cut at sub-voxel resolution; empty if none has. Dropped when bone grows.
  [[nodiscard]] const CutSurface& cut() const noexcept { return cut_; }
  /// For erosion: every change of bone from the first node on must be written to it.
  [[nodiscard]] CutSurface& cut() noexcept { return cut_; }
  /// @returns `remaining` of the window, 0..1, for erosion. After writing, call commit() for each changed box (inside erodible_box()).
  [[nodiscard]] std::span<float> remaining() noexcept { return window_.remaining; }
  /// Recomputes density in the box. Marks the box dirty for every listener, with a halo of one voxel in which gradients change.
  void commit(const VoxelBox& touched) noexcept;
  /// The same for each box.
  void commit(const VoxelBoxes& touched) noexcept {
    for (const VoxelBox& box : touched) commit(box);
  }

  /// Registers a listener. take_dirty() returns the boxes in which density or gradient may have changed since its last call.
  [[nodiscard]] std::size_t add_listener();
  [[nodiscard]] VoxelBoxes take_dirty(std::size_t listener);

  /// Incremented when bone may have been added (restore, undo). Caches that assume that bone is only removed must be cleared.
  [[nodiscard]] std::uint64_t growth_epoch() const noexcept { return growth_epoch_; }
  /// Incremented when the window moved or was reloaded. Copies must follow.
  [[nodiscard]] std::uint64_t window_epoch() const noexcept { return window_epoch_; }

  /// Updates the blocks from the window: those that were committed since the last call and differ.
  void write_back();
  /// Replaces blocks, also in the window. Marks the blocks that differ dirty for every listener and increments both epochs. Values in 0..1;
  /// they may belong to the keeper.
  void put_blocks(std::span<const BlockChange> changes);
  /// @returns the blocks that differ from the bone as loaded; up to date after write_back().
  [[nodiscard]] const BlockStore& blocks() const noexcept { return blocks_; }
  /// @returns true: no voxel of the box was changed. false: one may have been, as in the window.
  [[nodiscard]] bool is_as_loaded(const VoxelBox& box) const;
  /// Sets the keeper that receives every block before it changes; null: none. Changes not yet written back are reported to the new keeper.
  void set_keeper(BlockKeeper* keeper) noexcept { keeper_ = keeper; }

  /// Dense copies of the present bone (blocks and window), i fastest. The box may extend outside the grid.
  void read_remaining(const VoxelBox& box, std::span<float> out) const;
  void read_density(const VoxelBox& box, std::span<float> out) const;
  void read_gradient(const VoxelBox& box, std::span<Vec3f> out) const;
  /// Labels of the bone as loaded, as numbers; read from the prefetch if possible.
  void read_labels(const VoxelBox& box, std::span<float> out) const;

  /// Saves one .vdb (temporary name, then rename). restore() reads either. bad_input: the path cannot be written, or the whole of a paged
  /// bone is requested.
  [[nodiscard]] Status save(const std::string& path, SavedBone saved = SavedBone::whole);
  /// Reads `remaining` from a file saved from the same bone, as the start of a run; increments the growth epoch. bad_input: the grids do
  /// not match the bone.
  [[nodiscard]] Status restore(const std::string& path);
  /// @returns whether the bone was drilled before the run: by the file of the bone model, or by restore().
  [[nodiscard]] bool starts_drilled() const noexcept { return first_ != nullptr; }
  /// Density before what the run removed: at the start of the run, and where a reset brought back more, that. Dense copy of a box, i fastest. The box may extend outside the grid.
  void read_start(const VoxelBox& box, std::span<float> out) const;

  /// @returns the hash over all voxels that differ from the bone as loaded, sorted by k, j, i; independent of window and storage.
  [[nodiscard]] std::uint64_t hash();
  /// @returns the bounding box of all voxels that differ from the bone as loaded.
  [[nodiscard]] VoxelBox changed_bounds();
  [[nodiscard]] std::size_t bytes() const;

 private:
  Voxmap(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config);
  void load_window(const VoxelBox& box);
  void slide_window(const VoxelBox& box);
  void load_part(const VoxelBox& part);
  /// After bone was brought back, or an undo has taken it away again.
  void raise_start(std::span<const BlockChange> changes);
  /// @returns whether the block's values changed.
  bool put_block(const Vec3i& block, const BlockValues& values);

  std::shared_ptr<const BoneModel> bone_;
  VoxmapConfig config_;
  BlockStore blocks_;                        // of remaining
  std::shared_ptr<const BlockStore> first_;  // the same at the start of the run; null: all voxels are 1
  std::shared_ptr<const BlockStore> start_;  // the same before what the run removed: a reset may bring back more
  CutSurface cut_;
  MasterWindow window_;
  BlockMarks unsaved_;  // blocks of the window that were committed since write_back()
  BlockKeeper* keeper_ = nullptr;
  BonePrefetch* prefetch_ = nullptr;
  std::vector<VoxelBoxes> listeners_;
  std::uint64_t growth_epoch_ = 0;
  std::uint64_t window_epoch_ = 0;
};

}  // namespace burrhole
