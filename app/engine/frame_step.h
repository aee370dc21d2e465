/// app/engine/frame_step.h: hands the display what changed and asks it for the pictures of a run. Knows no OpenGL.
#pragma once

#include <string>

#include "app/engine/approach.h"
#include "app/engine/scene.h"
#include "app/engine/step_timer.h"
#include "app/engine/texel_queue.h"
#include "app/engine/view.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// A display, as the engine sees it. Errors stop the run.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  [[nodiscard]] virtual Status start(const VolumeView& volume, const TriangleMesh& tool) = 0;
  virtual void update(const TexelBox& texels) = 0;
  /// Bone may have grown back: nothing that a display kept from earlier pictures counts.
  virtual void forget() {}
  /// Draws and keeps one picture; `hash` takes its pixels.
  [[nodiscard]] virtual Status draw(const std::string& name, const FrameView& view, int width, int height, Hash64& hash) = 0;
};

struct FrameStepTimers {
  StepTimer texels, upload, frame;
};

class FrameStep {
 public:
  /// Sends the whole volume once.
  [[nodiscard]] static Result<FrameStep> create(const Scene& scene, const Approach& approach, const Tool& tool, Voxmap& voxmap,
                                                FrameSink& sink);
  /// Takes what changed into the parcel, as much as the scene's budget lets; the rest waits for the next call. By whoever owns the bone,
  /// while no one draws. @param turned [rev] of the spindle, by which the next picture shows the bit turned.
  void gather(double turned = 0.0);
  /// The same without a budget: nothing waits any more.
  void gather_rest(double turned = 0.0);
  /// Sends the parcel, then draws. `tool`: nothing when it is out of the picture; `cut` opens the bone through the axis, in place of the
  /// scene's own cut. A cut at the tip is at the tip last seen, the entry before there was one.
  [[nodiscard]] Status draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut);
  [[nodiscard]] FrameStepTimers& timers() noexcept { return timers_; }
  [[nodiscard]] std::uint64_t image_hash() const noexcept { return hash_.value(); }
  [[nodiscard]] std::uint64_t texels_sent() const noexcept { return texels_sent_; }
  [[nodiscard]] std::size_t texels_waiting() const noexcept { return queue_.texels(); }

 private:
  FrameStep(const Scene& scene, const Approach& approach, Voxmap& voxmap, FrameSink& sink);
  DisplayScene display_;
  Pose world_from_bone_, world_from_approach_;
  double thickness_;
  Vec3 tip_;             // [m] world, last seen
  bool turns_ = true;    // the bit, about its axis
  double turned_ = 0.0;  // [rev]
  Voxmap* voxmap_;
  FrameSink* sink_;
  std::size_t listener_;
  void fill_parcel(std::size_t most, double seconds);
  TexelQueue queue_;
  std::vector<TexelBox> parcel_;
  std::uint64_t growth_epoch_ = 0;
  bool has_grown_ = false;  // of the parcel or of what waits, some may have
  Hash64 hash_;
  std::uint64_t texels_sent_ = 0;
  FrameStepTimers timers_;
};

/// A tool turned about its axis by `turned` [rev], clockwise seen from above, as bits cut.
[[nodiscard]] Pose turned_tool(const Pose& world_from_tool, double turned);

/// The scene's own cut, if any: at its plane, or through `tip` (world) square to the camera's direction.
[[nodiscard]] std::optional<FrameView::Cut> make_scene_cut(const CutScene& cut, const CameraView& camera, const Pose& world_from_bone,
                                                           const Vec3& tip);

/// The scene's camera: round the entry, turned about the axis. `cut`: lower and from the open side.
[[nodiscard]] FrameView make_frame_view(const DisplayScene& display, const Pose& world_from_bone, const Pose& world_from_approach,
                                        double thickness, bool cut);

}  // namespace burrhole
