#include "core/contact/gradient_plane.h"

#include <array>
#include <cmath>

namespace burrhole {

/// A surface voxel, the plane point it returns (index coordinates) and its density gradient.
struct GradientPlane::Surface {
  Vec3i voxel{0};
  Vec3 plane_point{0.0};
  Vec3f gradient{0.0f};
};

Result<std::unique_ptr<PenaltyModel>> GradientPlane::create(const GradientPlaneConfig& config, PointShell shell) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (!(std::isfinite(config.stiffness) && config.stiffness > 0.0)) return refuse("contact stiffness must be finite and above 0");
  if (config.max_march < 1 || config.max_ascent < 1) return refuse("march limits must be at least 1");
  if (shell.size() == 0 || shell.size() > kMaxShellPoints) return refuse("the point shell must hold 1 to 200000 points");
  if (shell.inward_normals.size() != shell.size()) return refuse("a point shell needs one inward normal a point");
  return std::unique_ptr<PenaltyModel>(new GradientPlane(config, std::move(shell)));
}

bool GradientPlane::solid(const ContactView& bone, const Vec3i& v) const noexcept {
  const float density = bone.density(v);
  return config_.paper_mode ? density > 0.0f : density >= kSurfaceLevel;
}

bool GradientPlane::collides(const ContactView& bone, const Vec3& index) const noexcept {
  return config_.paper_mode ? bone.density(voxel_of(index)) > 0.0f : bone.sample(index) >= kSurfaceLevel;
}

namespace {

Vec3 densest_corner(const ContactView& bone, const Vec3& index) {
  const Vec3i base = floor_int(index);
  Vec3i best = base;
  for_each_voxel({base, base + 2}, [&](const Vec3i& v) {
    if (bone.density(v) > bone.density(best)) best = v;
  });
  return Vec3(best);
}

/// [AcostaLiu07] figure 5a: on the facet when exactly one of six is exposed, the voxel centre otherwise. `is_solid(v)` decides.
template <class IsSolid>
Vec3 plane_point_of(const Vec3i& v, IsSolid&& is_solid) {
  static constexpr std::array<std::array<int, 3>, 6> kFacets{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  int exposed = 0;
  Vec3 facet(0.0);
  for (const auto& f : kFacets) {
    const Vec3i step(f[0], f[1], f[2]);
    if (is_solid(v + step)) continue;
    ++exposed;
    facet = 0.5 * Vec3(step);
  }
  return Vec3(v) + (exposed == 1 ? facet : Vec3(0.0));
}

}  // namespace

bool GradientPlane::find_surface(const ContactView& bone, const Vec3& index, const Vec3& tool_vector, Surface& found) const noexcept {
  // The trilinear density may classify a point as solid although its voxel is empty; the densest corner of its cell is then solid.
  Vec3 at = solid(bone, voxel_of(index)) ? index : densest_corner(bone, index);
  Vec3i last_solid = voxel_of(at);

  // 1. March along the tool vector, voxel by voxel, to the first voxel with a gradient.
  int marched = 0;
  Vec3f gradient = bone.gradient(voxel_of(at));
  while (gradient == Vec3f(0.0f) && marched++ < config_.max_march) {
    at += tool_vector;
    const Vec3i v = voxel_of(at);
    gradient = bone.gradient(v);
    if (solid(bone, v))
      last_solid = v;
    else if (gradient == Vec3f(0.0f))
      break;  // left bone without a gradient: the last solid voxel is the surface
  }

  // 2. March down the density gradient to the last solid voxel before an empty one.
  int ascended = 0;
  while (solid(bone, voxel_of(at)) && ascended++ < config_.max_ascent) {
    last_solid = voxel_of(at);
    const Vec3f here = bone.gradient(last_solid);
    if (here != Vec3f(0.0f)) gradient = here;
    if (gradient == Vec3f(0.0f)) return false;
    at -= Vec3(gradient) / glm::length(Vec3(gradient));
  }
  if (solid(bone, voxel_of(at))) return false;

  found.voxel = last_solid;
  found.gradient = bone.gradient(last_solid);
  found.plane_point = plane_point_of(last_solid, [&](const Vec3i& v) { return solid(bone, v); });
  return true;
}

void GradientPlane::evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept {
  if (!begin_evaluation(world_from_tool, out)) return;
  if (bone.words() != nullptr)
    packed_.evaluate(config_, bone, world_from_tool, out);
  else
    evaluate_points(bone, world_from_tool, out);
}

void GradientPlane::evaluate_points(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept {
  const Mat3 rotation = glm::mat3_cast(world_from_tool.rotation);
  for (std::size_t n = 0; n < shell_.size(); ++n) {
    const Vec3 position = rotation * shell_.positions[n] + world_from_tool.translation;  // P_h
    const Vec3 index = bone.index_of(position);
    if (!holds_index(index) || !bone.knows(voxel_of(index))) {
      out.flags |= kContactOutsideWindow;
      continue;
    }
    if (!collides(bone, index)) continue;
    const Vec3 tool_vector = rotation * shell_.inward_normals[n];
    const Vec3 along = bone.index_direction(tool_vector);
    Surface surface;
    if (!find_surface(bone, index, along / glm::length(along), surface)) {
      out.flags |= kContactNoSurface;
      continue;
    }
    Vec3 normal = bone.outward_normal(Vec3(surface.gradient));
    if (normal == Vec3(0.0)) {
      normal = tool_vector;
      out.flags |= kContactZeroGradient;
    }
    const Vec3 plane_point = bone.world_of(surface.plane_point);
    const double depth = std::max(0.0, glm::dot(plane_point - position, normal));  // [AcostaLiu07] eq. 1, zero above the plane
    out.contacts.push_back({static_cast<std::uint32_t>(n), position, plane_point, normal, depth});
  }
  out.touching = out.contacts.size();
  if (out.contacts.empty()) return;

  const double share = 1.0 / static_cast<double>(out.contacts.size());  // the average over colliding points, d = 0 included
  for (const Contact& contact : out.contacts) {
    out.deepest = std::max(out.deepest, contact.depth);
    const Vec3 force = contact.normal * (contact.depth * config_.stiffness * share);  // eq. 2
    out.wrench.force += force;
    out.wrench.torque += glm::cross(contact.position - world_from_tool.translation, force);
    if (contact.depth > 0.0) out.force_gradient -= glm::outerProduct(contact.normal, contact.normal) * (config_.stiffness * share);
  }
}

}  // namespace burrhole
