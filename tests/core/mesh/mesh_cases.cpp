#include "tests/core/mesh/mesh_cases.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/base/random.h"

namespace burrhole::test {
namespace {

constexpr Vec3i kCorner(-3, 5, -20);

}  // namespace

std::vector<Vec3i> MeshBone::solid_voxels() const {
  std::vector<Vec3i> out;
  for_each_voxel(box, [&](const Vec3i& v) {
    if (is_solid(v)) out.push_back(v);
  });
  return out;
}

std::vector<Vec3i> MeshBone::surface_voxels() const {
  std::vector<Vec3i> out;
  for (const Vec3i& v : solid_voxels())
    for (const Vec3i& step : {Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1)})
      if (!is_solid(v + step) || !is_solid(v - step)) {
        out.push_back(v);
        break;
      }
  return out;
}

MeshBone whole_voxels(const Vec3i& edge, const std::function<bool(const Vec3i&)>& inside) {
  MeshBone out{.box = {kCorner, kCorner + edge}, .density = {}};
  for_each_voxel(out.box, [&](const Vec3i& v) { out.density.push_back(inside(v - kCorner) ? 1.0f : 0.0f); });
  return out;
}

MeshBone ramp(const Vec3i& edge, const std::function<double(const Vec3&)>& distance) {
  MeshBone out{.box = {kCorner, kCorner + edge}, .density = {}};
  for_each_voxel(out.box, [&](const Vec3i& v) {
    out.density.push_back(static_cast<float>(std::clamp(0.5 - 0.5 * distance(Vec3(v - kCorner)), 0.0, 1.0)));
  });
  return out;
}

std::vector<MeshShape> small_shapes(std::uint64_t seed) {
  const auto within = [](const Vec3i& v, const Vec3i& lo, const Vec3i& hi) { return VoxelBox{lo, hi}.contains(v); };
  std::vector<MeshShape> out;
  const auto add = [&](const char* name, const Vec3i& edge, const std::function<bool(const Vec3i&)>& inside) {
    out.push_back({name, whole_voxels(edge, inside)});
  };
  add("block that fills its box", Vec3i(5, 4, 6), [](const Vec3i&) { return true; });
  add("ball", Vec3i(9), [](const Vec3i& v) { return glm::length(Vec3(v) - 4.0) < 3.7; });
  add("wall of one voxel", Vec3i(7, 7, 3), [&](const Vec3i& v) { return v.z == 1; });
  add("slanted wall of one voxel", Vec3i(7), [&](const Vec3i& v) { return v.x + v.y + v.z == 9; });
  add("wall of two voxels", Vec3i(4, 7, 7), [&](const Vec3i& v) { return v.x == 1 || v.x == 2; });
  add("wall of three voxels", Vec3i(7, 5, 7), [&](const Vec3i& v) { return v.y >= 1 && v.y <= 3; });
  add("ring", Vec3i(8, 8, 4), [&](const Vec3i& v) { return !within(v, Vec3i(3, 3, 0), Vec3i(5, 5, 4)); });
  add("two blocks and a bridge", Vec3i(9, 4, 4), [&](const Vec3i& v) { return v.x < 3 || v.x > 5 || (v.y == 1 && v.z == 2); });
  add("chain", Vec3i(7, 3, 3), [&](const Vec3i& v) { return v.y == 1 && v.z == 1; });
  add("blocks that touch along an edge", Vec3i(6), [&](const Vec3i& v) { return (v.x < 3) == (v.y < 3); });
  add("blocks that touch at a corner", Vec3i(6), [&](const Vec3i& v) { return (v.x < 3) == (v.y < 3) && (v.x < 3) == (v.z < 3); });
  add("shell with a cavity", Vec3i(7), [&](const Vec3i& v) { return !within(v, Vec3i(2), Vec3i(5)); });
  std::uint64_t counter = 0;
  for (const double share : {0.2, 0.5, 0.8}) add("noise", Vec3i(6), [&](const Vec3i&) { return uniform01(seed, counter++) < share; });
  return out;
}

BallMesh make_mesh(const MeshBone& bone, const BallMeshConfig& config, const PivotRules& rules) {
  auto mesh = make_sabotaged_mesh(bone.box, config, rules);
  REQUIRE(mesh.ok());
  mesh->fill(bone.block());
  return std::move(mesh).value();
}

std::vector<Vec3i> shuffled(std::vector<Vec3i> voxels, std::uint64_t seed) {
  for (std::size_t n = voxels.size(); n > 1; --n)
    std::swap(voxels[n - 1], voxels[static_cast<std::size_t>(uniform01(seed, n) * static_cast<double>(n))]);
  return voxels;
}

}  // namespace burrhole::test
