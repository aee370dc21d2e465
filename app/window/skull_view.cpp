#include "app/window/skull_view.h"

#include "app/render/tip_slices_picture.h"
#include "app/view/coarse_bone.h"
#include "app/view/detail.h"
#include "app/view/display_config.h"
#include "app/view/texels.h"
#include "app/view/tip_slices.h"

namespace burrhole {
namespace {

using Steady = std::chrono::steady_clock;
constexpr double kBudget = 0.060, kCoarsest = 0.5;  // [s] of a picture while the view moves; [-] least share of its width and height
constexpr double kRest = 0.15;                      // [s] without a change, after which the picture is refined
constexpr double kSliceHalfWidth = 0.024;           // [m] shown around the entry
constexpr float kDeadZone = 0.08f;                  // [1/voxel] as VolumeScene

/// The light of a run: from the upper left, behind the person's shoulder.
LightView light_for(const CameraView& camera) {
  const Vec3 back = glm::normalize(camera.eye - camera.target);
  const Vec3 right = glm::normalize(glm::cross(camera.up, back));
  LightView out;
  out.direction_to_light = back + 0.6 * glm::cross(back, right) - 0.5 * right;
  return out;
}

/// Of this bone nothing is removed but what was drilled before it was saved.
DrawnBone drawn_as_loaded(const BoneModel& bone) {
  return {&bone, [&bone](const VoxelBox& box, std::span<float> out) { bone.read_density(box, out); }, kDeadZone};
}

Pose pose_of(const SkullSite& site) { return {rotation_from_z(-site.axis), site.entry}; }

}  // namespace

SkullView::SkullView(Renderer renderer, TriangleMesh solid)
    : renderer_(std::move(renderer)),
      solid_(std::move(solid)),
      picture_(renderer_.context()),
      slices_(renderer_.context()),
      pace_(kBudget, kCoarsest) {}

Result<std::unique_ptr<SkullView>> SkullView::create(GlContext context, const TriangleMesh& bit, TriangleMesh solid) {
  const DisplayConfig display;
  auto renderer = Renderer::create(make_render_options(display.quality, display.appearance), std::move(context));
  if (!renderer) return renderer.error();
  if (Status set = renderer->set_tool(bit); !set) return set.error();
  return std::unique_ptr<SkullView>(new SkullView(std::move(renderer).value(), std::move(solid)));
}

Status SkullView::set_bone(const BoneModel& bone) {
  const DisplayConfig display;
  camera_.reset();
  sliced_.reset();
  const int factor = coarse_factor(bone.dims(), display.whole_voxels);
  if (factor == 1) return renderer_.set_volume(make_volume_view(drawn_as_loaded(bone), bone.bounds(), display.appearance.tissue));
  const auto coarse = CoarseBone::create(bone, factor);
  if (!coarse) return coarse.error();
  const BoneModel& loaded = coarse->loaded();
  return renderer_.set_volume(make_volume_view(drawn_as_loaded(loaded), loaded.bounds(), display.appearance.tissue));
}

Status SkullView::draw(const SkullPointer& pointer, int width, int height) {
  const auto now = Steady::now();
  const CameraView camera = pointer.camera();
  const auto& site = pointer.site();
  const auto entry = site ? std::optional(site->entry) : std::nullopt;
  const bool moved = camera_ != camera || width != width_ || height != height_, placed = entry != entry_;
  if (moved || placed) changed_ = now;
  const bool rests = std::chrono::duration<double>(now - changed_).count() > kRest;
  const bool refines = rests && !fine_;
  if (moved || placed || coarse_ || refines) {
    DrawingQuality quality = DisplayConfig{}.quality;
    if (!rests) quality.supersample = 1;
    if (rests != fine_ || !camera_)
      if (Status set = renderer_.set_quality(quality); !set) return set;
    FrameView frame;
    frame.camera = camera;
    frame.light = light_for(camera);
    frame.background = DisplayConfig{}.background;
    if (site) frame.world_from_tool = pose_of(*site);
    const double share = pace_.resolution();
    auto image = renderer_.draw_at_pace(frame, width, height, pace_);
    if (!image) return image.error();
    picture_.set(*image);
    fine_ = rests;
    coarse_ = moved && share < 1.0;
    camera_ = camera;
    entry_ = entry;
    width_ = width;
    height_ = height;
  }
  const int size = std::min(width / 4, height / 4);
  if (rests && (sliced_ != entry || size != slice_size_)) {
    if (Status drawn = draw_slices(site, size); !drawn) return drawn;
    sliced_ = entry;
    slice_size_ = size;
  }
  return {};
}

Status SkullView::draw_slices(const std::optional<SkullSite>& site, int size) {
  if (!site) return {};
  auto mineral = renderer_.read_mineral(site->entry, kSliceHalfWidth);
  if (!mineral) return mineral.error();
  slices_.set(draw_tip_slices(make_tip_slices(*mineral, solid_, pose_of(*site), kSliceHalfWidth, std::max(64, size))));
  return {};
}

}  // namespace burrhole
