/// app/stage/bone_step.h: one simulation step: moves the window with the tool, runs the effects' steps, publishes the changed bone in the
///   form that the contact clock reads: a copy of the window, the paper's grids, or, without contact, the samples of the approach axis.
///   Frame  world unless stated; boxes in index coordinates.   Units  SI.   Errors  out_of_range.
///   Thread simulation, the only writer of bone.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>

#include "app/stage/effect.h"
#include "app/stage/slots.h"
#include "app/stage/tool_lead.h"
#include "core/base/step_timer.h"
#include "core/contact/shell_cover.h"
#include "core/measure/axis_bone.h"
#include "core/tool/tool.h"
#include "core/voxel/contact_window.h"

namespace burrhole {

/// @returns the bounding box of a tool at a pose, grown by `margin` [voxels] on each side.
[[nodiscard]] VoxelBox tool_box(const Tool& tool, const Affine& index_from_tool, int margin);

/// Distance from the tool's bounding box to the window's boundary: after the window is placed, and the minimum below which it slides.
struct WindowMargins {
  int placed, least;  ///< [voxels]
};
/// @returns margins that cover the reach of the contact model's queries and the motion of the tool in one step.
[[nodiscard]] WindowMargins window_margins(const ContactFields& fields, const Affine& bone_from_index);

/// @returns the voxels for which windows reserve memory, where the window round a tool at rest has `usual`: those that a drilling tool needs.
[[nodiscard]] constexpr std::size_t grown_window_voxels(std::size_t usual) noexcept { return usual + usual / 2; }

/// @returns the most voxels of a window placed ahead of a fast tool, where the window round a tool at rest has `usual`.
[[nodiscard]] constexpr std::size_t most_window_voxels(std::size_t usual) noexcept {
  constexpr std::size_t kSmall = std::size_t{96} * 96 * 96;
  return std::max(grown_window_voxels(usual), kSmall);
}

/// Blocks of 8^3 voxels, 2 KiB each, that differ from the bone as loaded and for which a live run reserves memory: 28 cm^3 at 0.3 mm.
inline constexpr std::size_t kReservedBlocks = 2048;

class BoneStep {
 public:
  /// Places the window at the tool; publish() then gives contact its first copy. out_of_range: the tool does not fit in a window; the message states the sizes.
  /// @param approach must outlive it. @param coarse bounds the distance of bone, so that the window can precede a fast tool; null: it
  /// follows the tool. @param one_thread contact runs on the simulation thread.
  [[nodiscard]] static Result<BoneStep> create(const StageConfig& config, const Needs& needs, const Tool& tool, Voxmap& voxmap,
                                               const Pose& world_from_tool, StepGraph& graph, const Approach& approach,
                                               const CoarseDistance* coarse = nullptr, bool one_thread = false);
  /// Provides the slots of the stage. Call after the effects are bound.
  void bind();

  /// Before the first step: sets the tool's pose, places the window round it and publishes it. out_of_range as create().
  [[nodiscard]] Status place(const Pose& world_from_tool);
  /// Sets the bone's pose from the next step on.
  void move_bone(const Pose& world_from_bone);
  /// Replaces the tool at its present pose; places the window round the new tool and publishes it. out_of_range as create().
  [[nodiscard]] Status change_tool(const Tool& tool);
  /// Publishes changes that were made outside of a step (undo, reset).
  void publish();
  [[nodiscard]] std::uint64_t steps() const noexcept { return steps_; }  ///< number of steps completed

  /// Runs one step. The tool moves from its previous pose to that of `found` in `dt` [s], both with their lead (tool_lead.h); `thrust` [N] is
  /// the mean cutting force.
  void operator()(const ContactState& found, double thrust, double dt);
  [[nodiscard]] double spin() const noexcept { return *spin_now_; }  ///< [rev/s] at present
  [[nodiscard]] double turned() const noexcept { return turned_; }   ///< [rev] angle of the spindle, 0..1
  // What is published; exactly one of the three is not null.
  [[nodiscard]] ContactWindowPublisher* publisher() noexcept { return publisher_.get(); }
  [[nodiscard]] const VdbContactGrids* grids() const noexcept { return grids_.get(); }
  [[nodiscard]] AxisBone* axis() noexcept { return axis_.get(); }
  [[nodiscard]] std::uint64_t published() const noexcept { return published_; }  ///< number of publications, of any form
  /// @returns the number of window copies published; 0 in a scene in which nothing reads them.
  [[nodiscard]] std::uint64_t window_copies() const noexcept { return publisher_ ? publisher_->published() : 0; }
  /// [m^3] of solid bone that erosion removed since the start, undone drilling included.
  [[nodiscard]] double removed_mass() const noexcept { return removed_mass_; }
  [[nodiscard]] std::uint64_t points_outside() const noexcept { return points_outside_; }  ///< sum of BoneRemoval::outside
  [[nodiscard]] StepTimer& publish_timer() noexcept { return publish_timer_; }

 private:
  BoneStep(const StageConfig& config, const Needs& needs, const Tool& tool, Voxmap& voxmap, StepGraph& graph, const CoarseDistance* coarse);
  [[nodiscard]] Affine index_from_tool(const Pose& world_from_tool) const;
  [[nodiscard]] bool is_near(const Affine& index_from_tool) const noexcept;
  /// @returns the share of a path, 0..1, at which bone may be near the tool first; nothing if it is near nowhere.
  [[nodiscard]] std::optional<double> first_near(const ErosionPath& path) const noexcept;
  /// Leaves out the part of the path of `cut` that is far from bone.
  void trim(Cut& cut) const noexcept;
  /// @returns the poses round which contact reads bone until the next step: from where the tool is, or where it will come near bone, to
  /// where it may be then.
  [[nodiscard]] ErosionPath foreseen(const Cut& cut, const ContactState& found) const noexcept;
  [[nodiscard]] Status keep_window(const ErosionPath& path);
  /// Places the window round the tool at a pose and reserves what it grows by under thrust. out_of_range as create().
  [[nodiscard]] Status place_window(const Tool& tool, const Pose& world_from_tool);

  const Tool* tool_;
  Voxmap* voxmap_;
  StepGraph* graph_;
  Affine bone_from_index_, index_from_world_;
  WindowMargins margins_;
  Vec3i slid_{0};  // [half voxels] last slide of the window
  const CoarseDistance* coarse_;
  ShellCover cover_;
  double near_ = 0.0;       // [m] bone at a smaller bound of its distance counts as near
  double foresight_ = 0.0;  // [s] from a contact result to the last evaluation that reads the window placed for it
  double spin_ = 0.0;       // [rev/s] of the scene, at full command
  double stretch_ = 0.0;    // [m] of the coupling of a tool that is held back, under the scene's thrust
  std::size_t most_ = 0;    // [voxels] of the largest window round a tool at rest so far
  double turned_ = 0.0;     // [rev]
  Cut* cut_ = nullptr;
  double* spin_asked_ = nullptr;
  double* own_spin_ = nullptr;  // null: an effect owns it
  const double* spin_now_ = nullptr;
  const BoneRemoval* removal_ = nullptr;  // null: no effect removes bone
  std::unique_ptr<ContactWindowPublisher> publisher_;
  std::unique_ptr<VdbContactGrids> grids_;
  std::unique_ptr<AxisBone> axis_;
  std::uint64_t published_ = 0, published_window_ = 0;  // publications; window epoch of the last one
  Pose last_;
  std::optional<ToolLead> lead_;  // with sub-voxel removal only
  Vec3 ahead_{0.0};               // [voxels] lead of the last step
  double removed_mass_ = 0.0;     // [m^3]
  std::uint64_t points_outside_ = 0;
  double unsaved_for_ = 0.0;  // [s] since the last Voxmap::write_back()
  std::uint64_t steps_ = 0;
  StepTimer publish_timer_;
};

}  // namespace burrhole
