#include "core/measure/cross_section.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/bounds.h"
#include "core/contact/contact_view.h"
#include "core/measure/dense_field.h"

namespace burrhole {
namespace {

constexpr double kSettled = 0.5e-3;  // [m] length over which a cutter does not widen before its shoulder
constexpr double kStep = 0.25e-3;    // [m] least width of a shoulder
constexpr double kGap = 2e-3;        // [m] as in make_approach()
constexpr double kPassed = 0.5e-3;   // [m] more than the engaged depth of a usual thrust, 0.2 to 0.3 mm
constexpr double kRoom = 3e-3;       // [m] by which the columns begin above and end below the bone on the axis, on bone that is flat

/// Height of a layer of the lattice and its greatest distance from the axis [m].
using Layers = std::map<int, double>;

int layer_of(const Vec3& point, double pitch) { return static_cast<int>(std::floor(point.z / pitch)); }

/// @returns the first layer of the second cutter; one above all layers if there is none.
int shoulder(const Layers& layers, double pitch) {
  double widest = 0.0;
  int settled = layers.begin()->first;
  for (const auto& [layer, reach] : layers) {
    const bool long_enough = (layer - settled) * pitch >= kSettled;
    if (long_enough && reach > widest + kStep + pitch) return layer;
    if (reach > widest + 0.5 * pitch) settled = layer;
    widest = std::max(widest, reach);
  }
  return layers.rbegin()->first + 1;
}

/// What a column holds, by depth from the entry.
struct Column {
  bool bone = false;  // as loaded
  bool clear = true;  // of that bone nothing is left
  double last = 0.0;  // [m] depth of the last bone as loaded
};

Column column_at(const DenseField& before, const DenseField& after, const Affine& index_from_approach, const Vec3& top, double length,
                 double step) {
  Column out;
  const auto count = static_cast<int>(length / step);
  for (int n = 0; n <= count; ++n) {
    const double s = n * step, depth = s - top.z;
    if (out.bone && depth - out.last > kGap) break;
    const Vec3 p = index_from_approach * (top - Vec3(0.0, 0.0, s));
    if (before.sample(p) < kSurfaceLevel) continue;
    out.bone = true;
    out.last = depth;
    if (after.sample(p) >= kSurfaceLevel) out.clear = false;
  }
  return out;
}

}  // namespace

CrossSection leading_section(const ErosionPoints& points) {
  CrossSection out;
  out.pitch = points.pitch;
  if (points.positions.empty()) return out;
  Layers layers;
  for (const Vec3& p : points.positions) {
    double& reach = layers[layer_of(p, points.pitch)];
    reach = std::max(reach, std::hypot(p.x, p.y));
  }
  const int end = shoulder(layers, points.pitch);
  std::map<std::pair<int, int>, SectionCell> cells;  // by row and column of the lattice
  for (const Vec3& p : points.positions) {
    if (layer_of(p, points.pitch) >= end) continue;
    const std::pair key{static_cast<int>(std::floor(p.y / points.pitch)), static_cast<int>(std::floor(p.x / points.pitch))};
    const auto [at, added] = cells.try_emplace(key, SectionCell{p.x, p.y, p.z});
    if (!added) at->second.lowest = std::min(at->second.lowest, p.z);
  }
  double nearest = 1e9;
  for (const auto& [key, cell] : cells) {
    const double away = std::hypot(cell.x, cell.y);
    out.radius = std::max(out.radius, away);
    nearest = std::min(nearest, away);
    out.cells.push_back(cell);
  }
  out.on_axis = nearest < points.pitch;
  return out;
}

std::optional<SectionMeasure> measure_section(const Voxmap& voxmap, const Approach& approach, const CrossSection& section, double deepest) {
  if (section.cells.empty()) return std::nullopt;
  const Affine& bone_from_index = voxmap.bone().bone_from_index();
  const double edge = bone_from_index.mean_edge(), step = 0.25 * edge;
  // Where the axis leans, the surfaces under the rim are higher or lower by the radius times the slope; 60 degrees at most count.
  const double slope = std::min(std::tan(std::min(approach.angle, 1.047)), 1.732), room = kRoom + section.radius * slope;
  const double length = approach.thickness + 2.0 * room;
  const Affine index_from_approach = bone_from_index.inverse() * Affine::from_pose(approach.bone_from_approach);
  const double wide = section.radius + section.pitch;
  const Bounds around = bounds_under(index_from_approach, {Vec3(-wide, -wide, room - length), Vec3(wide, wide, room)});
  const VoxelBox box{floor_int(around.lo) - 1, floor_int(around.hi) + 3};
  DenseField before{box, std::vector<float>(box.count())}, after{box, std::vector<float>(box.count())};
  voxmap.read_start(box, before.values);
  voxmap.read_density(box, after.values);
  std::size_t columns = 0, clear = 0, passed = 0, uncut = 0;
  for (const SectionCell& cell : section.cells) {
    const Column column = column_at(before, after, index_from_approach, Vec3(cell.x, cell.y, room), length, step);
    if (!column.bone) continue;
    ++columns;
    clear += column.clear ? 1 : 0;
    if (deepest - cell.lowest <= column.last + kPassed + edge) continue;
    ++passed;
    uncut += column.clear ? 0 : 1;
  }
  if (columns == 0 || (voxmap.starts_drilled() && 2 * columns < section.cells.size())) return std::nullopt;
  SectionMeasure out{.cleared = static_cast<double>(clear) / static_cast<double>(columns)};
  if (2 * passed >= columns && passed > 0) out.uncut = static_cast<double>(uncut) / static_cast<double>(passed);
  return out;
}

}  // namespace burrhole
