#include "core/mesh/ball_mesh.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "core/mesh/mesh_census.h"
#include "tests/core/mesh/mesh_checks.h"
#include "tests/core/mesh/pivot_twin.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

int sum(const Vec3i& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// A convex body whose faces have normals of components -1, 0 and 1, round the middle of its box.
struct Polytope {
  std::string name;
  std::function<bool(const Vec3i&)> inside;
  double volume;  // [voxel^3] of the hull of its centres
};

}  // namespace

TEST_CASE("ball mesh: a box that cannot be meshed is an error with the numbers") {
  CHECK_FALSE(BallMesh::create({}));
  const auto error = BallMesh::create({Vec3i(0), Vec3i(4, 4, 2000)});
  REQUIRE_FALSE(error);
  CHECK(error.error().code == ErrorCode::out_of_range);
  CHECK(error.error().message == "a mesh of 4 x 4 x 2000 voxels: mesh a box of 1 to 1024 per edge");
}

TEST_CASE("ball mesh: small shapes are closed, without errors, and equal to the slow twin") {
  for (const std::uint64_t seed : {1u, 2u, 3u})
    for (const MeshShape& shape : small_shapes(seed)) {
      CAPTURE(seed);
      INFO(shape.name);
      const BallMesh mesh = make_mesh(shape.bone);
      CHECK(mesh_error_of(mesh, shape.bone) == "");
      CHECK(twin_error(mesh, shape.bone) == "");
      CHECK(mesh.work().triangles_added == mesh.half_edges().triangles());  // none is made in vain
    }
}

TEST_CASE("ball mesh: the volume of a convex body is that of the hull of its centres") {
  const int n = 6;
  const double n3 = n * n * n;
  const std::vector<Polytope> bodies{
      {"cube", [&](const Vec3i& v) { return glm::all(glm::lessThanEqual(glm::abs(v), Vec3i(n))); }, 8.0 * n3},
      {"octahedron", [&](const Vec3i& v) { return sum(v) <= n; }, 4.0 / 3.0 * n3},
      {"rhombic dodecahedron",
       [&](const Vec3i& v) {
         const Vec3i a = glm::abs(v);
         return a.x + a.y <= n && a.x + a.z <= n && a.y + a.z <= n;
       },
       2.0 * n3},
      {"cuboctahedron", [&](const Vec3i& v) { return glm::all(glm::lessThanEqual(glm::abs(v), Vec3i(n))) && sum(v) <= 2 * n; },
       20.0 / 3.0 * n3},
      {"truncated octahedron", [&](const Vec3i& v) { return glm::all(glm::lessThanEqual(glm::abs(v), Vec3i(4))) && sum(v) <= 6; }, 256.0}};
  for (const Polytope& body : bodies) {
    INFO(body.name);
    const MeshBone bone = whole_voxels(Vec3i(2 * n + 3), [&](const Vec3i& v) { return body.inside(v - (n + 1)); });
    const BallMesh mesh = make_mesh(bone);
    const MeshCensus census = take_census(mesh);
    CHECK(std::abs(census.volume - body.volume) < 1e-9 * body.volume);
    CHECK(census.parts == 1);
    CHECK(census.genus() == 0);
    CHECK(census.shared_edges.empty());
    CHECK(find_orphans(mesh).empty());
    CHECK(mesh.work().seeds == 1);  // the ball reaches all of it from one triangle
    CHECK(mesh_error_of(mesh, bone) == "");
  }
}

TEST_CASE("ball mesh: a ball of bone encloses less than the hull of its centres, as steps of the grid stay concave") {
  const double radius = 11.3;
  const MeshBone bone = whole_voxels(Vec3i(27), [&](const Vec3i& v) { return glm::length(Vec3(v) - 13.0) < radius; });
  const MeshCensus census = take_census(make_mesh(bone));
  const double sphere = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
  CHECK(census.volume < sphere);
  // A vertex is at most sqrt(3) below the sphere: the next centre outwards is not solid.
  CHECK(census.volume > 4.0 / 3.0 * std::numbers::pi * std::pow(radius - std::sqrt(3.0), 3));
  CHECK(census.parts == 1);
  CHECK(census.genus() == 0);
}

TEST_CASE("ball mesh: parts, handles and cavities are counted") {
  const auto census_of = [](const Vec3i& edge, const std::function<bool(const Vec3i&)>& inside) {
    return take_census(make_mesh(whole_voxels(edge, inside)));
  };
  const MeshCensus ring =
      census_of(Vec3i(12, 12, 4), [](const Vec3i& v) { return std::max(std::abs(2 * v.x - 11), std::abs(2 * v.y - 11)) > 5; });
  CHECK(ring.parts == 1);
  CHECK(ring.genus() == 1);
  const MeshCensus cavity = census_of(Vec3i(9), [](const Vec3i& v) { return v != Vec3i(4); });
  CHECK(cavity.parts == 2);
  CHECK(cavity.genus() == 0);
  CHECK(std::abs(cavity.volume - (512.0 - 4.0 / 3.0)) < 1e-9);  // the cavity is an octahedron of radius 1
  const MeshCensus two = census_of(Vec3i(9, 3, 3), [](const Vec3i& v) { return v.x != 4; });
  CHECK(two.parts == 2);
  const MeshCensus touching = census_of(Vec3i(6, 6, 3), [](const Vec3i& v) { return (v.x < 3) == (v.y < 3); });
  // Centres 2 and 3 of the two blocks are one step along x and y apart: edges of the diagonal cells join them.
  CHECK(touching.parts == 1);
  CHECK(touching.genus() == 0);
}

TEST_CASE("ball mesh: one vertex, an edge or a chain carries no ball, and is an orphan") {
  const MeshBone chain = whole_voxels(Vec3i(7, 3, 3), [](const Vec3i& v) { return v.y == 1 && v.z == 1; });
  const BallMesh mesh = make_mesh(chain);
  CHECK(mesh.half_edges().triangles() == 0);
  CHECK(find_orphans(mesh).size() == 7);
  CHECK(find_orphans(mesh)[0].neighbours == 1);
  CHECK(find_orphans(mesh)[3].neighbours == 2);
  const MeshBone alone = whole_voxels(Vec3i(3), [](const Vec3i& v) { return v == Vec3i(1); });
  REQUIRE(find_orphans(make_mesh(alone)).size() == 1);
  CHECK(find_orphans(make_mesh(alone))[0].neighbours == 0);
}

TEST_CASE("ball mesh: solid is a density of one half or more") {
  MeshBone bone = whole_voxels(Vec3i(4), [](const Vec3i&) { return true; });
  for (float& density : bone.density) density = 0.5f;
  CHECK(make_mesh(bone).half_edges().vertices() == 56);
  for (float& density : bone.density) density = std::nextafter(0.5f, 0.0f);
  CHECK(make_mesh(bone).half_edges().vertices() == 0);
}

TEST_CASE("ball mesh, sabotage: a tie that depends on the edge, and a missed glue, are found by the checks") {
  const MeshBone bone = small_shapes(1)[1].bone;
  CHECK(mesh_error_of(make_mesh(bone), bone) == "");
  const BallMesh other_tie = make_mesh(bone, {}, {.tie = TieRule::first_found});
  CHECK(mesh_error_of(other_tie, bone) != "");
  CHECK(twin_error(other_tie, bone) != "");
  for (const std::uint64_t missed : {1u, 2u, 100u}) CHECK(mesh_error_of(make_mesh(bone, {}, {.missed_glue = missed}), bone) != "");
  CHECK(mesh_error_of(make_mesh(bone, {}, {.missed_glue = 100'000}), bone) == "");  // there are not that many
}
