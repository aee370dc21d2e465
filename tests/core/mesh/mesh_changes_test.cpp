// The list of changed triangles: a copy that applies it is the mesh.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <optional>

#include "core/base/bounds.h"
#include "core/base/random.h"
#include "tests/core/mesh/mesh_cases.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

using Id = HalfEdgeMesh::Id;
using Corners = std::array<std::array<double, 3>, 3>;

std::array<double, 3> plain(const Vec3& p) { return {p.x, p.y, p.z}; }

/// What a display has of a mesh: the corners of each triangle, by its number.
struct Copy {
  std::vector<std::optional<Corners>> triangles;

  void apply(const BallMesh& mesh, const std::vector<Id>& changed) {
    for (const Id t : changed) {
      if (t >= triangles.size()) triangles.resize(t + 1);
      const bool is_there = t < mesh.half_edges().triangle_slots() && mesh.half_edges().has_triangle(t);
      triangles[t].reset();
      if (is_there) triangles[t] = {plain(mesh.position(3 * t)), plain(mesh.position(3 * t + 1)), plain(mesh.position(3 * t + 2))};
    }
  }
  [[nodiscard]] std::vector<Corners> sorted() const {
    std::vector<Corners> out;
    for (const auto& one : triangles)
      if (one) out.push_back(*one);
    std::ranges::sort(out);
    return out;
  }
};

std::vector<Corners> sorted_surface(const BallMesh& mesh) {
  const SurfaceMesh surface = mesh.surface();
  std::vector<Corners> out;
  for (std::size_t n = 0; n < surface.indices.size(); n += 3)
    out.push_back({plain(surface.positions[surface.indices[n]]), plain(surface.positions[surface.indices[n + 1]]),
                   plain(surface.positions[surface.indices[n + 2]])});
  std::ranges::sort(out);
  return out;
}

MeshBone slab() {
  return ramp({30, 28, 18}, [](const Vec3& p) { return std::max(4.3 - p.z, p.z - 13.2); });
}

/// Takes a random ball out of a bone, with a soft edge, or brings it back as `loaded` has it. @returns the changed box.
VoxelBox drill(MeshBone& bone, const MeshBone& loaded, std::uint64_t seed, std::uint64_t step, bool grow) {
  const auto random = [&](std::uint64_t m) { return uniform01(seed, 4 * step + m); };
  const Vec3 centre = Vec3(bone.box.lo) + Vec3(bone.box.size()) * Vec3(random(0), random(1), random(2));
  const double radius = 2.0 + 3.0 * random(3);
  const Vec3i reach(static_cast<int>(radius) + 3);
  const VoxelBox part = VoxelBox{voxel_of(centre) - reach, voxel_of(centre) + reach + 1}.intersect(bone.box);
  for_each_voxel(part, [&](const Vec3i& v) {
    float& density = bone.density[bone.box.offset_of(v)];
    const float left = static_cast<float>(std::clamp(0.5 + 0.5 * (glm::length(Vec3(v) - centre) - radius), 0.0, 1.0));
    const float before = loaded.density[bone.box.offset_of(v)];
    density = grow ? std::max(density, before * (1.0f - left)) : std::min(density, left);
  });
  return part;
}

std::vector<Id> taken(BallMesh& mesh) {
  std::vector<Id> out;
  mesh.take_changed(out);
  return out;
}

}  // namespace

TEST_CASE("mesh changes: a copy to which the listed triangles are applied is the surface, after each step of a random drilling") {
  for (const bool subvoxel : {true, false})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(subvoxel);
      CAPTURE(seed);
      const MeshBone loaded = slab();
      MeshBone bone = loaded;
      BallMesh mesh = make_mesh(bone, {.subvoxel = subvoxel, .report = true});
      Copy copy;
      copy.apply(mesh, taken(mesh));
      CHECK(copy.sorted() == sorted_surface(mesh));
      for (std::uint64_t step = 0; step < 25; ++step) {
        mesh.update(bone.block(), drill(bone, loaded, seed, step, step % 4 == 3));
        const std::vector<Id> changed = taken(mesh);
        CHECK(std::ranges::is_sorted(changed));
        CHECK(std::ranges::adjacent_find(changed) == changed.end());
        CHECK(taken(mesh).empty());
        const Copy before = copy;
        copy.apply(mesh, changed);
        CHECK(copy.sorted() == sorted_surface(mesh));
        // No listed triangle is as it was, but those that were removed and made again, or moved and moved back.
        std::size_t same = 0;
        for (const Id t : changed)
          if (t < before.triangles.size() && before.triangles[t] == copy.triangles[t]) ++same;
        CHECK(same * 2 <= changed.size());
      }
      // Several updates, one reading.
      for (std::uint64_t step = 30; step < 34; ++step) mesh.update(bone.block(), drill(bone, loaded, seed, step, false));
      copy.apply(mesh, taken(mesh));
      CHECK(copy.sorted() == sorted_surface(mesh));
    }
}

TEST_CASE("mesh changes: a refill lists the triangles of before too, and a box without vertices lists none") {
  const MeshBone thick = slab();
  BallMesh mesh = make_mesh(thick, {.subvoxel = true, .report = true});
  Copy copy;
  copy.apply(mesh, taken(mesh));
  const MeshBone ball = ramp({30, 28, 18}, [](const Vec3& p) { return glm::length(p - Vec3(14.0, 14.0, 9.0)) - 5.0; });
  mesh.fill(ball.block());
  copy.apply(mesh, taken(mesh));
  CHECK(copy.sorted() == sorted_surface(mesh));
  mesh.list_vertices({ball.box.lo, ball.box.lo + 3});
  CHECK(taken(mesh).empty());
  mesh.list_vertices(ball.box);
  CHECK(taken(mesh).size() == mesh.half_edges().triangles());
}

TEST_CASE("mesh changes: nothing is listed unless it is asked for") {
  const MeshBone bone = slab();
  BallMesh mesh = make_mesh(bone, {.subvoxel = true, .report = false});
  mesh.list_vertices(bone.box);
  CHECK(taken(mesh).empty());
}
