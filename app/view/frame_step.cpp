#include "app/view/frame_step.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

namespace burrhole {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point in_seconds(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

FrameView make_frame_view(const DisplayConfig& display, const Pose& world_from_bone, const Pose& world_from_approach, double thickness,
                          bool cut) {
  FrameView view;
  view.world_from_bone = world_from_bone;
  // The camera faces a cut and is lower, so that the wall of the hole is visible from the outer to the inner table.
  const double elevation = cut ? 0.45 * display.elevation : display.elevation;
  const double azimuth = cut ? 0.35 * display.azimuth : display.azimuth;
  const Vec3 direction(std::sin(azimuth) * std::cos(elevation), -std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
  const Vec3 middle(0.0, 0.0, cut ? -0.6 * thickness : -0.8 * thickness);
  view.camera.target = world_from_approach * middle;
  view.camera.eye = world_from_approach * (middle + direction * (cut ? 0.68 : 1.0) * display.distance);
  view.camera.up = world_from_approach.rotate(Vec3(0, 0, 1));
  view.camera.vertical_fov = 0.6;
  view.background = display.background;
  view.light.direction_to_light = world_from_approach.rotate(Vec3(-0.45, -0.35, 0.8));
  if (cut) {
    const Vec3 normal = world_from_approach.rotate(Vec3(0, -1, 0));
    view.cut = FrameView::Cut{normal, glm::dot(normal, world_from_approach.translation)};
  }
  return view;
}

Pose turned_tool(const Pose& world_from_tool, double turned) {
  const double half = -std::numbers::pi * turned;
  return {world_from_tool.rotation * Quat(std::cos(half), 0.0, 0.0, std::sin(half)), world_from_tool.translation};
}

std::optional<FrameView::Cut> make_scene_cut(const CutConfig& cut, const CameraView& camera, const Pose& world_from_bone, const Vec3& tip) {
  if (cut.kind == CutKind::none) return std::nullopt;
  const bool at_tip = cut.kind == CutKind::tip;
  const Vec3 normal = at_tip ? glm::normalize(camera.eye - camera.target) : glm::normalize(world_from_bone.rotate(cut.normal));
  return FrameView::Cut{normal, glm::dot(normal, at_tip ? tip : world_from_bone * cut.point)};
}

FrameStep::FrameStep(const DisplayConfig& display, const Pose& world_from_bone, const Approach& approach, Voxmap& voxmap, FrameSink& sink)
    : display_(display),
      world_from_bone_(world_from_bone),
      world_from_approach_(world_from_bone * approach.bone_from_approach),
      thickness_(approach.thickness),
      tip_(world_from_approach_.translation),
      voxmap_(&voxmap),
      sink_(&sink),
      listener_(voxmap.add_listener()),
      growth_epoch_(voxmap.growth_epoch()) {}

Result<FrameStep> FrameStep::create(const DisplayConfig& display, const Pose& world_from_bone, const Approach& approach, const Tool& tool,
                                    Voxmap& voxmap, FrameSink& sink) {
  FrameStep out(display, world_from_bone, approach, voxmap, sink);
  out.turns_ = tool.turns;
  if (Status started = sink.start(make_volume_view(voxmap, display.appearance.tissue), tool.look); !started) return started.error();
  return out;
}

void FrameStep::gather(double turned) {
  turned_ = turned;
  fill_batch(display_.upload_budget / kTexelBytes, display_.upload_time);
}

void FrameStep::gather_rest(double turned) {
  turned_ = turned;
  fill_batch(std::numeric_limits<std::size_t>::max(), 0.0);
}

/// @param seconds 0: no limit.
void FrameStep::fill_batch(std::size_t most, double seconds) {
  constexpr std::size_t kBetweenChecks = 4096;  // texels, a fraction of a millisecond
  make_time_ = seconds;
  timers_.texels([&] {
    for (const VoxelBox& box : voxmap_->take_dirty(listener_)) queue_.add(box.intersect(voxmap_->bone().bounds()));
    const auto end = in_seconds(seconds);
    const std::size_t chunk = seconds > 0.0 ? std::min(most, kBetweenChecks) : most;
    std::size_t left = most - std::min(most, texels_in_batch());
    if (left == 0) return;
    do {
      for (const VoxelBox& box : queue_.take(chunk)) {
        if (filled_ == batch_.size()) batch_.emplace_back();
        read_texel_source(*voxmap_, box, batch_[filled_++]);
        left -= std::min(left, box.count());
      }
    } while (seconds > 0.0 && !queue_.empty() && left >= chunk && Clock::now() < end);
  });
  has_grown_ = has_grown_ || voxmap_->growth_epoch() != growth_epoch_;
  growth_epoch_ = voxmap_->growth_epoch();
}

std::size_t FrameStep::texels_in_batch() const noexcept {
  std::size_t sum = 0;
  for (std::size_t n = 0; n < filled_; ++n) sum += batch_[n].box.count();
  return sum;
}

/// Makes the texels of the batch and sends them. Boxes for which no time is left stay in the batch.
void FrameStep::send_batch() {
  std::vector<TexelBox> made;
  timers_.texels([&] {
    const auto end = in_seconds(make_time_);
    while (made.size() < filled_ && (made.empty() || make_time_ == 0.0 || Clock::now() < end))
      made.push_back(make_texels(voxmap_->bone(), voxmap_->config().gradient_dead_zone, batch_[made.size()]));
  });
  const auto first = batch_.begin(), sent = first + static_cast<std::ptrdiff_t>(made.size());
  std::rotate(first, sent, first + static_cast<std::ptrdiff_t>(filled_));
  filled_ -= made.size();
  timers_.upload([&] {
    for (const TexelBox& texels : made) {
      texels_sent_ += texels.normal_opacity.size();
      sink_->update(texels);
    }
  });
}

Status FrameStep::draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut) {
  if (has_grown_) sink_->forget();
  send_batch();
  has_grown_ = has_grown_ && (filled_ > 0 || !queue_.empty());  // boxes that are not sent yet may have grown
  FrameView view = make_frame_view(display_, world_from_bone_, world_from_approach_, thickness_, cut);
  if (world_from_tool) view.world_from_tool = turns_ ? turned_tool(*world_from_tool, turned_) : *world_from_tool;
  if (world_from_tool) tip_ = world_from_tool->translation;
  if (!cut) view.cut = make_scene_cut(display_.cut, view.camera, world_from_bone_, tip_);
  Hash64 picture;
  if (Status drawn = timers_.frame([&] { return sink_->draw(name, view, display_.width, display_.height, picture); }); !drawn) return drawn;
  picture_hash_ = picture.value();
  hash_.add(picture_hash_);
  return {};
}

}  // namespace burrhole
