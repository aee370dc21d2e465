#include <doctest/doctest.h>

#include "core/base/units.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/write/drilled_ball.h"
#include "volumes/read/mesh_file.h"
#include "volumes/write/bone_surface.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

/// Read by the reader that `burrhole tools` and `import` use.
SurfaceMesh exported(const Voxmap& bone, const std::string& path, bool undrilled) {
  const auto report = export_bone(bone, {.path = path, .undrilled = undrilled});
  REQUIRE_MESSAGE(report.ok(), (report ? "" : report.error().text()));
  auto mesh = read_mesh(path, kMillimetre);
  REQUIRE_MESSAGE(mesh.ok(), (mesh ? "" : mesh.error().text()));
  CHECK(mesh->indices.size() == 3 * report->triangles);
  return std::move(mesh).value();
}

double voxels(double volume, const Affine& map) { return volume / map.cell_volume(); }

// How far the mesh of a surface of radius R lies from it, in voxels. A crossing is interpolated along an edge: the distance is a convex
// function of the place on it, so it is off by at most 1/(8R). A vertex is the mean of crossings in one cell, at most sqrt(3) apart: inside by
// at most 3/(8R). A triangle joins cells that meet: edges of at most 2 sqrt(3), a circumradius of at most 2, so at most 2/R inside.
double off(double radius) { return 2.5 / radius; }

}  // namespace

TEST_CASE("export: the mesh of a ball is closed and has its volume; the hole's volume is missing from that of the drilled one") {
  const TemporaryFolder folder;
  const double ball = kBallRadius / kEdge, hole = kHoleRadius / kEdge, pi = std::numbers::pi;
  const double ball_tolerance = 4.0 * pi * ball * ball * off(ball);
  // The wall of the hole likewise. At its two rims, wedges of 60 degrees, the product of both ramps is below 0.5 up to two voxels from each
  // surface, and vertices round the edge off: less than 2 by 2 voxels.
  const double wall = 2.0 * pi * hole * 2.0 * std::sqrt(ball * ball - hole * hole), rims = 2.0 * 2.0 * pi * hole * 4.0;
  const double hole_tolerance = wall * off(hole) + rims;
  for (const Affine& map : {oblique_map(), sheared_map()}) {
    const Voxmap bone = ball_voxmap(map, true);
    for (const char* const name : {"a.stl", "a.ply", "a.obj"}) {
      INFO(std::string(name));
      const SurfaceMesh whole = exported(bone, folder.file(name), true), drilled = exported(bone, folder.file(name), false);
      for (const SurfaceMesh* mesh : {&whole, &drilled}) {
        CHECK_MESSAGE(!mesh_error(*mesh), mesh_error(*mesh).value_or(""));
        CHECK(check_mesh(*mesh).parts == 1);
        CHECK(check_mesh(*mesh).degenerate == 0);
      }
      const double volume = voxels(check_mesh(whole).volume, map), missing = volume - voxels(check_mesh(drilled).volume, map);
      MESSAGE(std::string(name) << ": ball " << volume << " of " << ball_volume() << " +- " << ball_tolerance << ", hole " << missing
                                << " of " << hole_volume() << " +- " << hole_tolerance);
      CHECK(std::abs(volume - ball_volume()) < ball_tolerance);
      CHECK(std::abs(missing - hole_volume()) < hole_tolerance);
      // Sabotage: a level of 0.25 would lie one voxel outside, with the ramp of four.
      CHECK(std::abs(4.0 / 3.0 * pi * std::pow(ball + 1.0, 3) - ball_volume()) > ball_tolerance);
    }
  }
}

TEST_CASE("export: the vertices of a mesh lie on the surface, in the patient's millimetres") {
  const TemporaryFolder folder;
  const SurfaceMesh mesh = exported(ball_voxmap(oblique_map(), false), folder.file("a.ply"), false);
  const Vec3 centre = oblique_map() * kBallCentre;
  double farthest = 0.0;
  for (const Vec3& position : mesh.positions) farthest = std::max(farthest, std::abs(glm::length(position - centre) - kBallRadius));
  // A vertex: 1/(8R) + 3/(8R) voxels; floats of 800 mm: 3e-5 mm.
  CHECK(farthest < 0.5 * kEdge * kEdge / kBallRadius + 5e-8);
}

TEST_CASE("export: bone that is cut by the border of its volume has a closed mesh there") {
  const TemporaryFolder folder;
  DenseBone block;
  block.dims = Vec3i(9, 8, 7);
  block.bone_from_index = Affine::scaling(kEdge, Vec3(0.0));
  block.occupancy.assign(9 * 8 * 7, 1.0f);
  block.hardness.assign(9 * 8 * 7, 0.5f);
  block.labels.assign(9 * 8 * 7, 1);
  const Voxmap bone = Voxmap::create(BoneModel::create(block).value(), {}).value();
  const SurfaceMesh mesh = exported(bone, folder.file("a.stl"), false);
  CHECK_FALSE(mesh_error(mesh));
  // The 0.5 level lies half a voxel beyond the last centres, so the block has its whole size but for its edges: there a vertex is the mean
  // of crossings at (1/2, 0) and (0, 1/2), which takes a quarter of a cell's face along the edge; half a voxel more at each corner.
  const double volume = voxels(check_mesh(mesh).volume, block.bone_from_index);
  CHECK(volume <= 9 * 8 * 7 + 1e-3);
  CHECK(volume > 9 * 8 * 7 - 4.0 * (9 + 8 + 7) * 0.25 - 8.0 * 0.5);
}

TEST_CASE("export: a bone without a surface is an error that says so") {
  const TemporaryFolder folder;
  DenseBone none;
  none.dims = Vec3i(9, 8, 7);
  none.bone_from_index = Affine::scaling(kEdge, Vec3(0.0));
  none.occupancy.assign(9 * 8 * 7, 0.4f);
  none.hardness.assign(9 * 8 * 7, 0.5f);
  const Voxmap bone = Voxmap::create(BoneModel::create(none).value(), {}).value();
  const auto report = export_bone(bone, {.path = folder.file("a.stl")});
  REQUIRE_FALSE(report.ok());
  CHECK(report.error().text() == folder.file("a.stl") + ": there is no bone: its density reaches 0.5 nowhere");
  CHECK_FALSE(std::filesystem::exists(folder.file("a.stl")));
}
