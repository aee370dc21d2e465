/// tests/core/tool/tool_samples.h: specs made in code, so that geometry is tested apart from the file format; random points inside a box.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/random.h"
#include "core/tool/tool_spec.h"

namespace burrhole::test {

inline constexpr double kPi = std::numbers::pi;

/// One region sampled by pitch.
inline RegionSpec region(const Solid& solid, double factor, double pitch) {
  RegionSpec spec;
  spec.solid = solid;
  spec.erosion.base = factor;
  spec.shell.pitch = pitch;
  return spec;
}

inline ToolSpec tool_of(std::vector<RegionSpec> regions) {
  ToolSpec spec;
  spec.regions = std::move(regions);
  auto outline = make_outline(spec.solids());
  REQUIRE(outline.ok());
  spec.outline = std::move(outline).value();
  return spec;
}

/// The perforator of two stacked cylinders: 11 mm for 3 mm, then 14 mm for 9 mm.
inline ToolSpec perforator(double pitch) {
  return tool_of({region(make_cylinder(0.0, 3e-3, 5.5e-3), 0.028, pitch), region(make_cylinder(3e-3, 9e-3, 7e-3), 0.14, pitch)});
}

/// Sphere of 4 mm on a thin passive shank that begins inside it.
inline ToolSpec burr(double pitch) {
  return tool_of({region(make_sphere(0.0, 2e-3), 0.1, pitch), region(make_cylinder(2.4e-3, 8e-3, 0.9e-3), 0.0, pitch)});
}

/// Crown of 12/10 mm with a relieved wall, a cap and a shank: its line goes down the bore and up the outer wall.
inline ToolSpec trephine(double pitch) {
  return tool_of(
      {region(make_tube({.z_low = 0.0, .height = 3e-3, .low_radius = 6e-3, .high_radius = 6e-3}, {5e-3, 5e-3}), 0.1, pitch),
       region(make_tube({.z_low = 3e-3, .height = 6e-3, .low_radius = 5.8e-3, .high_radius = 5.8e-3}, {5.2e-3, 5e-3}), 0.0, pitch),
       region(make_cylinder(9e-3, 2e-3, 5.8e-3), 0.0, pitch), region(make_cylinder(11e-3, 4e-3, 3e-3), 0.0, pitch)});
}

/// A tube alone, widening upwards: its line closes on itself.
inline ToolSpec ring(double pitch) {
  return tool_of({region(make_tube({.z_low = 0.0, .height = 4e-3, .low_radius = 3e-3, .high_radius = 4e-3}, {2e-3, 2.5e-3}), 0.1, pitch)});
}

/// A blade of two boxes with an active edge, in a round hub that it runs into.
inline ToolSpec saw(double pitch) {
  ToolSpec spec = tool_of({region(make_box({.z_low = 0.0, .height = 1.5e-3, .size = {12e-3, 0.6e-3}}), 0.1, pitch),
                           region(make_box({.z_low = 1.5e-3, .height = 9e-3, .size = {12e-3, 0.4e-3}}), 0.0, pitch),
                           region(make_cylinder(8e-3, 5e-3, 4e-3), 0.0, pitch)});
  spec.regions[0].erosion.side = spec.regions[0].erosion.top = 0.0;
  spec.regions[0].erosion.flanks.fill(0.0);
  spec.regions[0].erosion.skin = 0.02e-3;
  return spec;
}

/// Point of a box, by counter.
inline Vec3 random_point(std::uint64_t seed, std::uint64_t counter, const Vec3& lo, const Vec3& hi) {
  const Vec3 u(uniform01(seed, 3 * counter), uniform01(seed, 3 * counter + 1), uniform01(seed, 3 * counter + 2));
  return lo + u * (hi - lo);
}

inline bool inside_any(const ToolSpec& spec, const Vec3& p) { return spec.region_at(p).has_value(); }

}  // namespace burrhole::test
