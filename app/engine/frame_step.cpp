#include "app/engine/frame_step.h"

#include <cmath>
#include <numbers>

#include "app/engine/texels.h"

namespace burrhole {

FrameView make_frame_view(const DisplayScene& display, const Pose& world_from_bone, const Pose& world_from_approach, double thickness,
                          bool cut) {
  FrameView view;
  view.world_from_bone = world_from_bone;
  // A cut is looked at squarely and from lower down, so that the wall of the hole is seen from table to table.
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

std::optional<FrameView::Cut> make_scene_cut(const CutScene& cut, const CameraView& camera, const Pose& world_from_bone, const Vec3& tip) {
  if (cut.kind == CutKind::none) return std::nullopt;
  const bool at_tip = cut.kind == CutKind::tip;
  const Vec3 normal = at_tip ? glm::normalize(camera.eye - camera.target) : glm::normalize(world_from_bone.rotate(cut.normal));
  return FrameView::Cut{normal, glm::dot(normal, at_tip ? tip : world_from_bone * cut.point)};
}

FrameStep::FrameStep(const Scene& scene, const Approach& approach, Voxmap& voxmap, FrameSink& sink)
    : display_(*scene.display),
      world_from_bone_(scene.volume.world_from_bone),
      world_from_approach_(scene.volume.world_from_bone * approach.bone_from_approach),
      thickness_(approach.thickness),
      tip_(world_from_approach_.translation),
      voxmap_(&voxmap),
      sink_(&sink),
      listener_(voxmap.add_listener()) {}

Result<FrameStep> FrameStep::create(const Scene& scene, const Approach& approach, const Tool& tool, Voxmap& voxmap, FrameSink& sink) {
  FrameStep out(scene, approach, voxmap, sink);
  out.turns_ = tool.turns;
  if (Status started = sink.start(make_volume_view(voxmap, scene.display->looks.tissue), tool.look); !started) return started.error();
  return out;
}

void FrameStep::gather(double turned) {
  turned_ = turned;
  timers_.texels([&] {
    for (const VoxelBox& box : voxmap_->take_dirty(listener_))
      if (TexelBox texels = make_texels(*voxmap_, box); !texels.box.empty()) parcel_.push_back(std::move(texels));
  });
}

Status FrameStep::draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut) {
  timers_.upload([&] {
    for (const TexelBox& texels : parcel_) {
      texels_sent_ += texels.normal_opacity.size();
      sink_->update(texels);
    }
    parcel_.clear();
  });
  FrameView view = make_frame_view(display_, world_from_bone_, world_from_approach_, thickness_, cut);
  if (world_from_tool) view.world_from_tool = turns_ ? turned_tool(*world_from_tool, turned_) : *world_from_tool;
  if (world_from_tool) tip_ = world_from_tool->translation;
  if (!cut) view.cut = make_scene_cut(display_.cut, view.camera, world_from_bone_, tip_);
  return timers_.frame([&] { return sink_->draw(name, view, display_.width, display_.height, hash_); });
}

}  // namespace burrhole
