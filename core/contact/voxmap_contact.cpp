#include "core/contact/voxmap_contact.h"

#include <cmath>

namespace burrhole {
namespace {

/// [Petersik03] magnitude and direction: u = S / |S| with S the sum of the vectors d N, and m = the longest projection of one of them on u.
struct Longest {
  Vec3 direction{0.0};
  double length = 0.0;
  double sum_length = 0.0;
  const Contact* contact = nullptr;
};

Longest longest_projection(const std::vector<Contact>& contacts, const Vec3& sum) noexcept {
  Longest out;
  out.sum_length = glm::length(sum);
  double largest = 0.0;
  for (const Contact& contact : contacts) largest = std::max(largest, contact.depth);
  // Points that cancel leave rounding of the largest vector, with an undefined direction.
  if (!(out.sum_length > 1e-12 * largest)) return out;
  out.direction = sum / out.sum_length;
  for (const Contact& contact : contacts) {
    const double length = contact.depth * glm::dot(contact.normal, out.direction);
    if (length <= out.length) continue;
    out.length = length;
    out.contact = &contact;
  }
  return out;
}

/// d (m u) / d x, own derivation: with A = sum N N^T over points at depth, dS = -A dx, du = (I - u u^T) dS / |S|, and for the longest
/// vector d N of the sum m = d N.u, dm = d N.du - (N.u) N.dx.
Mat3 longest_gradient(const Longest& longest, const Mat3& spread) noexcept {
  const Vec3& u = longest.direction;
  const Mat3 turn = (glm::outerProduct(u, u) - Mat3(1.0)) * spread * (1.0 / longest.sum_length);
  const Contact& c = *longest.contact;
  const Vec3 slope = c.depth * (c.normal * turn) - glm::dot(c.normal, u) * c.normal;  // v * M is M^T v
  return glm::outerProduct(u, slope) + turn * longest.length;
}

}  // namespace

Result<std::unique_ptr<PenaltyModel>> VoxmapContact::create(const VoxmapContactConfig& config, PointShell shell) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(std::isfinite(config.stiffness) && config.stiffness > 0.0)) return refuse("contact stiffness must be finite and above 0");
  if (config.max_march < 1) return refuse("march limits must be at least 1");
  if (shell.size() == 0 || shell.size() > kMaxShellPoints) return refuse("the point shell must hold 1 to 200000 points");
  if (shell.inward_normals.size() != shell.size()) return refuse("a point shell needs one inward normal a point");
  return std::unique_ptr<PenaltyModel>(new VoxmapContact(config, std::move(shell)));
}

std::uint32_t VoxmapContact::find_surface(const ContactView& bone, const Vec3& index, const Vec3& step, Vec3i& voxel) const noexcept {
  Vec3 at = index;
  for (int marched = 0; marched < config_.max_march; ++marched) {
    at += step;
    const Vec3i v = voxel_of(at);
    if (!bone.knows(v)) return kContactOutsideWindow;
    if (!solid(bone.density(v))) return 0;
    voxel = v;
  }
  return kContactNoSurface;
}

void VoxmapContact::evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept {
  if (!begin_evaluation(world_from_tool, out)) return;
  // Most points are in air: one map gives their voxels, and only colliding points compute more.
  const Mat3 rotation = glm::mat3_cast(world_from_tool.rotation);
  const Affine index_from_tool{{bone.index_direction(rotation[0]), bone.index_direction(rotation[1]), bone.index_direction(rotation[2])},
                               bone.index_of(world_from_tool.translation)};
  for (std::size_t n = 0; n < shell_.size(); ++n) {
    const Vec3 index = index_from_tool * shell_.positions[n];
    if (!holds_index(index)) {
      out.flags |= kContactOutsideWindow;
      continue;
    }
    Vec3i voxel = voxel_of(index);
    if (!bone.knows(voxel)) {
      out.flags |= kContactOutsideWindow;
      continue;
    }
    if (!solid(bone.density(voxel))) continue;
    if (config_.plane_voxel == PlaneVoxel::surface) {
      const Vec3 along = index_from_tool.linear * shell_.inward_normals[n];
      if (const std::uint32_t why = find_surface(bone, index, along / glm::length(along), voxel); why != 0) {
        out.flags |= why;
        continue;
      }
    }
    const Vec3 position = rotation * shell_.positions[n] + world_from_tool.translation;  // P_h
    const Vec3 normal = rotation * shell_.inward_normals[n];
    const Vec3 centre = bone.world_of(Vec3(voxel));
    const double depth = std::max(0.0, glm::dot(centre - position, normal));  // below the plane through the centre
    out.contacts.push_back({static_cast<std::uint32_t>(n), position, centre, normal, depth});
    out.deepest = std::max(out.deepest, depth);
  }
  out.touching = out.contacts.size();
  if (!out.contacts.empty()) stack(out, world_from_tool.translation);
}

void VoxmapContact::stack(ContactResult& out, const Vec3& tool_origin) const noexcept {
  Wrench sum;  // of depths, before stiffness and share
  Mat3 spread(0.0);
  for (const Contact& contact : out.contacts) {
    const Vec3 vector = contact.normal * contact.depth;
    sum.force += vector;
    sum.torque += glm::cross(contact.position - tool_origin, vector);
    if (contact.depth > 0.0) spread += glm::outerProduct(contact.normal, contact.normal);
  }
  const auto n = static_cast<double>(out.contacts.size());
  double share = 1.0;
  switch (config_.stacking) {
    case Stacking::sum:
      break;
    case Stacking::sum_limited:
      share = n > 10.0 ? 10.0 / n : 1.0;
      break;
    case Stacking::average:
      share = 1.0 / n;
      break;
    case Stacking::deepest: {
      const Longest longest = longest_projection(out.contacts, sum.force);
      if (longest.contact == nullptr) return;
      const double scale = config_.stiffness * longest.length / longest.sum_length;
      out.wrench = {sum.force * scale, sum.torque * scale};
      out.force_gradient = longest_gradient(longest, spread) * config_.stiffness;
      return;
    }
  }
  const double stiffness = config_.stiffness * share;
  out.wrench = {sum.force * stiffness, sum.torque * stiffness};
  out.force_gradient = spread * -stiffness;
}

}  // namespace burrhole
