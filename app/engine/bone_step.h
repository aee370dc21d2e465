/// app/engine/bone_step.h: one simulation step: erosion along the tool's path, gradients, publishing, window upkeep.
///   Thread simulation, the only writer of bone.
#pragma once

#include <memory>
#include <optional>

#include "app/engine/scene.h"
#include "app/engine/step_timer.h"
#include "core/drill/energy.h"
#include "core/drill/erosion.h"
#include "core/drill/spindle.h"
#include "core/tool/tool.h"
#include "core/voxel/contact_window.h"

namespace burrhole {

/// Box of voxels that a tool needs at a pose, `margin` voxels wider on each side.
[[nodiscard]] VoxelBox tool_box(const Tool& tool, const Affine& index_from_tool, int margin);

/// What a scene's contact model and the drill monitor read of the window.
[[nodiscard]] ContactFields contact_fields(const Scene& scene);

/// Voxels kept round the tool's bounding box when the window is placed, and the least before it slides.
struct WindowMargins {
  int placed, least;
};
/// As wide as the contact model's look needs, and then some for the way of the tool in a step.
[[nodiscard]] WindowMargins window_margins(const Scene& scene, const Affine& bone_from_index);

struct BoneStepTimers {
  StepTimer erosion, spindle, gradient, publish;
};

class BoneStep {
 public:
  /// Places the window at the tool and publishes it. out_of_range when the tool does not fit a window: the message gives the numbers.
  [[nodiscard]] static Result<BoneStep> create(const Scene& scene, const Tool& tool, Voxmap& voxmap, const Pose& world_from_tool);

  /// Moves the tool from where it was to `world_from_tool` over `dt` [s], pressed on by `cutting_force` [N] where it cuts.
  void operator()(const Pose& world_from_tool, double cutting_force, double dt);
  [[nodiscard]] double spin() const noexcept { return spindle_ ? spindle_->speed() : spin_; }  ///< [rev/s] now
  /// Null without [spindle], and at spin 0.
  [[nodiscard]] const Spindle* spindle() const noexcept { return spindle_ ? &*spindle_ : nullptr; }
  [[nodiscard]] double turned() const noexcept { return turned_; }  ///< [rev] of the spindle so far, in 0..1: whole turns are left out
  [[nodiscard]] double slowest_spin() const noexcept { return slowest_spin_; }  ///< [rev/s] so far
  /// Null without [erosion].
  [[nodiscard]] const Erosion* erosion() const noexcept { return erosion_ ? &*erosion_ : nullptr; }
  [[nodiscard]] ContactWindowPublisher& publisher() noexcept { return *publisher_; }
  [[nodiscard]] const VdbContactGrids* grids() const noexcept { return grids_.get(); }
  [[nodiscard]] double removed_mass() const noexcept { return removed_mass_; }  ///< [m^3] so far
  [[nodiscard]] std::uint64_t points_outside() const noexcept { return points_outside_; }
  [[nodiscard]] BoneStepTimers& timers() noexcept { return timers_; }

 private:
  BoneStep(const Scene& scene, const Tool& tool, Voxmap& voxmap);
  [[nodiscard]] Affine index_from_tool(const Pose& world_from_tool) const;
  [[nodiscard]] Status keep_window(const ErosionPath& path);
  /// @returns whether bone changed.
  bool erode(const ErosionPath& path, double cutting_force, double dt);

  const Tool* tool_;
  Voxmap* voxmap_;
  Affine index_from_world_;
  WindowMargins margins_;
  double spin_ = 0.0, slowest_spin_ = 0.0;  // [rev/s]
  double turned_ = 0.0;                     // [rev]
  std::optional<Erosion> erosion_;
  std::optional<Spindle> spindle_;
  double rubbing_radius_ = 0.0;  // [m] of the whole tool, for laws that do not say where they rub
  std::unique_ptr<ContactWindowPublisher> publisher_;
  std::unique_ptr<VdbContactGrids> grids_;
  Pose last_;
  double removed_mass_ = 0.0;
  std::uint64_t points_outside_ = 0;
  double unsaved_for_ = 0.0;  // [s] since the store of record was brought up to date
  BoneStepTimers timers_;
};

}  // namespace burrhole
