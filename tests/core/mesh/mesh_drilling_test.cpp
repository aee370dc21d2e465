#include <doctest/doctest.h>

#include "core/mesh/mesh_census.h"
#include "tests/core/drill/drill_cases.h"
#include "tests/core/drill/subvoxel_cases.h"
#include "tests/core/mesh/mesh_checks.h"
#include "tests/core/mesh/pivot_twin.h"
#include "volumes/phantom/phantom.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// The mesh of a window, updated by the boxes that the simulation publishes.
class WindowMesh {
 public:
  explicit WindowMesh(Voxmap& voxmap) : voxmap_(voxmap), listener_(voxmap.add_listener()), mesh_(full()) {
    (void)voxmap.take_dirty(listener_);
  }

  void follow() {
    for (const VoxelBox& box : voxmap_.take_dirty(listener_)) mesh_.update(block(), box);
  }
  [[nodiscard]] const BallMesh& mesh() const { return mesh_; }
  /// @returns the mesh by a full pivoting.
  [[nodiscard]] BallMesh full() const {
    auto out = BallMesh::create(voxmap_.window().box, {.subvoxel = true});
    REQUIRE(out.ok());
    out->fill(block());
    return std::move(out).value();
  }
  [[nodiscard]] MeshBone bone() const { return {voxmap_.window().box, voxmap_.window().density}; }

 private:
  [[nodiscard]] DensityBlock block() const { return {voxmap_.window().box, voxmap_.window().density}; }

  Voxmap& voxmap_;
  std::size_t listener_;
  BallMesh mesh_;
};

void check_same(const BallMesh& mesh, const BallMesh& full) { CHECK(moved_triangles(mesh) == moved_triangles(full)); }

}  // namespace

TEST_CASE("mesh while drilling: after each step, and after undo, the mesh is that of a full pivoting of the window") {
  for (const bool ball : {true, false})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(ball);
      CAPTURE(seed);
      const SolidCase one{.ball = ball, .radius = 4.0, .way = 9.0, .seed = seed};
      const SweptSolid solid = random_solid(one);
      Voxmap voxmap = block_for(one);
      Erosion erosion = subvoxel_erosion(solid, kAtOnce);
      WindowMesh window(voxmap);
      const PlainTriangles before = triangles_of(window.mesh());
      const double volume = take_census(window.mesh()).volume;
      for (int n = 0; n < 6; ++n) {
        drill_step(voxmap, erosion, solid.from, solid.way, n, 6);
        window.follow();
        CHECK(mesh_error_of(window.mesh(), window.bone()) == "");
        check_same(window.mesh(), window.full());
      }
      CHECK(triangles_of(window.mesh()) != before);
      // A hollow of 4 voxels of radius: chords take (10 / 4)^2 times the 1 % of a ball of 10, and the two edges of a cylinder 0.4 voxel^2 each.
      const double removed = volume - take_census(window.mesh()).volume;
      MESSAGE("removed by the mesh ", removed, ", closed form ", solid.volume(), " voxel^3");
      CHECK(std::abs(removed / solid.volume() - 1.0) < 0.1);
      bring_back(voxmap);
      window.follow();
      check_same(window.mesh(), window.full());
      CHECK(triangles_of(window.mesh()) == before);
    }
}

TEST_CASE("mesh while drilling: a burr through a skull patch makes one handle and leaves no orphan but a thousandth") {
  PhantomSpec spec;
  spec.pitch = 0.5e-3;
  const auto phantom = make_phantom(spec);
  REQUIRE(phantom.ok());
  Voxmap voxmap = voxmap_of(phantom->bone);
  REQUIRE(voxmap.place_window(voxmap.bone().bounds().grown(3)).ok());
  WindowMesh window(voxmap);
  const MeshCensus before = take_census(window.mesh());
  CHECK(mesh_error_of(window.mesh(), window.bone()) == "");
  Erosion erosion = make_erosion(lattice(Cylinder{3e-3, 6e-3}, 0.2e-3, 1e12f));
  const Affine start = upright_pose(spec.pitch, 0.5 * Vec3(voxmap.bone().bounds().lo + voxmap.bone().bounds().hi) + Vec3(0.0, 0.0, 9.0));
  for (int n = 0; n < 8; ++n) {
    drill_step(voxmap, erosion, start, Vec3(0.0, 0.0, -24.0), n, 8);
    window.follow();
    CHECK(mesh_error_of(window.mesh(), window.bone()) == "");
    check_same(window.mesh(), window.full());
  }
  const MeshCensus after = take_census(window.mesh());
  const std::size_t orphans = find_orphans(window.mesh()).size(), surface = window.bone().surface_voxels().size();
  MESSAGE("as loaded: ", before.parts, " parts, genus ", before.genus(), ", ", before.shared_edges.size(), " shared edges of ",
          before.edges);
  MESSAGE("drilled: ", after.parts, " parts, genus ", after.genus(), ", ", after.shared_edges.size(), " shared edges of ", after.edges,
          ", ", orphans, " orphans of ", surface);
  CHECK(after.genus() == before.genus() + 1);
  CHECK(static_cast<double>(orphans) <= 1e-3 * static_cast<double>(surface));
}
