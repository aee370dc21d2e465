// The meshes that ball pivoting is compared with, and the study itself. No time is judged.
#include "app/lab/mesh_cost.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "app/lab/local_net.h"
#include "app/lab/mesh_bodies.h"
#include "app/lab/vdb_mesher.h"

using namespace burrhole;

namespace {

using Triangle = std::array<std::array<float, 3>, 3>;

std::vector<Triangle> triangles_of(const SurfaceMesh& mesh) {
  std::vector<Triangle> out;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    Triangle& one = out.emplace_back();
    for (std::size_t m = 0; m < 3; ++m) {
      const Vec3f p(mesh.positions[mesh.indices[n + m]]);
      one[m] = {p.x, p.y, p.z};
    }
    std::ranges::rotate(one, std::ranges::min_element(one));
  }
  std::ranges::sort(out);
  return out;
}

LocalNet net_of(const DensityBlock& block, bool moved) {
  LocalNet out(block.box, moved);
  out.fill(block);
  return out;
}

MeshCost cost_with(double update_ms, double full_ms, double small_ms) {
  MeshCost out;
  for (const int edge : {64, kBoundEdge}) {
    MeshModelTimes model{.edge = edge, .methods = {}, .triangles = 100e3, .touched = 1000.0};
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}}) {
      model.methods[n].update_ms = edge == 64 ? small_ms : update_ms;
      model.methods[n + 2].update_ms = full_ms;
    }
    out.models.push_back(model);
  }
  return out;
}

}  // namespace

TEST_CASE("surface nets: after an update they are those of the whole, and a change outside of the box shows") {
  for (const std::string& name : mesh_body_names())
    for (const bool moved : {false, true}) {
      CAPTURE(name);
      CAPTURE(moved);
      const auto body = make_mesh_body(name);
      REQUIRE(body.ok());
      LocalNet net = net_of(body->block_before(), moved);
      const std::vector<Triangle> before = triangles_of(net.surface()), after = triangles_of(net_of(body->block_after(), moved).surface());
      REQUIRE(before != after);
      net.update(body->block_after(), body->changed);
      CHECK(triangles_of(net.surface()) == after);
      CHECK(net.triangles() == after.size());
      net.update(body->block_before(), body->changed);
      CHECK(triangles_of(net.surface()) == before);
      // Sabotage: a density outside of the box changes too, and no box has it.
      net.update(body->block_after(), body->changed);
      std::vector<float> more = body->after;
      const auto found = std::ranges::find_if(more, [](float d) { return d > 0.6f && d < 0.9f; });
      REQUIRE(found != more.end());
      *found -= 0.05f;
      CHECK(triangles_of(net.surface()) != triangles_of(net_of({body->box, more}, moved).surface()));
    }
}

TEST_CASE("surface nets and volumeToMesh: closed, of the ball's volume; a net that is moved lies on the 0.5 level") {
  const auto body = make_mesh_body("ball");
  REQUIRE(body.ok());
  VdbMesher mesher(body->block_after());
  mesher.extract();
  for (const SurfaceMesh& mesh :
       {net_of(body->block_after(), false).surface(), net_of(body->block_after(), true).surface(), mesher.surface()}) {
    const MeshShape shape = measure_mesh_shape(mesh);
    CHECK(shape.border_edges == 0);
    CHECK(shape.non_manifold_edges == 0);
    CHECK(std::abs(shape.volume / body->volume - 1.0) < 0.02);  // chords of a voxel
  }
  const DensityBlock block = body->block_after();
  for (const Vec3& p : net_of(block, true).surface().positions) CHECK(std::abs(glm::length(p - Vec3(0.31, -0.17, 0.43)) - 15.0) < 0.06);
}

TEST_CASE("volumeToMesh: after a write it is the mesh of the new density, and a box has the same triangles within") {
  const auto body = make_mesh_body("patch");
  REQUIRE(body.ok());
  VdbMesher kept(body->block_before()), fresh(body->block_after());
  kept.extract();
  fresh.extract();
  const std::vector<Triangle> whole = triangles_of(fresh.surface());
  CHECK(triangles_of(kept.surface()) != whole);
  kept.write(body->block_after(), body->changed);
  kept.extract();
  CHECK(triangles_of(kept.surface()) == whole);
  kept.extract_box(body->block_after(), body->changed);
  const auto inside = [&](const Triangle& one) {
    return std::ranges::all_of(one, [&](const std::array<float, 3>& p) {
      const Vec3 at(p[0], p[1], p[2]);
      return glm::all(glm::greaterThan(at, Vec3(body->changed.lo))) && glm::all(glm::lessThan(at, Vec3(body->changed.hi - 1)));
    });
  };
  std::vector<Triangle> of_box = triangles_of(kept.surface()), of_whole = whole;
  std::erase_if(of_box, [&](const Triangle& one) { return !inside(one); });
  std::erase_if(of_whole, [&](const Triangle& one) { return !inside(one); });
  CHECK(of_whole.size() > 300);
  CHECK(of_box == of_whole);
}

TEST_CASE("mesh cost: all methods of a body and of a model are reported; pivoting leaves no border and sub-voxel vertices are nearer") {
  const auto cost = measure_mesh_cost({.bodies = {"ball"}, .edges = {64}, .updates = 2, .wholes = 1});
  REQUIRE(cost.ok());
  REQUIRE(cost->qualities.size() == kMeshKinds);
  for (const MeshQuality& q : cost->qualities) {
    CHECK(q.shape.triangles > 1000);
    CHECK(q.shape.border_edges == 0);
    CHECK(q.to_surface.mean <= q.to_surface.p99);
    CHECK(q.to_surface.p99 <= q.to_surface.most);
  }
  const auto& centres = cost->qualities[0];
  const auto& subvoxel = cost->qualities[1];
  CHECK(centres.kind == MeshKind::ball_centres);
  CHECK(centres.volume_percent < -5.0);
  CHECK(std::abs(subvoxel.volume_percent) < 1.0);
  CHECK(subvoxel.to_surface.mean < 0.2 * centres.to_surface.mean);
  REQUIRE(cost->models.size() == 1);
  CHECK(cost->models[0].touched > 500.0);
  for (const MeshTime& time : cost->models[0].methods) CHECK((time.update_ms > 0.0 && time.update_ms <= time.p99_ms && time.bytes > 0.0));
  CHECK(mesh_cost_rows(*cost).size() == kMeshKinds * 12 + kMeshMethods.size());
}

TEST_CASE("mesh cost: the JSON has the rows of cost.csv and the bounds, and says when one fails") {
  MeshCost cost = cost_with(1.0, 100.0, 1.0);
  MeshQuality& quality = cost.qualities.emplace_back();
  quality.body = "ball";
  quality.kind = MeshKind::contours;
  quality.shape.triangles = 12;
  const auto rows = mesh_cost_rows(cost);
  const auto json = nlohmann::json::parse(mesh_cost_json(cost));
  CHECK(json["schema"] == "burrhole.cost_mesh/1");
  CHECK(json["failed"] == false);
  REQUIRE(json["rows"].size() == rows.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const auto& row = json["rows"][n];
    CHECK(row.size() == 11);
    CHECK(row["subject"] == rows[n].subject);
    CHECK(row["model"] == rows[n].model);
    CHECK(row["setting"] == rows[n].setting);
    CHECK(row["error_name"] == rows[n].error_name);
    CHECK(row["error"] == rows[n].error);
    CHECK(row["bytes"].is_null() == std::isnan(rows[n].bytes));
  }
  const auto bounds = mesh_bounds(cost);
  REQUIRE(json["bounds"].size() == bounds.size());
  for (std::size_t n = 0; n < bounds.size(); ++n) {
    CHECK(json["bounds"][n]["ratio"] == bounds[n].name);
    CHECK(json["bounds"][n]["value"] == bounds[n].value);
    CHECK(json["bounds"][n]["pass"] == true);
  }
  const auto bad = nlohmann::json::parse(mesh_cost_json(cost_with(10.0, 100.0, 10.0)));
  CHECK(bad["failed"] == true);
  CHECK(std::ranges::any_of(bad["bounds"], [](const auto& bound) { return bound["pass"] == false; }));
  CHECK(nlohmann::json::parse(mesh_cost_json(MeshCost{}))["bounds"].empty());
}

TEST_CASE("mesh cost: each bound fails alone when its ratio is beyond it") {
  const auto failed = [](const MeshCost& cost) {
    std::vector<bool> out;
    for (const MeshBound& bound : mesh_bounds(cost)) out.push_back(!bound.pass());
    return out;
  };
  // 1000 of 100000 triangles are touched: an update a hundredth as long as full pivoting takes as long per triangle.
  using Failures = std::vector<bool>;
  CHECK(failed(cost_with(1.0, 100.0, 1.0)) == Failures{false, false, false, false, false, false});
  CHECK(failed(cost_with(1.0, 70.0, 1.0)) == Failures{false, true, false, false, true, false});
  CHECK(failed(cost_with(1.0, 49.0, 1.0)) == Failures{true, true, false, true, true, false});
  CHECK(failed(cost_with(1.0, 100.0, 0.6)) == Failures{false, false, true, false, false, true});
}
