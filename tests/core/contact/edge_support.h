/// tests/core/contact/edge_support.h: shipped bits over edges, corners and rims of bone, and the height at which they touch first.
///   Frame  as named.   Units  SI.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/tool/point_shell.h"
#include "core/tool/tool_surface.h"
#include "surface_support.h"
#include "tool_solid.h"

namespace burrhole::contact_test {

/// A shipped bit: its solid, its surface, and the shell points below a height, because far up the shaft the window of a test ends.
struct Bit {
  std::string name;
  PointShell shell;
  std::shared_ptr<const ToolSurface> surface;
  ToolSolid solid;
  /// @param height [m] above the tip. @param finer the gaps between shell points are divided by it.
  explicit Bit(const std::string& n, double height = 6e-3, int finer = 1) : name(n), solid(n) {
    ToolSpec spec = test::shipped_spec(n);
    for (RegionSpec& region : spec.regions) {
      region.shell.pitch /= finer;
      region.shell.voxel /= finer;
      region.shell.stacks *= finer;
      region.shell.slices *= finer;
    }
    surface = std::make_shared<const ToolSurface>(spec);
    const auto whole = make_point_shell(spec);
    REQUIRE(whole.ok());
    const PointShell& all = whole.value();
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all.positions[k].z > height) continue;
      shell.positions.push_back(all.positions[k]);
      shell.inward_normals.push_back(all.inward_normals[k]);
      shell.cutting.push_back(all.cutting[k]);
    }
  }
};

/// A shape of bone under a tool.
struct Place {
  std::string name;
  PhantomSpec spec;
  bool smooth = false;
  Vec3 site{0.0};  ///< [m] bone frame: the point that is the origin of the world
};

inline PhantomSpec edge_spec(PhantomKind kind, double edge, const Vec3& extent) {
  PhantomSpec spec = spec_of(kind);
  spec.pitch = edge;
  spec.extent = extent;
  return spec;
}

/// [m] Depth in the solid of the deepest of some points; below 0 if none is inside, -1e9 if none is near. Points in the world frame.
inline double deepest_inside(const ToolSolid& solid, const std::vector<Vec3>& points, const Pose& world_from_tool) {
  double out = -1e9;
  const Pose back = world_from_tool.inverse();
  for (const Vec3& p : points) {
    const Vec3 q = back * p;
    if (!solid.near(q, std::max(0.0, -out))) continue;
    out = std::max(out, -solid.distance(q));
  }
  return out;
}

/// [m] The lowest height of the tip, to 0.3 um, at which nothing is inside the solid. @param at its x and y; z is not read.
inline double first_touch(const ToolSolid& solid, const std::vector<Vec3>& points, const Quat& turn, const Vec3& at) {
  double lo = -8e-3, hi = 8e-3;
  for (int n = 0; n < 16; ++n) (deepest_inside(solid, points, {turn, Vec3(at.x, at.y, 0.5 * (lo + hi))}) > 0.0 ? lo : hi) = 0.5 * (lo + hi);
  return hi;
}

/// A tool that leans towards +x, and a little aside of it.
inline Quat leaning(double angle) { return glm::angleAxis(angle, glm::normalize(Vec3(0.3, 1.0, 0.0))); }

}  // namespace burrhole::contact_test
