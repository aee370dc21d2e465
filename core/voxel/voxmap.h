/// core/voxel/voxmap.h: what is left of the bone. The master window is the truth inside its box; OpenVDB is the store of record outside
/// and takes the window back when it slides, at checkpoints and on save.
///   Units   remaining 1 as loaded .. 0 gone; density = occupancy x remaining.   Thread  one writer, the simulation.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/hash.h"
#include "core/base/result.h"
#include "core/voxel/bone_model.h"
#include "core/voxel/box_set.h"
#include "core/voxel/dirty_boxes.h"

namespace burrhole {

struct VoxmapConfig {
  float gradient_dead_zone = 0.08f;  ///< [density/voxel] shorter gradients are zero
};

/// Dense fields over `box`, i fastest. Gradients are not among them: whoever needs them makes them from the density, in the form needed
/// (packed words, floats of a published copy, texels). They are known inside valid_box(); erosion may write inside erodible_box() only, so
/// that every gradient that it changes lies in the window.
struct MasterWindow {
  VoxelBox box;
  std::vector<float> occupancy, hardness, remaining, density;
  float gradient_dead_zone = 0.0f;

  [[nodiscard]] VoxelBox valid_box() const noexcept { return box.grown(-1); }
  [[nodiscard]] VoxelBox erodible_box() const noexcept { return box.grown(-2); }
  [[nodiscard]] std::size_t bytes() const noexcept { return 4 * sizeof(float) * box.count(); }
};

/// Float gradients of `part` from the window's density, into an array over window.box; zero in the outermost layer, where they are not
/// known.
void derive_gradient(const MasterWindow& window, const VoxelBox& part, std::span<Vec3f> gradient) noexcept;

/// Longest edge of a window [voxels].
inline constexpr int kMaxWindowEdge = 256;

class Voxmap {
 public:
  [[nodiscard]] static Result<Voxmap> create(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config);
  Voxmap(Voxmap&&) noexcept;
  Voxmap& operator=(Voxmap&&) noexcept;
  ~Voxmap();

  [[nodiscard]] const BoneModel& bone() const noexcept { return *bone_; }
  [[nodiscard]] const VoxmapConfig& config() const noexcept { return config_; }
  [[nodiscard]] const MasterWindow& window() const noexcept { return window_; }

  /// Moves the window: writes the old one back, keeps what both places hold, loads what is new. out_of_range when an edge is below 5 or
  /// above kMaxWindowEdge.
  [[nodiscard]] Status place_window(const VoxelBox& box);

  /// For erosion: remaining [0..1] of the window; after writing, commit() each box touched (inside erodible_box()).
  [[nodiscard]] std::span<float> remaining() noexcept { return window_.remaining; }
  /// Recomputes density in the box; marks it with its halo of one voxel, whose gradients change, dirty for every listener.
  void commit(const VoxelBox& touched) noexcept;
  /// The same, box by box.
  void commit(const BoxSet& touched) noexcept {
    for (const VoxelBox& box : touched) commit(box);
  }

  /// Registers a listener for changed boxes (in voxels whose density or gradient may differ, halo included).
  [[nodiscard]] std::size_t add_listener();
  [[nodiscard]] std::vector<VoxelBox> take_dirty(std::size_t listener);

  /// Raised whenever bone may have grown back (restore): caches that assume that bone only disappears must drop what they know.
  [[nodiscard]] std::uint64_t growth_epoch() const noexcept { return growth_epoch_; }
  /// Raised whenever the window moved or was reloaded: a copy must move with it and take what is new.
  [[nodiscard]] std::uint64_t window_epoch() const noexcept { return window_epoch_; }

  /// Brings the store of record up to date with the window.
  void write_back();
  /// Dense copies from store and window together, i fastest; the box may reach outside the grid.
  void read_remaining(const VoxelBox& box, std::span<float> out);
  void read_density(const VoxelBox& box, std::span<float> out);
  void read_gradient(const VoxelBox& box, std::span<Vec3f> out);

  /// Saves bone and remaining as one .vdb (temporary name, then rename).
  [[nodiscard]] Status save(const std::string& path);
  /// Takes `remaining` from a file saved earlier from the same bone; raises the growth epoch. bad_input when the grids do not fit.
  [[nodiscard]] Status restore(const std::string& path);

  /// Hash over all voxels that differ from as-loaded, sorted by k, j, i; independent of window and leaves.
  [[nodiscard]] std::uint64_t hash();
  /// Box of all voxels that differ from as-loaded.
  [[nodiscard]] VoxelBox changed_bounds();
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Store;
  Voxmap(std::shared_ptr<const BoneModel> bone, const VoxmapConfig& config);
  void load_window(const VoxelBox& box);
  void slide_window(const VoxelBox& box);
  void load_part(const VoxelBox& part);

  std::shared_ptr<const BoneModel> bone_;
  VoxmapConfig config_;
  std::unique_ptr<Store> store_;
  MasterWindow window_;
  VoxelBox unsaved_;  // part of the window that the store has not seen
  std::vector<DirtyBoxes> listeners_;
  std::uint64_t growth_epoch_ = 0;
  std::uint64_t window_epoch_ = 0;
};

}  // namespace burrhole
