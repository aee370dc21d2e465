/// app/view/frame_step.h: sends changed texels to the display and requests the pictures of a run. No OpenGL.
///   Frame  world unless stated; boxes in index coordinates.   Units  SI.   Errors  those of the FrameSink.
///   Thread  one at a time: gather() by the owner of the bone, draw() by the frame thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/view/added_mesh.h"
#include "app/view/assumed_brain.h"
#include "app/view/detail.h"
#include "app/view/display_config.h"
#include "app/view/texel_queue.h"
#include "app/view/texels.h"
#include "app/view/view.h"
#include "core/base/step_timer.h"
#include "core/measure/approach.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// Interface of a display. An error of any function stops the run.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  [[nodiscard]] virtual Status start(const VolumeView& volume, const TriangleMesh& tool) = 0;
  virtual void update(const TexelBox& texels) = 0;
  /// Replaces the detail of a bone in two levels.
  [[nodiscard]] virtual Status move_detail(const DetailView&) { return {}; }
  /// Replaces the tool from the next picture on.
  [[nodiscard]] virtual Status change_tool(const TriangleMesh&) { return {}; }
  /// Replaces what effects add to the pictures, from the next one on; null: nothing.
  [[nodiscard]] virtual Status set_added(const std::shared_ptr<const AddedMesh>&) { return {}; }
  /// Discards everything cached from earlier pictures. Called when bone may have been restored.
  virtual void forget() {}
  /// Draws and stores one picture, and adds its pixels to `hash`.
  [[nodiscard]] virtual Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64& hash) = 0;
  /// Draws the next frame of the run's film.
  [[nodiscard]] virtual Status film(const FrameView&, int, int) { return {}; }
};

struct FrameStepTimers {
  StepTimer texels, upload, frame;
};

/// Name of the picture that shows all that is drawn; see DisplayConfig::overview.
inline constexpr const char* kOverview = "overview";

class FrameStep {
 public:
  /// Sends the whole volume once; a bone that is too large for one texture in two levels (detail.h). Errors also of CoarseBone.
  [[nodiscard]] static Result<FrameStep> create(const DisplayConfig& display, const Pose& world_from_bone, const Approach& approach,
                                                const Tool& tool, Voxmap& voxmap, FrameSink& sink);
  /// Adds what an effect shows to all pictures from the next gather() on. It must outlive this. Called while no clock runs.
  void add(PictureSource& source) { sources_.push_back(&source); }
  /// Copies changed density into the batch, up to the scene's budget; the rest stays queued for the next call. Called by the owner of the
  /// bone while no picture is drawn. @param turned [rev] rotation of the spindle, at which the next picture shows the bit.
  void gather(double turned = 0.0);
  /// The same without a budget: the queue is empty afterwards, and what effects add is copied exactly.
  void gather_rest(double turned = 0.0);
  /// Moves the bone in the pictures from now on. @param world_from_rest maps the bone as the scene places it to its place now.
  void move_bone(const Pose& world_from_rest) noexcept { world_from_bone_ = world_from_rest * at_rest_; }
  /// Sends the batch without drawing, to a sink that draws by itself.
  [[nodiscard]] Status send() { return send_changes(); }
  /// Sends the batch, then draws. @param world_from_tool absent: the tool is not drawn. @param cut clips bone and bit at a plane through the
  /// approach axis instead of the scene's own cut, which clips bone alone. A cut at the tip uses the latest tip position, or the entry if there is none yet.
  [[nodiscard]] Status draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut);
  /// Sends the batch, then draws the next frame of the film, as the scene shows the bone. It has no part in image_hash().
  [[nodiscard]] Status film(const Pose& world_from_tool);
  [[nodiscard]] Status change_tool(const Tool& tool) {
    turns_ = tool.turns;
    look_ = tool.look;
    surface_ = tool.surface;
    return sink_->change_tool(look_);
  }
  [[nodiscard]] const FrameStepTimers& timers() const noexcept { return timers_; }
  [[nodiscard]] std::uint64_t image_hash() const noexcept { return hash_.value(); }    ///< of all pictures
  [[nodiscard]] std::uint64_t picture_hash() const noexcept { return picture_hash_; }  ///< of the latest
  [[nodiscard]] std::uint64_t texels_sent() const noexcept { return texels_sent_; }
  [[nodiscard]] std::size_t texels_waiting() const noexcept { return queue_.texels(); }  ///< queued for a later batch

 private:
  /// Density from which the texels of one changed box are made.
  struct Change {
    TexelSource own;     // at the bone's voxels: of the whole bone, or of the detail
    TexelSource coarse;  // of the whole bone; empty if it is drawn at its own voxels
    [[nodiscard]] std::size_t texels() const noexcept { return own.box.count() + coarse.box.count(); }
  };

  FrameStep(const DisplayConfig& display, const Pose& world_from_bone, const Approach& approach, Voxmap& voxmap, FrameSink& sink);
  DisplayConfig display_;
  Pose at_rest_, world_from_bone_, world_from_approach_;  // the approach is that of the bone at rest
  double thickness_;
  Vec3 tip_;           // [m] world, of the latest picture
  bool turns_ = true;  // whether the bit rotates about its axis
  TriangleMesh look_;  // of the bit
  std::shared_ptr<const ToolSurface> surface_;
  double turned_ = 0.0;  // [rev]
  Voxmap* voxmap_;
  FrameSink* sink_;
  std::vector<PictureSource*> sources_;
  std::vector<const SoftTop*> soft_tops_;  // of them
  bool added_changed_ = false;             // since the last picture
  std::size_t listener_;
  [[nodiscard]] Result<VolumeView> make_levels(const Pose& bone_from_approach);
  [[nodiscard]] DetailView make_detail() const;
  void find_outline();
  [[nodiscard]] std::optional<CameraView> inset_of(const FrameView& view) const;
  void read_change(const VoxelBox& box, Change& out) const;
  void make_change(const Change& change, std::vector<TexelBox>& out) const;
  void follow(const VoxelBox& changed);
  void fill_batch(std::size_t most, double seconds, bool exactly);
  void copy_sources(bool exactly);
  void add_changed(const Bounds& box);
  [[nodiscard]] Status send_added();
  [[nodiscard]] Status send_batch();
  [[nodiscard]] Status send_changes();
  [[nodiscard]] Status draw_view(const std::string& name, const FrameView& view, Hash64& hash);
  [[nodiscard]] Status draw_section(const std::string& name, FrameView view, Hash64& hash);
  [[nodiscard]] FrameView view_of(const std::optional<Pose>& world_from_tool, bool cut, bool overview = false) const;
  [[nodiscard]] std::size_t texels_in_batch() const noexcept;
  TexelQueue queue_;
  std::vector<Vec3> outline_;          // [m] bone frame, of what the inset shows; empty without one
  std::optional<CoarseBone> coarse_;   // absent: the bone is drawn at its own voxels
  std::optional<DetailGrid> detail_;   // absent: no part is drawn at other voxels than the rest
  std::optional<DetailView> moved_;    // to be sent before the batch
  std::optional<AssumedBrain> brain_;  // absent: no soft tissue is drawn but that of the bone model
  std::vector<Change> batch_;          // the batch is the first `filled_`; the others are reused memory
  std::size_t filled_ = 0;
  double make_time_ = 0.0;  // [s] limit for making texels of the batch; 0: no limit
  std::uint64_t growth_epoch_ = 0;
  bool has_grown_ = false;  // bone in the batch or the queue may have been restored
  Hash64 hash_;
  std::uint64_t picture_hash_ = 0;
  std::uint64_t texels_sent_ = 0;
  FrameStepTimers timers_;
};

/// @returns the table under what is drawn of a bone, across the approach axis; nothing if the scene has none.
[[nodiscard]] std::optional<TableView> find_table(const DisplayConfig& display, const BoneModel& bone, const Pose& world_from_bone,
                                                  const Pose& world_from_approach);

/// @returns the tool pose rotated about the tool's axis by `turned` [rev], clockwise seen from above (the cutting direction).
[[nodiscard]] Pose turned_tool(const Pose& world_from_tool, double turned);

/// @returns the scene's own cut, absent if it has none: its plane, or the plane through `tip` (world) perpendicular to the view direction.
[[nodiscard]] std::optional<FrameView::Cut> make_scene_cut(const CutConfig& cut, const CameraView& camera, const Pose& world_from_bone,
                                                           const Vec3& tip);

/// @returns the scene's camera, which orbits the entry about the approach axis. @param cut lower, and from the open side.
[[nodiscard]] FrameView make_frame_view(const DisplayConfig& display, const Pose& world_from_bone, const Pose& world_from_approach,
                                        double thickness, bool cut);

}  // namespace burrhole
