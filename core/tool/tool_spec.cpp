#include "core/tool/tool_spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/base/units.h"

namespace burrhole {
namespace {

constexpr double kMaxDiameter_mm = 100.0;
constexpr double kMaxHeight_mm = 200.0;
constexpr double kMinLength_mm = 0.01;     // as of pitch_mm: a shell cannot resolve less
constexpr std::size_t kMostRegions = 128;  // the outline takes time by the cube of their number: 0.3 s for 128 that overlap

NumberRule length_mm(double max, std::optional<double> fallback = std::nullopt) {
  return {.fallback = fallback, .min = kMinLength_mm, .max = max, .to_si = kMillimetre};
}

NumberRule length_or_zero_mm(double max, std::optional<double> fallback = std::nullopt) {
  return {.fallback = fallback, .min = 0.0, .max = max, .to_si = kMillimetre};
}

/// A diameter at each end of the region; the keys are prefix + "bottom_diameter_mm" and prefix + "top_diameter_mm".
std::pair<double, double> read_end_radii(TableReader& region, const std::string& prefix, const char* of_what) {
  const auto read = [&](const char* end) {
    return 0.5 *
           region.number(prefix + end, length_or_zero_mm(kMaxDiameter_mm),
                         std::string("diameter of ") + of_what +
                             (std::string_view(end).starts_with("bottom") ? " at its lower end" : " at its upper end") + "; 0 for a point");
  };
  const double low = read("bottom_diameter_mm");
  return {low, read("top_diameter_mm")};
}

Solid read_frustum(TableReader& region, double z) {
  const auto [low, high] = read_end_radii(region, "", "the region");
  const double height = region.number("height_mm", length_mm(kMaxHeight_mm), "height of the region from its lower to its upper end");
  if (low <= 0.0 && high <= 0.0)
    region.fault("top_diameter_mm", "must be > 0 when bottom_diameter_mm is 0");
  else if (2.0 * std::max(low, high) < kMinLength_mm * kMillimetre)
    region.fault("top_diameter_mm", fmt::format("must be at least {:g} where bottom_diameter_mm is less", kMinLength_mm));
  return make_frustum({.z_low = z, .height = height, .low_radius = low, .high_radius = high});
}

/// A hollow cylinder by diameter_mm and inner_diameter_mm, or a conical one by the diameters at its ends.
Solid read_tube(TableReader& region, double z) {
  FrustumSize outer{.z_low = z};
  BoreSize bore;
  const bool conical = region.has("bottom_diameter_mm") || region.has("top_diameter_mm");
  const char* inner_key = conical ? "inner_top_diameter_mm" : "inner_diameter_mm";
  if (conical) {
    std::tie(outer.low_radius, outer.high_radius) = read_end_radii(region, "", "the outer wall");
    std::tie(bore.low_radius, bore.high_radius) = read_end_radii(region, "inner_", "the bore");
  } else {
    outer.low_radius = outer.high_radius = 0.5 * region.number("diameter_mm", length_mm(kMaxDiameter_mm), "outer diameter of the tube");
    bore.low_radius = bore.high_radius = 0.5 * region.number(inner_key, length_mm(kMaxDiameter_mm), "diameter of the bore");
  }
  outer.height = region.number("height_mm", length_mm(kMaxHeight_mm), "height of the region from its lower to its upper end");
  const double low_wall = outer.low_radius - bore.low_radius, high_wall = outer.high_radius - bore.high_radius;
  if (!region.has(inner_key)) return make_tube(outer, bore);  // already reported
  if (low_wall < 0.0 || high_wall < 0.0 || low_wall + high_wall <= 0.0)
    region.fault(inner_key, "leaves no wall: the bore must be narrower than the tube");
  else if (conical && bore.low_radius + bore.high_radius <= 0.0)
    region.fault(inner_key, "is 0 at both ends: that is a frustum");
  return make_tube(outer, bore);
}

Solid read_box(TableReader& region, double z) {
  BoxSize box{.z_low = z};
  box.size.x = region.number("width_mm", length_mm(kMaxDiameter_mm), "edge of the box along x");
  box.size.y = region.number("depth_mm", length_mm(kMaxDiameter_mm), "edge of the box along y");
  box.height = region.number("height_mm", length_mm(kMaxHeight_mm), "height of the region from its lower to its upper end");
  const NumberRule place{.fallback = 0.0, .min = -kMaxDiameter_mm, .max = kMaxDiameter_mm, .to_si = kMillimetre};
  box.centre.x = region.number("x_mm", place, "x of the middle of the box, tool frame");
  box.centre.y = region.number("y_mm", place, "y of the middle of the box, tool frame");
  return make_box(box);
}

Solid read_solid(TableReader& region) {
  const std::string shape = region.choice("shape", std::nullopt, {"cylinder", "cone", "frustum", "tube", "sphere", "ellipsoid", "box"},
                                          "primitive of the region; all except the box are solids of revolution about the tool's axis");
  const double z =
      region.number("z_mm", length_or_zero_mm(kMaxHeight_mm), "height of the region's lower end above the tip; 0 for the lowest region");
  if (shape == "frustum") return read_frustum(region, z);
  if (shape == "tube") return read_tube(region, z);
  if (shape == "box") return read_box(region, z);
  const double radius = 0.5 * region.number("diameter_mm", length_mm(kMaxDiameter_mm), "largest diameter");
  if (shape == "sphere") return make_sphere(z, radius);
  const double height = region.number("height_mm", length_mm(kMaxHeight_mm), "height of the region from its lower to its upper end");
  if (shape == "ellipsoid") return make_ellipsoid(z, height, radius);
  return shape == "cone" ? make_cone(z, height, radius) : make_cylinder(z, height, radius);
}

ErosionRule read_erosion(TableReader& region, const Solid& solid) {
  const auto multiplier = [&](const char* key, const char* about, double fallback = 1.0) {
    return region.number(key, {.fallback = fallback, .min = 0.0, .max = 100.0}, about);
  };
  ErosionRule law;
  law.base = region.number("erosion_factor", {.min = 0.0, .max = 100.0},
                           "removal rate x per revolution: k revolutions leave exp(-k x) of bone of hardness 1; 0: does not cut");
  law.axis =
      multiplier("axis_factor", "multiplies erosion_factor within axis_core_mm of the axis; from there it changes linearly to rim_factor");
  law.core =
      region.number("axis_core_mm", length_or_zero_mm(kMaxDiameter_mm, law.core / kMillimetre),
                    "radius about the axis within which axis_factor applies; voxels with an edge of at most 1.4 times it resolve it");
  law.rim = multiplier("rim_factor", "multiplies erosion_factor at the region's largest radius");
  law.interior = multiplier("interior_factor", "multiplies erosion_factor deeper than skin_mm below the surface");
  law.side = multiplier("side_factor", "multiplies erosion_factor near the side");
  if (solid.kind != SolidKind::ellipsoid) {
    law.bottom = multiplier("bottom_factor", "multiplies erosion_factor near the flat lower end");
    law.top = multiplier("top_factor", "multiplies erosion_factor near the flat upper end");
  }
  if (solid.bored()) law.inner = multiplier("inner_factor", "multiplies erosion_factor near the wall of the bore");
  law.flanks.fill(law.side);
  if (solid.kind == SolidKind::box) {
    constexpr std::array<std::pair<const char*, const char*>, 4> kFlanks{
        {{"minus_x_factor", "multiplies erosion_factor near the face towards -x; absent: side_factor"},
         {"plus_x_factor", "multiplies erosion_factor near the face towards +x; absent: side_factor"},
         {"minus_y_factor", "multiplies erosion_factor near the face towards -y; absent: side_factor"},
         {"plus_y_factor", "multiplies erosion_factor near the face towards +y; absent: side_factor"}}};
    for (std::size_t i = 0; i < law.flanks.size(); ++i) law.flanks[i] = multiplier(kFlanks[i].first, kFlanks[i].second, law.side);
  }
  law.skin = region.number("skin_mm", length_or_zero_mm(kMaxDiameter_mm, 0.5),
                           "depth below the surface down to which the factor of the nearest face applies");
  return law;
}

ShellSampling read_sampling(TableReader& region, double default_pitch) {
  ShellSampling shell;
  shell.stacks =
      static_cast<int>(region.integer("stacks", 0, 1, 1000, "rows of shell points along the side, as in [AcostaLiu07]; needs slices"));
  shell.slices = static_cast<int>(region.integer("slices", 0, 4, 4000, "shell points on the widest ring; needs stacks"));
  const bool pitched = region.has("pitch_mm");
  shell.voxel = region.number("voxel_mm", length_mm(20.0, 0.0),
                              "with stacks and slices: largest gap between rings on flat faces; absent: the gap along the rim");
  // 0 is outside the range: it means "as in [shell]" and is not a default of this key.
  shell.pitch = region.number("pitch_mm", {.fallback = 0.0, .min = 0.01, .max = 20.0, .to_si = kMillimetre},
                              "largest gap between shell points; absent: that of [shell]");
  if (!pitched) shell.pitch = default_pitch;
  const bool stacked = region.has("stacks");
  if (stacked != region.has("slices")) region.fault(stacked ? "stacks" : "slices", stacked ? "needs slices too" : "needs stacks too");
  if (stacked && pitched) region.fault("pitch_mm", "cannot stand beside stacks and slices");
  if (!stacked && region.has("voxel_mm")) region.fault("voxel_mm", "needs stacks and slices");
  if (!stacked && !pitched && default_pitch <= 0.0)
    region.fault("pitch_mm", "is missing: give it here or in [shell], or give stacks and slices");
  return shell;
}

double read_default_pitch(TableReader& root) {
  double pitch = 0.0;
  if (auto shell = root.table("shell", "sampling of the point shell, for regions with neither pitch_mm nor stacks")) {
    pitch = shell->number("pitch_mm", {.min = 0.01, .max = 20.0, .to_si = kMillimetre}, "largest gap between shell points");
    shell->finish();
  }
  return pitch;
}

/// Checks the regions as a whole; fills the outline.
void assemble(ToolSpec& spec, TableReader& root, std::vector<TableReader>& readers) {
  const auto lowest = std::min_element(spec.regions.begin(), spec.regions.end(),
                                       [](const RegionSpec& a, const RegionSpec& b) { return a.solid.z_low < b.solid.z_low; });
  if (lowest->solid.z_low != 0.0) {
    readers[static_cast<std::size_t>(lowest - spec.regions.begin())].fault("z_mm",
                                                                           "must be 0 for the lowest region: the tip is the origin");
    return;
  }
  Result<std::vector<OutlinePiece>> outline = make_outline(spec.solids());
  if (outline)
    spec.outline = std::move(outline).value();
  else
    root.fault("region", "is not a single body: " + outline.error().message);
}

}  // namespace

double ErosionRule::radial(double r, double largest) const noexcept {
  if (largest <= core) return axis;
  return axis + (rim - axis) * std::max(0.0, r - core) / (largest - core);
}

double ErosionRule::of_face(Face face) const noexcept {
  switch (face) {
    case Face::bottom:
      return bottom;
    case Face::side:
      return side;
    case Face::top:
      return top;
    case Face::inner:
      return inner;
    case Face::minus_x:
      return flanks[0];
    case Face::plus_x:
      return flanks[1];
    case Face::minus_y:
      return flanks[2];
    case Face::plus_y:
      return flanks[3];
  }
  return 0.0;
}

bool ErosionRule::needs_depth() const noexcept {
  const auto differs = [&](double factor) { return factor != interior; };
  return differs(bottom) || differs(side) || differs(top) || differs(inner) || std::any_of(flanks.begin(), flanks.end(), differs);
}

std::vector<Solid> ToolSpec::solids() const {
  std::vector<Solid> all;
  for (const RegionSpec& region : regions) all.push_back(region.solid);
  return all;
}

std::optional<std::size_t> ToolSpec::region_at(const Vec3& p) const noexcept {
  for (std::size_t i = 0; i < regions.size(); ++i)
    if (regions[i].solid.contains(p)) return i;
  return std::nullopt;
}

int read_teeth(TableReader& root, int fallback, const char* more) {
  return static_cast<int>(root.integer("teeth", fallback, 1, 200,
                                       std::string("cutting edges that pass a place in a revolution, for pictures and sound") + more));
}

std::optional<ToolSpec> read_tool_spec(const TomlDocument& document, Issues& issues, KeyLog* log) {
  const std::size_t before = issues.size();
  TableReader root = document.root(issues, log);
  ToolSpec spec;
  spec.name = std::filesystem::path(document.file_name()).stem().string();
  spec.title = root.text("title", std::nullopt, "what the tool is, one line");
  spec.teeth = read_teeth(root, 0, "; absent: estimated from the shape");
  const double default_pitch = read_default_pitch(root);
  std::vector<TableReader> readers =
      root.tables("region", "primitives that the tool consists of; where several overlap, the first in the file sets the erosion factor");
  if (readers.size() > kMostRegions) {
    root.fault("region", fmt::format("has {} elements, at most {} are read", readers.size(), kMostRegions));
    return std::nullopt;
  }
  for (TableReader& reader : readers) {
    RegionSpec region;
    region.name =
        reader.text("name", "region " + std::to_string(spec.regions.size() + 1), "name of the region; absent: region and its number");
    region.solid = read_solid(reader);
    region.erosion = read_erosion(reader, region.solid);
    region.shell = read_sampling(reader, default_pitch);
    if (region.shell.stacks > 0 && !region.solid.revolves()) reader.fault("stacks", "is for what is round: give a box pitch_mm");
    reader.finish();
    spec.regions.push_back(std::move(region));
  }
  if (readers.empty() && !root.has("region")) root.fault("region", "is missing: a tool needs at least one [[region]]");
  root.finish();
  if (issues.size() == before && !spec.regions.empty()) assemble(spec, root, readers);
  if (issues.size() == before && spec.regions.empty()) root.fault("region", "is empty: a tool needs at least one [[region]]");
  return issues.size() == before ? std::optional<ToolSpec>(std::move(spec)) : std::nullopt;
}

}  // namespace burrhole
