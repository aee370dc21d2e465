#include "volumes/read/skull_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "core/base/parallel.h"
#include "core/base/portable_math.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr double kThickest = 25e-3;  // [m] of a skull wall, sinuses included
constexpr double kToCavity = 6e-3;   // [m] from the last bone to the first cube of the cavity: the diagonal of a cube, and dura
constexpr double kStep = 0.2e-3;     // [m] along a column
constexpr int kBisections = 12;
constexpr double kAlike = 0.7;  // [-] cosine of the largest angle between the normals of neighbours

/// Outward, from the differences over 2 mm, which noise disturbs less than those of neighbouring voxels.
Vec3 inward_normal(const Scan& scan, const Affine& scan_from_bone, const Vec3& at) {
  constexpr double kSpan = 2e-3;  // [m]
  Vec3 slope(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 d(0.0);
    d[axis] = kSpan;
    slope[axis] = scan_value(scan, scan_from_bone * (at + d)) - scan_value(scan, scan_from_bone * (at - d));
  }
  const double length = glm::length(slope);
  return length > 0.0 ? slope / length : Vec3(0.0);
}

/// Depth of the inner surface of the wall along a line; 0 if the line does not lead through bone into the cavity.
double wall_thickness(const Scan& scan, const Affine& scan_from_bone, const SkullCavity& cavity, double bone, const WallColumn& c) {
  const auto is_bone = [&](double depth) { return scan_value(scan, scan_from_bone * (c.entry + depth * c.inward)) >= bone; };
  double last = 0.0;
  for (double depth = 0.5 * kStep; depth < last + kToCavity && depth < kThickest + kToCavity; depth += kStep) {
    if (is_bone(depth)) {
      last = depth;
      continue;
    }
    if (!cavity.holds(c.entry + depth * c.inward)) continue;
    if (last == 0.0 || last > kThickest) return 0.0;
    double inside = last, free = last + kStep;
    for (int n = 0; n < kBisections; ++n) {
      const double half = 0.5 * (inside + free);
      (is_bone(half) ? inside : free) = half;
    }
    return inside;
  }
  return 0.0;
}

/// Places of the surface between a voxel of bone and its neighbours, by linear interpolation: one of each cube of edge `pitch`.
std::vector<Vec3> surface_places(const Scan& scan, double bone, double pitch) {
  std::vector<Vec3> out;
  std::unordered_set<std::uint64_t> taken;
  const VoxelBox all{Vec3i(0), scan.dims};
  const auto value = [&](const Vec3i& v) { return static_cast<double>(scan.values[all.offset_of(v)]); };
  for_each_voxel(all, [&](const Vec3i& v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3i next = v;
      ++next[axis];
      if (next[axis] >= scan.dims[axis]) continue;
      const double a = value(v), b = value(next);
      if ((a >= bone) == (b >= bone)) continue;
      Vec3 at(v);
      at[axis] += (bone - a) / (b - a);
      const Vec3 p = scan.bone_from_index * at;
      constexpr std::uint64_t kMask = 0x1fffff;
      const Vec3i cell = floor_int(p / pitch);
      const auto part = [&](std::size_t n) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[n])) & kMask; };
      if (taken.insert(part(0) | part(1) << 21u | part(2) << 42u).second) out.push_back(p);
    }
  });
  return out;
}

/// Replaces each normal by the average of those around it, and drops columns that then miss the cavity.
void smooth_normals(std::vector<WallColumn>& columns, double smoothing) {
  if (!(smoothing > 0.0)) return;
  const std::vector<WallColumn> before = columns;
  const Neighbours around(before, 2.0 * smoothing);
  for_each_number(static_cast<int>(columns.size()), [&](int n) {
    Vec3 sum(0.0);
    around.visit(static_cast<std::size_t>(n), [&](std::size_t m, double distance) {
      const double x = distance / smoothing;
      sum += portable_exp(-0.5 * x * x) * before[m].inward;
    });
    columns[static_cast<std::size_t>(n)].inward = glm::normalize(sum);
  });
}

void keep_through(const Scan& scan, const TissueLevels& levels, const SkullCavity& cavity, std::vector<WallColumn>& columns) {
  const Affine scan_from_bone = scan.bone_from_index.inverse();
  for_each_number(static_cast<int>(columns.size()), [&](int n) {
    WallColumn& c = columns[static_cast<std::size_t>(n)];
    c.thickness = wall_thickness(scan, scan_from_bone, cavity, levels.bone, c);
  });
  std::erase_if(columns, [](const WallColumn& c) { return c.thickness <= 0.0; });
}

}  // namespace

double scan_value(const Scan& scan, const Vec3& scan_index) noexcept {
  const Vec3 p = glm::clamp(scan_index, Vec3(0.0), Vec3(scan.dims - 1));
  const Vec3i base = glm::clamp(floor_int(p), Vec3i(0), glm::max(scan.dims - 2, Vec3i(0)));
  const VoxelBox all{Vec3i(0), scan.dims};
  return trilinear(p - Vec3(base), [&](unsigned n) {
    const Vec3i corner(static_cast<int>(n & 1u), static_cast<int>((n >> 1) & 1u), static_cast<int>(n >> 2));
    return static_cast<double>(scan.values[all.offset_of(glm::min(base + corner, scan.dims - 1))]);
  });
}

Neighbours::Neighbours(const std::vector<WallColumn>& columns, double reach) : columns_(&columns), reach_(reach) {
  for (std::size_t n = 0; n < columns.size(); ++n)
    cells_[key_of(floor_int(columns[n].entry / reach_))].push_back(static_cast<std::uint32_t>(n));
}

std::uint64_t Neighbours::key_of(const Vec3i& cell) const noexcept {
  constexpr std::uint64_t kMask = 0x1fffff;
  const auto part = [&](std::size_t n) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[n])) & kMask; };
  return part(0) | part(1) << 21u | part(2) << 42u;
}

void Neighbours::visit(std::size_t number, const std::function<void(std::size_t, double)>& f) const {
  const WallColumn& own = (*columns_)[number];
  const Vec3i cell = floor_int(own.entry / reach_);
  for_each_voxel({cell - 1, cell + 2}, [&](const Vec3i& near) {
    const auto found = cells_.find(key_of(near));
    if (found == cells_.end()) return;
    for (const std::uint32_t m : found->second) {
      const WallColumn& other = (*columns_)[m];
      const double distance = glm::length(other.entry - own.entry);
      if (distance <= reach_ && glm::dot(other.inward, own.inward) > kAlike) f(m, distance);
    }
  });
}

std::vector<WallColumn> find_columns(const Scan& scan, const TissueLevels& levels, const SkullCavity& cavity, double pitch,
                                     double smoothing) {
  const Affine scan_from_bone = scan.bone_from_index.inverse();
  std::vector<WallColumn> out;
  for (const Vec3& p : surface_places(scan, levels.bone, pitch)) {
    const Vec3 inward = inward_normal(scan, scan_from_bone, p);
    // From the inner surface the cavity begins at once, outwards.
    if (inward == Vec3(0.0) || cavity.holds(p - 0.7 * SkullCavity::kCube * inward) || cavity.holds(p - kToCavity * inward)) continue;
    out.push_back({p, inward, 0.0});
  }
  keep_through(scan, levels, cavity, out);
  smooth_normals(out, smoothing);
  keep_through(scan, levels, cavity, out);
  return out;
}

}  // namespace burrhole
