#include "core/mesh/mesh_contact.h"

#include <cmath>
#include <limits>

#include "core/contact/nearest_triangle.h"

namespace burrhole {
namespace {

/// One point in bone: its depth and its triangle, in the frame of the patch.
struct Hit {
  const PatchTriangle* triangle = nullptr;
  double depth = 0.0;  // [m]
};

/// The points of a shell one after the other. A triangle near the last point bounds the search for the next, and its distance the depth.
class PointProbe {
 public:
  PointProbe(const ContactView& bone, const TrianglePatch& patch) noexcept : bone_(bone), patch_(patch) {}

  /// @param index [voxels] and in_patch [m] the point. @param least [m] lesser depths do not matter. @returns a hit without a triangle where
  /// the point is outside bone, or less deep.
  Hit probe(const Vec3& index, const Vec3& in_patch, double least, std::uint32_t& flags) noexcept {
    const PatchBlock& block = patch_.blocks[patch_.block_box().offset_of(patch_.block_of(voxel_of(index)))];
    if (!block.near_bone) return {};
    if (last_ != nullptr && last_depth_ + glm::length(in_patch - last_place_) < least) return {};
    const double bound2 = last_ != nullptr ? distance2_to(*last_, in_patch) : std::numeric_limits<double>::infinity();
    const NearestTriangle nearest = find_nearest(patch_, in_patch, bound2);
    if (nearest.triangle == nullptr) {
      if (bone_.sample(index) >= kSurfaceLevel) flags |= kContactNoSurface;
      return {};
    }
    last_ = nearest.triangle;
    // The mesh is nowhere a voxel away from the 0.5 surface. Farther off the density decides, which has no open edge where the patch ends.
    const double edge = bone_.voxel_edge();
    const bool inside = nearest.distance2 > edge * edge ? bone_.sample(index) >= kSurfaceLevel : nearest.inside;
    last_place_ = in_patch;
    last_depth_ = inside ? std::sqrt(nearest.distance2) : -std::sqrt(nearest.distance2);
    if (!inside) return {};
    return {nearest.triangle, std::max(0.0, nearest.depth)};
  }

 private:
  const ContactView& bone_;
  const TrianglePatch& patch_;
  const PatchTriangle* last_ = nullptr;
  Vec3 last_place_{0.0};
  double last_depth_ = 0.0;  // [m] distance from the surface, < 0 outside: between two points it changes by no more than their distance
};

/// Adds one contact's share to force, torque and gradient. [TellesONeill10] Eq. (1)
void push(const Contact& contact, double stiffness, const Vec3& tool_origin, ContactResult& out) noexcept {
  const Vec3 force = contact.normal * (contact.depth * stiffness);
  out.wrench.force += force;
  out.wrench.torque += glm::cross(contact.position - tool_origin, force);
  if (contact.depth > 0.0) out.force_gradient -= glm::outerProduct(contact.normal, contact.normal) * stiffness;
}

}  // namespace

Result<std::unique_ptr<PenaltyModel>> MeshContact::create(const MeshContactConfig& config, PointShell shell) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(std::isfinite(config.stiffness) && config.stiffness > 0.0)) return refuse("contact stiffness must be finite and above 0");
  if (shell.size() == 0 || shell.size() > kMaxShellPoints) return refuse("the point shell must hold 1 to 200000 points");
  return std::unique_ptr<PenaltyModel>(new MeshContact(config, std::move(shell)));
}

void MeshContact::evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept {
  if (!begin_evaluation(world_from_tool, out)) return;
  const TrianglePatch* patch = bone.triangles();
  if (patch == nullptr) {
    out.flags = kContactOutsideWindow;  // nothing has been published
    return;
  }
  const Pose& world_from_bone = bone.world_from_bone();
  const Pose bone_from_tool = world_from_bone.inverse() * world_from_tool;
  const Affine index_from_tool = bone.index_from_world() * Affine::from_pose(world_from_tool);
  const bool average = config_.stacking == MeshStacking::average;
  PointProbe points(bone, *patch);
  Contact deepest;
  for (std::size_t n = 0; n < shell_.size(); ++n) {
    const Vec3 index = index_from_tool * shell_.positions[n];
    if (!holds_index(index) || !bone.knows(voxel_of(index))) {
      out.flags |= kContactOutsideWindow;
      continue;
    }
    const Hit hit = points.probe(index, bone_from_tool * shell_.positions[n] - patch->origin, average ? 0.0 : deepest.depth, out.flags);
    if (hit.triangle == nullptr) continue;
    const Contact contact{static_cast<std::uint32_t>(n), world_from_tool * shell_.positions[n],
                          world_from_bone * (Vec3(hit.triangle->corners[0]) + patch->origin),
                          world_from_bone.rotate(Vec3(hit.triangle->normal)), hit.depth};
    if (out.touching == 0 || contact.depth > deepest.depth) deepest = contact;
    out.touching = average ? out.touching + 1 : 1;
    if (average) {
      push(contact, config_.stiffness, world_from_tool.translation, out);
      if (out.list_contacts) out.contacts.push_back(contact);
    }
  }
  if (out.touching == 0) return;
  out.deepest = deepest.depth;
  if (!average) {
    push(deepest, config_.stiffness, world_from_tool.translation, out);
    out.contacts.push_back(deepest);
    return;
  }
  const double share = 1.0 / static_cast<double>(out.touching);
  out.wrench.force *= share;
  out.wrench.torque *= share;
  out.force_gradient *= share;
}

}  // namespace burrhole
