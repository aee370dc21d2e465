#include "app/view/frame_step.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "app/view/cut_mesh.h"
#include "app/view/drape.h"
#include "app/view/skin.h"
#include "app/view/whole_bone.h"
#include "core/base/bounds.h"
#include "core/tool/tool_surface.h"

namespace burrhole {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point in_seconds(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// Box of what is drawn, in the approach frame.
Bounds find_extent(const BoneModel& bone, const Pose& world_from_bone, const Pose& world_from_approach) {
  const Surroundings* around = bone.surroundings();
  const BoneModel& drawn = around != nullptr ? *around->coarse : bone;
  const Affine approach_from_index = Affine::from_pose(world_from_approach.inverse() * world_from_bone) * drawn.bone_from_index();
  const VoxelBox& box = drawn.bone_box();
  Bounds out{Vec3(1e9), Vec3(-1e9)};
  for (const Vec3& corner : Bounds{Vec3(box.lo) - 0.5, Vec3(box.hi) - 0.5}.corners()) {
    const Vec3 p = approach_from_index * corner;
    out = {glm::min(out.lo, p), glm::max(out.hi, p)};
  }
  return out;
}

/// @returns the distance [m] of the table, or of the lower end of a cloth, below the bone.
double below_bone(const DisplayConfig& display) { return display.skin ? display.skin->below : 0.0; }

Vec3 middle_of(const Bounds& extent, const Pose& world_from_approach) { return world_from_approach * (0.5 * (extent.lo + extent.hi)); }

/// @returns whether tables or diploe are labelled on the approach axis.
bool has_layers(const Approach& approach) {
  return std::ranges::any_of(approach.layers, [](const Approach::Layer& layer) {
    return layer.label == VoxelLabel::outer_table || layer.label == VoxelLabel::diploe || layer.label == VoxelLabel::inner_table;
  });
}

}  // namespace

std::optional<TableView> find_table(const DisplayConfig& display, const BoneModel& bone, const Pose& world_from_bone,
                                    const Pose& world_from_approach) {
  if (!display.table) return std::nullopt;
  const Bounds extent = find_extent(bone, world_from_bone, world_from_approach);
  const Vec3 half = 0.5 * (extent.hi - extent.lo);
  TableView out;
  out.normal = world_from_approach.rotate(Vec3(0, 0, 1));
  out.centre = middle_of(extent, world_from_approach);
  out.height = half.z + below_bone(display);
  out.offset = glm::dot(out.normal, out.centre) - half.z - below_bone(display);
  out.half_x = world_from_approach.rotate(Vec3(half.x, 0, 0));
  out.half_y = world_from_approach.rotate(Vec3(0, half.y, 0));
  if (display.drape) out.color = kClothColor;
  return out;
}

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
      at_rest_(world_from_bone),
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
  out.look_ = tool.look;
  out.surface_ = tool.surface;
  auto volume = out.make_levels(approach.bone_from_approach);
  if (!volume) return volume.error();
  out.find_outline();
  if (display.skin && display.skin->body)
    volume->skin = std::make_shared<const SkinView>(make_skin(*display.skin, approach.bone_from_approach));
  if (out.brain_) volume->note = std::string(has_layers(approach) ? "layers by label" : "layers by density") + "; dura and brain assumed";
  if (Status started = sink.start(*volume, tool.look); !started) return started.error();
  return out;
}

Result<VolumeView> FrameStep::make_levels(const Pose& bone_from_approach) {
  const BoneModel& bone = voxmap_->bone();
  const bool tissue = display_.appearance.tissue || draws_textures(display_);  // its bone as loaded shows what was cut
  const Surroundings* around = bone.surroundings();
  const int factor = around != nullptr ? around->factor : coarse_factor(bone.dims(), display_.whole_voxels);
  const double edge = bone.bone_from_index().mean_edge();
  if (factor == 1) {
    if (display_.assumed_brain) brain_ = AssumedBrain::create(bone, bone_from_approach, thickness_, edge);
    VolumeView whole = make_volume_view(*voxmap_, tissue);
    if (brain_) brain_->add_to(whole);
    return whole;
  }
  if (around != nullptr) {
    coarse_ = CoarseBone::around(*around);
  } else {
    auto coarse = CoarseBone::create(bone, factor);
    if (!coarse) return coarse.error();
    coarse_ = std::move(coarse).value();
  }
  VolumeView whole = make_volume_view(coarse_->drawn(*voxmap_), coarse_->loaded().bounds(), tissue);
  if (display_.assumed_brain)
    brain_ = AssumedBrain::create(coarse_->loaded(), bone_from_approach, thickness_, draws_detail(display_) ? edge : factor * edge);
  if (brain_) brain_->add_to(whole);
  if (display_.drape && around != nullptr)
    add_drape(*display_.drape, bone_from_approach, around->region, factor,
              find_extent(bone, world_from_bone_, world_from_approach_).lo.z - below_bone(display_), whole);
  if (!draws_detail(display_)) return whole;
  const Affine& affine = bone.bone_from_index();
  detail_ = around != nullptr
                ? DetailGrid{around->region, factor}
                : place_detail(bone.dims(), factor, affine.inverse() * bone_from_approach.translation, detail_edge(display_, affine));
  whole.detail = std::make_shared<const DetailView>(make_detail());
  return whole;
}

DetailView FrameStep::make_detail() const {
  DetailView out = make_detail_view(*detail_, *coarse_, *voxmap_, display_.appearance.tissue);
  if (brain_) brain_->add_to(out.volume);
  return out;
}

/// Moves the detail to where bone is cut, once that is no longer inside it.
void FrameStep::follow(const VoxelBox& changed) {
  if (!detail_ || changed.empty() || voxmap_->bone().surroundings() != nullptr) return;  // there is no bone elsewhere
  const VoxelBox box = changed.intersect(voxmap_->bone().bounds());
  const Vec3i size = detail_->box.size();
  // A change larger than a detail is no cut: bone was restored, or the window reloaded.
  if (box.empty() || glm::any(glm::greaterThan(2 * box.size(), size)) || !is_blended(*detail_, box)) return;
  const DetailGrid moved = place_detail(voxmap_->bone().dims(), detail_->factor, 0.5 * Vec3(box.lo + box.hi - 1), Vec3(size - 1));
  // At an end of the bone, or in one that is thinner than a detail, there may be no better place.
  const auto depth = [&](const DetailGrid& grid) {
    const Vec3i inside = glm::min(box.lo - grid.box.lo, grid.box.hi - box.hi);
    return std::min({inside.x, inside.y, inside.z});
  };
  if (depth(moved) < depth(*detail_) + 2 * moved.factor) return;
  detail_ = moved;
  moved_ = make_detail();
  // The new detail has all changes of bone so far.
  for (std::size_t n = 0; n < filled_; ++n) batch_[n].own.box = {};
  for (const SoftTop* top : soft_tops_) add_changed(top->extent());
}

void FrameStep::read_change(const VoxelBox& box, Change& out) const {
  out.own.box = out.coarse.box = {};
  if (!coarse_) return read_texel_source(drawn_bone(*voxmap_), box, out.own);
  // A density and the normals next to it.
  VoxelBox coarse = coarse_->coarse_of(box).grown(1).intersect(coarse_->loaded().bounds());
  const VoxelBox own = detail_ ? detail_of(*detail_, box) : VoxelBox{};
  if (!own.empty()) {
    read_texel_source(drawn_bone(*voxmap_), own, out.own);
    if (is_blended(*detail_, own)) coarse = coarse.unite(coarse_around(*detail_, own, coarse_->loaded().dims()));
  }
  read_texel_source(coarse_->drawn(*voxmap_), coarse, out.coarse);
}

void FrameStep::make_change(const Change& change, std::vector<TexelBox>& out) const {
  const float dead_zone = voxmap_->config().gradient_dead_zone;
  if (!coarse_) {
    out.push_back(make_texels(voxmap_->bone(), dead_zone, change.own, soft_tops_));
    if (brain_) brain_->add_to(out.back(), voxmap_->bone().bone_from_index());
    return;
  }
  out.push_back(make_texels(coarse_->loaded(), dead_zone, change.coarse, soft_tops_));
  if (brain_) brain_->add_to(out.back(), coarse_->loaded().bone_from_index());
  if (change.own.box.empty()) return;
  TexelBox own = make_texels(voxmap_->bone(), dead_zone, change.own, soft_tops_);
  if (is_blended(*detail_, own.box)) blend_with_coarse(*detail_, out.back(), own);
  if (brain_) brain_->add_to(own, voxmap_->bone().bone_from_index());
  own.box = {own.box.lo - detail_->box.lo, own.box.hi - detail_->box.lo};
  own.of_detail = true;
  out.push_back(std::move(own));
}

void FrameStep::gather(double turned) {
  turned_ = turned;
  fill_batch(display_.upload_budget / kTexelBytes, display_.upload_time, false);
}

void FrameStep::gather_rest(double turned) {
  turned_ = turned;
  fill_batch(std::numeric_limits<std::size_t>::max(), 0.0, true);
}

/// @param box [m] bone frame, of texels to be made anew.
void FrameStep::add_changed(const Bounds& box) {
  if (!glm::all(glm::lessThanEqual(box.lo, box.hi))) return;
  const auto [lo, hi] = bounds_under(voxmap_->bone().bone_from_index().inverse(), box);
  queue_.add(VoxelBox{floor_int(lo) - 1, floor_int(hi) + 3}.intersect(voxmap_->bone().bounds()));
}

void FrameStep::copy_sources(bool exactly) {
  if (sources_.empty()) return;
  soft_tops_.clear();
  for (PictureSource* source : sources_) {
    added_changed_ = source->copy_for_picture(exactly) || added_changed_;
    const SoftTop* top = source->soft_top();
    if (top == nullptr) continue;
    soft_tops_.push_back(top);
    add_changed(top->changed());
  }
}

Status FrameStep::send_added() {
  if (!std::exchange(added_changed_, false)) return {};
  auto mesh = std::make_shared<AddedMesh>();
  for (const PictureSource* source : sources_) source->append_mesh(*mesh);
  return sink_->set_added(mesh->triangles.empty() ? nullptr : std::move(mesh));
}

/// @param seconds 0: no limit.
void FrameStep::fill_batch(std::size_t most, double seconds, bool exactly) {
  constexpr std::size_t kBetweenChecks = 4096;  // texels, a fraction of a millisecond
  make_time_ = seconds;
  copy_sources(exactly);
  timers_.texels([&] {
    for (const VoxelBox& box : voxmap_->take_dirty(listener_)) {
      queue_.add(box.intersect(voxmap_->bone().bounds()));
      follow(box);
    }
    const auto end = in_seconds(seconds);
    const std::size_t chunk = seconds > 0.0 ? std::min(most, kBetweenChecks) : most;
    std::size_t left = most - std::min(most, texels_in_batch());
    if (left == 0) return;
    do {
      for (const VoxelBox& box : queue_.take(chunk)) {
        if (filled_ == batch_.size()) batch_.emplace_back();
        read_change(box, batch_[filled_++]);
        left -= std::min(left, batch_[filled_ - 1].texels());
      }
    } while (seconds > 0.0 && !queue_.empty() && left >= chunk && Clock::now() < end);
  });
  has_grown_ = has_grown_ || voxmap_->growth_epoch() != growth_epoch_;
  growth_epoch_ = voxmap_->growth_epoch();
}

std::size_t FrameStep::texels_in_batch() const noexcept {
  std::size_t sum = 0;
  for (std::size_t n = 0; n < filled_; ++n) sum += batch_[n].texels();
  return sum;
}

/// Makes the texels of the batch and sends them. Boxes for which no time is left stay in the batch.
Status FrameStep::send_batch() {
  if (moved_) {
    const Status moved = sink_->move_detail(*std::exchange(moved_, std::nullopt));
    if (!moved) return moved;
  }
  std::vector<TexelBox> made;
  std::size_t sources = 0;
  timers_.texels([&] {
    const auto end = in_seconds(make_time_);
    while (sources < filled_ && (sources == 0 || make_time_ == 0.0 || Clock::now() < end)) make_change(batch_[sources++], made);
  });
  const auto first = batch_.begin(), sent = first + static_cast<std::ptrdiff_t>(sources);
  std::rotate(first, sent, first + static_cast<std::ptrdiff_t>(filled_));
  filled_ -= sources;
  timers_.upload([&] {
    for (const TexelBox& texels : made) {
      texels_sent_ += texels.normal_opacity.size();
      sink_->update(texels);
    }
  });
  return {};
}

FrameView FrameStep::view_of(const std::optional<Pose>& world_from_tool, bool cut, bool overview) const {
  // The camera stays in the world; a cut through the approach, and the camera before it, go with the bone.
  const Pose world_from_approach = cut ? world_from_bone_ * at_rest_.inverse() * world_from_approach_ : world_from_approach_;
  FrameView view = make_frame_view(display_, world_from_bone_, world_from_approach, thickness_, cut);
  view.table = find_table(display_, voxmap_->bone(), world_from_bone_, world_from_approach_);
  if (overview) {
    const Vec3 direction = glm::normalize(view.camera.eye - view.camera.target);
    view.camera.target = middle_of(find_extent(voxmap_->bone(), world_from_bone_, world_from_approach_), world_from_approach_);
    view.camera.eye = view.camera.target + *display_.overview * direction;
  }
  if (world_from_tool) view.world_from_tool = turns_ ? turned_tool(*world_from_tool, turned_) : *world_from_tool;
  const Vec3 tip = world_from_tool ? world_from_tool->translation : tip_;
  if (!cut) view.cut = make_scene_cut(display_.cut, view.camera, world_from_bone_, tip);
  return view;
}

/// What the inset shows: the bone; a cloth and skin reach further, to about the corners of its box.
void FrameStep::find_outline() {
  if (!display_.inset || !coarse_) return;
  outline_ = outline_points(coarse_->loaded());
  if (!display_.drape && !display_.skin) return;
  const Pose bone_from_approach = world_from_bone_.inverse() * world_from_approach_;
  for (const Vec3& corner : find_extent(voxmap_->bone(), world_from_bone_, world_from_approach_).corners())
    outline_.push_back(bone_from_approach * corner);
}

/// @returns a camera in the direction of a view that sees all of a head; nothing if the bone is drawn as a whole in each picture.
std::optional<CameraView> FrameStep::inset_of(const FrameView& view) const {
  if (outline_.empty()) return std::nullopt;
  std::vector<Vec3> shown;
  for (const Vec3& p : outline_) shown.push_back(world_from_bone_ * p);
  CameraView out = view.camera;
  fit_camera(out, shown, static_cast<double>(display_.width) / display_.height);
  return out;
}

Status FrameStep::send_changes() {
  if (has_grown_) sink_->forget();
  if (Status sent = send_batch(); !sent) return sent;
  has_grown_ = has_grown_ && (filled_ > 0 || !queue_.empty());  // boxes that are not sent yet may have grown
  return send_added();
}

Status FrameStep::film(const Pose& world_from_tool) {
  if (Status sent = send_changes(); !sent) return sent;
  const FrameView view = view_of(world_from_tool, false);
  return timers_.frame([&] { return sink_->film(view, display_.width, display_.height); });
}

Status FrameStep::draw_view(const std::string& name, const FrameView& view, Hash64& hash) {
  return timers_.frame([&] { return sink_->draw(name, view, display_.width, display_.height, hash); });
}

/// Draws a section, with the bit cut by its plane.
Status FrameStep::draw_section(const std::string& name, FrameView view, Hash64& hash) {
  constexpr double kBefore = 2e-5;  // [m] of the section of the bit before that of the bone, which is in the same plane
  const Pose& pose = *view.world_from_tool;
  SectionParts parts;
  if (surface_ != nullptr) parts = {surface_->region_heights(), [this](const Vec3& p) { return surface_->cuts_at(p); }};
  const TriangleMesh cut =
      cut_mesh(look_, pose.inverse().rotate(view.cut->normal), view.cut->offset - glm::dot(view.cut->normal, pose.translation) + kBefore,
               surface_ != nullptr ? &parts : nullptr);
  if (cut.indices.empty()) {
    view.world_from_tool.reset();
    return draw_view(name, view, hash);
  }
  if (Status set = sink_->change_tool(cut); !set) return set;
  const Status drawn = draw_view(name, view, hash);
  const Status restored = sink_->change_tool(look_);
  return drawn ? restored : drawn;
}

Status FrameStep::draw(const std::string& name, const std::optional<Pose>& world_from_tool, bool cut) {
  if (Status sent = send_changes(); !sent) return sent;
  const bool overview = display_.overview && (display_.only_overviews || name == kOverview);
  FrameView view = view_of(world_from_tool, cut, overview);
  if (!overview) view.inset = inset_of(view);
  if (world_from_tool) tip_ = world_from_tool->translation;
  Hash64 picture;
  const bool section = cut && world_from_tool && view.cut;
  if (Status drawn = section ? draw_section(name, view, picture) : draw_view(name, view, picture); !drawn) return drawn;
  picture_hash_ = picture.value();
  hash_.add(picture_hash_);
  return {};
}

}  // namespace burrhole
