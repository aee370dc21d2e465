#include "app/view/skin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/view/site_window.h"
#include "app/view/surface_nets.h"

namespace burrhole {
namespace {

constexpr double kRimDepth = 11e-3;            // [m] of the cut edge below the surface, so that its lower end is in bone
constexpr double kAbove = 0.05, kFall = 1e-3;  // [m] where the search of the surface starts above the entry, and its step
constexpr int kSpokes = 120;                   // of the cut edge
constexpr float kFar = 1.0f;                   // [m] beyond the opening, on the other side of the head

/// @returns the distance from the axis at which the direction `way`, in the approach frame, meets the edge of the opening.
double edge_along(const SiteWindow& window, const Vec3& way) {
  double inside = 0.0, outside = window.width;
  for (int n = 0; n < 40; ++n) {
    const double middle = 0.5 * (inside + outside);
    (window.beyond(middle * way) < 0.0 ? inside : outside) = middle;
  }
  return outside;
}

/// @returns the height over the entry, along the approach axis, at which the surface lies over p; nothing if it is not near.
std::optional<double> surface_over(const SkinConfig& skin, const Pose& bone_from_approach, const Vec3& p) {
  const auto inside = [&](double z) { return skin.body(bone_from_approach * Vec3(p.x, p.y, z)) < 0.0; };
  const double lowest = -0.5 * skin.window;
  double z = kAbove;
  while (z > lowest && !inside(z)) z -= kFall;
  if (z <= lowest || z == kAbove) return std::nullopt;
  double low = z, high = z + kFall;
  for (int n = 0; n < 20; ++n) {
    const double middle = 0.5 * (low + high);
    (inside(middle) ? low : high) = middle;
  }
  return high;
}

void add_rim(const SkinConfig& skin, const SiteWindow& window, const Pose& bone_from_approach, SkinView& out) {
  std::vector<bool> found;
  for (int n = 0; n <= kSpokes; ++n) {
    const double angle = 2.0 * std::numbers::pi * (n % kSpokes) / kSpokes;
    const Vec3 way(std::cos(angle), std::sin(angle), 0.0), p = edge_along(window, way) * way;
    const auto top = surface_over(skin, bone_from_approach, p);
    found.push_back(top.has_value());
    for (const double share : {0.0, 1.0}) {
      out.rim.positions.emplace_back(bone_from_approach * Vec3(p.x, p.y, top.value_or(0.0) - share * kRimDepth));
      out.rim.normals.emplace_back(bone_from_approach.rotate(-way));
      out.depth.push_back(static_cast<float>(share));
    }
  }
  for (std::uint32_t n = 0; n < kSpokes; ++n)
    if (found[n] && found[n + 1])
      for (const std::uint32_t corner : {0, 1, 3, 0, 3, 2}) out.rim.indices.push_back(2 * n + corner);
}

}  // namespace

SkinView make_skin(const SkinConfig& skin, const Pose& bone_from_approach) {
  SkinView out;
  out.color = skin.color;
  out.opacity = skin.opacity;
  out.shell = make_surface_mesh(skin.body, skin.box, skin.pitch);
  const SiteWindow window{skin.window, skin.round};
  const Pose approach_from_bone = bone_from_approach.inverse();
  out.beyond.reserve(out.shell.positions.size());
  for (const Vec3f& p_bone : out.shell.positions) {
    const Vec3 p = approach_from_bone * Vec3(p_bone);
    out.beyond.push_back(p.z > -0.5 * skin.window ? static_cast<float>(window.beyond(p)) : kFar);
  }
  std::vector<std::uint32_t> kept;
  for (std::size_t n = 0; n + 2 < out.shell.indices.size(); n += 3) {
    const std::uint32_t* corner = out.shell.indices.data() + n;
    const auto [least, most] = std::minmax({out.beyond[corner[0]], out.beyond[corner[1]], out.beyond[corner[2]]});
    if (most < 0.0f || (skin.reach && static_cast<double>(least) > *skin.reach)) continue;
    kept.insert(kept.end(), corner, corner + 3);
  }
  out.shell.indices = std::move(kept);
  add_rim(skin, window, bone_from_approach, out);
  return out;
}

}  // namespace burrhole
