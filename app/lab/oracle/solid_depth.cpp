#include "app/lab/oracle/solid_depth.h"

#include <algorithm>

#include "core/base/trilinear.h"
#include "core/tool/point_shell.h"
#include "core/tool/tool_spec.h"

namespace burrhole {
namespace {

constexpr double kStep = 0.5;  // [voxels] between the lines, between samples on one, and between points of the tool
constexpr int kHalvings = 16;  // of a crossing

/// Points where the density passes 0.5 on lines along the three axes.
std::vector<Vec3> crossings(const BoneModel& bone) {
  const VoxelBox box = bone.bounds();
  std::vector<float> density(box.count());
  bone.read_occupancy(box, density);
  const Vec3 first(box.lo), last(box.hi - 2);
  const auto at = [&](const Vec3& index) { return static_cast<double>(trilinear(box, density.data(), index)); };
  std::vector<Vec3> out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    Vec3 p(0.0);
    for (p[u] = first[u]; p[u] <= last[u]; p[u] += kStep)
      for (p[v] = first[v]; p[v] <= last[v]; p[v] += kStep) {
        p[axis] = first[axis];
        bool before = at(p) >= 0.5;
        for (double c = first[axis] + kStep; c <= last[axis]; c += kStep) {
          p[axis] = c;
          const bool now = at(p) >= 0.5;
          if (now != before) {
            double low = c - kStep, high = c;
            for (int n = 0; n < kHalvings; ++n) {
              p[axis] = 0.5 * (low + high);
              ((at(p) >= 0.5) == before ? low : high) = p[axis];
            }
            out.push_back(bone.bone_from_index() * p);
          }
          before = now;
        }
      }
  }
  return out;
}

}  // namespace

Result<SolidDepth> SolidDepth::create(const std::string& tool_text, const BoneModel& bone) {
  auto document = TomlDocument::parse(tool_text, "tool");
  if (!document) return document.error();
  Issues issues;
  auto spec = read_tool_spec(*document, issues);
  if (!spec) return issues.front();
  SolidDepth out;
  out.solids_ = spec->solids();
  out.outline_ = spec->outline;
  out.box_ = out.solids_.front().bounds();
  for (const Solid& solid : out.solids_) {
    out.box_.include(solid.bounds().lo);
    out.box_.include(solid.bounds().hi);
  }
  for (RegionSpec& region : spec->regions)
    region.shell = {.stacks = 0, .slices = 0, .voxel = 0.0, .pitch = kStep * bone.bone_from_index().mean_edge()};
  auto fine = make_point_shell(*spec);
  if (!fine) return fine.error();
  out.tool_points_ = std::move(fine->positions);
  out.points_ = crossings(bone);
  std::ranges::sort(out.points_, {}, &Vec3::x);
  return out;
}

double SolidDepth::deepest(const Pose& bone_from_tool) const {
  Bounds box{bone_from_tool * box_.lo, bone_from_tool * box_.lo};
  for (const Vec3& corner : box_.corners()) box.include(bone_from_tool * corner);
  const Pose tool_from_bone = bone_from_tool.inverse();
  const auto last = std::ranges::upper_bound(points_, box.hi.x, {}, &Vec3::x);
  double out = 0.0;
  for (auto p = std::ranges::lower_bound(points_, box.lo.x, {}, &Vec3::x); p < last; ++p) {
    if (p->y < box.lo.y || p->y > box.hi.y || p->z < box.lo.z || p->z > box.hi.z) continue;
    const Vec3 at = tool_from_bone * *p;
    if (std::ranges::any_of(solids_, [&](const Solid& solid) { return solid.contains(at); }))
      out = std::max(out, -signed_distance(solids_, outline_, at));
  }
  return out;
}

}  // namespace burrhole
