/// app/engine/bone_step.h: one simulation step: erosion along the tool's path, gradients, publishing, window upkeep.
///   Thread simulation, the only writer of bone.
#pragma once

#include <memory>
#include <optional>

#include "app/engine/scene.h"
#include "app/engine/step_timer.h"
#include "core/drill/erosion.h"
#include "core/tool/tool.h"
#include "core/voxel/contact_window.h"

namespace burrhole {

/// Free voxels kept round the tool's bounding box when the window is placed, and the least before it slides.
inline constexpr int kWindowReach = 12, kWindowLeast = 5;

/// Box of voxels that a tool needs at a pose, `margin` voxels wider on each side.
[[nodiscard]] VoxelBox tool_box(const Tool& tool, const Affine& index_from_tool, int margin);

struct BoneStepTimers {
  StepTimer erosion, gradient, publish;
};

class BoneStep {
 public:
  /// Places the window at the tool and publishes it. out_of_range when the tool does not fit a window: the message gives the numbers.
  [[nodiscard]] static Result<BoneStep> create(const Scene& scene, const Tool& tool, Voxmap& voxmap, const Pose& world_from_tool);

  /// Moves the tool from where it was to `world_from_tool` over `dt` [s].
  void operator()(const Pose& world_from_tool, double dt);
  [[nodiscard]] ContactWindowPublisher& publisher() noexcept { return *publisher_; }
  [[nodiscard]] const VdbContactGrids* grids() const noexcept { return grids_.get(); }
  [[nodiscard]] double removed_mass() const noexcept { return removed_mass_; }  ///< [m^3] so far
  [[nodiscard]] std::uint64_t points_outside() const noexcept { return points_outside_; }
  [[nodiscard]] BoneStepTimers& timers() noexcept { return timers_; }

 private:
  BoneStep(const Scene& scene, const Tool& tool, Voxmap& voxmap);
  [[nodiscard]] Affine index_from_tool(const Pose& world_from_tool) const;
  [[nodiscard]] Status keep_window(const ErosionPath& path);

  const Tool* tool_;
  Voxmap* voxmap_;
  Affine index_from_world_;
  double spin_ = 0.0;
  std::optional<Erosion> erosion_;
  std::unique_ptr<ContactWindowPublisher> publisher_;
  std::unique_ptr<VdbContactGrids> grids_;
  Pose last_;
  double removed_mass_ = 0.0;
  std::uint64_t points_outside_ = 0;
  double unsaved_for_ = 0.0;  // [s] since the store of record was brought up to date
  BoneStepTimers timers_;
};

}  // namespace burrhole
