#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/bench/areas.h"
#include "core/mesh/ball_mesh.h"
#include "core/mesh/mesh_census.h"
#include "volumes/write/bone_surface.h"

namespace burrhole {
namespace {

/// A dense patch of bone whose upper face is wavy, with a ramp of one voxel, and the same after a burr has removed a ball from the face.
struct Patch {
  VoxelBox box;
  std::vector<float> density, drilled;  // [-]
  VoxelBox changed;                     // 20^3

  [[nodiscard]] DensityBlock before() const { return {box, density}; }
  [[nodiscard]] DensityBlock after() const { return {box, drilled}; }
};

Patch make_patch(int edge) {
  constexpr double kBurrRadius = 8.5;  // [voxel] with its ramp it reaches to the faces of a box of 20^3
  Patch out{.box = {Vec3i(0), Vec3i(edge)}, .density = {}, .drilled = {}, .changed = {Vec3i(edge / 2 - 10), Vec3i(edge / 2 + 10)}};
  const Vec3 burr(0.5 * (edge - 1));
  out.density.reserve(out.box.count());
  for_each_voxel(out.box, [&](const Vec3i& v) {
    const double face = 0.5 * edge + 3.0 * std::sin(0.11 * v.x) + 2.0 * std::cos(0.17 * v.y);
    const double within = 4.0 - std::min({v.x, v.y, edge - 1 - v.x, edge - 1 - v.y, v.z});  // the sides and the bottom are closed
    out.density.push_back(static_cast<float>(std::clamp(0.5 - std::max(v.z - face, within), 0.0, 1.0)));
  });
  out.drilled = out.density;
  for_each_voxel(out.changed, [&](const Vec3i& v) {
    float& left = out.drilled[out.box.offset_of(v)];
    left = std::min(left, static_cast<float>(std::clamp(0.5 + glm::length(Vec3(v) - burr) - kBurrRadius, 0.0, 1.0)));
  });
  return out;
}

/// @returns the triangles by their voxels, and their positions, in an order that does not depend on that of the pivoting.
std::vector<std::array<float, 9>> sorted_triangles(const BallMesh& mesh) {
  const SurfaceMesh surface = mesh.surface();
  std::vector<std::array<float, 9>> out;
  for (std::size_t n = 0; n < surface.indices.size(); n += 3) {
    std::array<std::array<float, 3>, 3> corners{};
    for (std::size_t m = 0; m < 3; ++m) {
      const Vec3f p(surface.positions[surface.indices[n + m]]);
      corners[m] = {p.x, p.y, p.z};
    }
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    std::array<float, 9>& flat = out.emplace_back();
    for (std::size_t m = 0; m < 9; ++m) flat[m] = corners[m / 3][m % 3];
  }
  std::ranges::sort(out);
  return out;
}

double volume_of(const SurfaceMesh& mesh) { return check_mesh(mesh).volume; }

/// Times a full pivoting. The baseline is OpenVDB's dual contouring of the same density, whose volume must agree. The triangles must be
/// those of another mesh to which the burr's ball grows back.
Status compare_full(Bench& bench, const Patch& patch, bool subvoxel) {
  const BallMeshConfig config{.subvoxel = subvoxel};
  auto mesh = BallMesh::create(patch.box, config), grown = BallMesh::create(patch.box, config);
  if (!mesh) return mesh.error();
  if (!grown) return grown.error();
  const DensitySource source{
      .regions = {patch.box}, .bone_from_index = {}, .read = [&](const VoxelBox& box, std::span<float> out) {
        std::size_t n = 0;
        for_each_voxel(box, [&](const Vec3i& v) { out[n++] = patch.box.contains(v) ? patch.density[patch.box.offset_of(v)] : 0.0f; });
      }};
  auto contours = make_bone_surface(source);
  if (!contours) return contours.error();
  mesh->fill(patch.before());
  const double points = static_cast<double>(mesh->half_edges().vertices());
  const std::string name = fmt::format("full pivoting{} over volumeToMesh, {}^3, {} points, {} triangles", subvoxel ? " and offsets" : "",
                                       patch.box.size().x, mesh->half_edges().vertices(), mesh->half_edges().triangles());
  const double expected = volume_of(*contours), found = take_census(*mesh).volume;
  // At the centres the mesh lies up to a voxel inside the surface: its volume is compared for the order of size.
  grown->fill(patch.after());
  grown->update(patch.before(), patch.changed);
  if (!bench.require(name, std::abs(found / expected - 1.0) < (subvoxel ? 0.01 : 0.1), "the volumes differ") ||
      !bench.agree(name, bytes_of(sorted_triangles(*grown)), bytes_of(sorted_triangles(*mesh))))
    return {};
  const Side by_contours{{}, [&] { contours = make_bone_surface(source); }};
  const Side by_ball{{}, [&] { mesh->fill(patch.before()); }};
  bench.add_speed_up(name, "ns/point", 1e9 / points, bench.time(by_contours, by_ball));
  return {};
}

/// Times the update after a burr in 20^3 voxels. The baseline is a full pivoting; the triangles must be the same.
Status compare_update(Bench& bench, const Patch& patch, bool subvoxel) {
  const BallMeshConfig config{.subvoxel = subvoxel};
  auto mesh = BallMesh::create(patch.box, config), full = BallMesh::create(patch.box, config);
  if (!mesh) return mesh.error();
  if (!full) return full.error();
  mesh->fill(patch.before());
  const std::uint64_t touched = mesh->work().triangles_touched();
  mesh->update(patch.after(), patch.changed);
  full->fill(patch.after());
  const std::uint64_t of_update = mesh->work().triangles_touched() - touched;
  const std::string name = fmt::format("update{} of 20^3 voxels over full pivoting, {}^3, {} triangles touched",
                                       subvoxel ? " and offsets" : "", patch.box.size().x, of_update);
  if (!bench.require(name, of_update > 500, "the burr does not cut the face") ||
      !bench.agree(name, bytes_of(sorted_triangles(*full)), bytes_of(sorted_triangles(*mesh))))
    return {};
  const Side by_full{{}, [&] { full->fill(patch.after()); }};
  const Side by_update{[&] { mesh->update(patch.before(), patch.changed); }, [&] { mesh->update(patch.after(), patch.changed); }};
  const Medians medians = bench.time(by_full, by_update);
  bench.add_speed_up(name, "us", 1e6, medians);
  bench.add_absolute(name + ": per triangle", "ns/triangle", 1e9 * medians.value / static_cast<double>(of_update), true);
  return {};
}

}  // namespace

Status bench_mesh(Bench& bench) {
  for (const int edge : {128, 256}) {
    const Patch patch = make_patch(bench.quick() ? edge / 2 : edge);
    for (const bool subvoxel : {false, true}) {
      if (Status done = compare_full(bench, patch, subvoxel); !done) return done;
      if (Status done = compare_update(bench, patch, subvoxel); !done) return done;
    }
  }
  // About a million points: what a whole skull patch has at fine voxels.
  return bench.quick() ? Status{} : compare_full(bench, make_patch(512), true);
}

}  // namespace burrhole
