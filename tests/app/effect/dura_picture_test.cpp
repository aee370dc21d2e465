// The dura in pictures: a closed shell of its thickness, over all soft tissue that is shown, open where it is torn.
#include "app/effect/dura_picture.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>

namespace burrhole::test {
namespace {

constexpr double kThickness = 0.5e-3, kVoxel = 0.3e-3;

const Pose kPlace{glm::normalize(Quat(0.9, 0.2, -0.1, 0.3)), Vec3(0.03, -0.02, 0.01)};

ElasticSheet dome(const SheetConfig& config) {
  auto lattice = SheetLattice::create(8e-3, 1e-3);
  REQUIRE(lattice);
  std::vector<double> height;
  for (std::size_t n = 0; n < lattice->nodes(); ++n)
    height.push_back(-(lattice->x(n) * lattice->x(n) + lattice->y(n) * lattice->y(n)) / (2.0 * 75e-3));
  auto out = ElasticSheet::create(config, std::move(*lattice), height);
  REQUIRE(out);
  return std::move(out).value();
}

void press(ElasticSheet& sheet, double depth, double radius) {
  std::vector<Vec3> points;
  for (double x = -radius; x <= radius; x += 0.25e-3)
    for (double y = -radius; y <= radius; y += 0.25e-3)
      if (std::hypot(x, y) <= radius) points.emplace_back(x, y, -depth);
  for (int n = 0; n < 20; ++n) (void)sheet.step(0.02, {.tool_points = points});
}

AddedMesh mesh_of(const DuraPicture& picture) {
  AddedMesh out;
  picture.append_mesh(out);
  return out;
}

/// [m^3] inside triangles that are counter-clockwise from outside.
double volume_of(const AddedMesh& mesh) {
  double sum = 0.0;
  const Vec3 from(mesh.vertices[0]);
  for (const auto& [a, b, c] : mesh.triangles)
    sum += glm::dot(Vec3(mesh.vertices[a]) - from, glm::cross(Vec3(mesh.vertices[b]) - from, Vec3(mesh.vertices[c]) - from)) / 6.0;
  return sum;
}

/// Edges, by place, that are not passed as often in one direction as in the other.
int open_edges(const AddedMesh& mesh) {
  using Place = std::array<float, 3>;
  const auto place = [&](std::uint32_t n) { return Place{mesh.vertices[n].x, mesh.vertices[n].y, mesh.vertices[n].z}; };
  std::map<std::pair<Place, Place>, int> passed;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Place a = place(t[k]), b = place(t[(k + 1) % 3]);
      passed[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  int out = 0;
  for (const auto& [edge, sum] : passed) out += sum != 0 ? 1 : 0;
  return out;
}

}  // namespace

TEST_CASE("dura picture: at rest it is a closed shell of the sheet's area times its thickness") {
  SheetConfig config;
  ElasticSheet sheet = dome(config);
  DuraPicture picture(sheet, kPlace, kThickness, kVoxel);
  CHECK(picture.copy_for_picture(false));
  CHECK_FALSE(picture.copy_for_picture(false));  // nothing moved
  const AddedMesh mesh = mesh_of(picture);
  REQUIRE(mesh.colors.size() == mesh.vertices.size());
  CHECK(open_edges(mesh) == 0);
  double area = 0.0;
  for (std::size_t n = 0; n < sheet.lattice().nodes(); ++n)
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t b = sheet.lattice().neighbours(n)[k], c = sheet.lattice().neighbours(n)[k + 1];
      if (b == SheetLattice::kNoNode || c == SheetLattice::kNoNode) continue;
      area += 0.5 * glm::length(glm::cross(sheet.rest(b) - sheet.rest(n), sheet.rest(c) - sheet.rest(n)));
    }
  // Offset inwards by t from a sphere of R = 75 mm: 1 - t / R; the curved facets add less.
  CHECK(volume_of(mesh) == doctest::Approx(area * kThickness).epsilon(0.015));
  // The sabotage: without the walls the shell is open.
  AddedMesh open = mesh;
  open.triangles.pop_back();
  CHECK(open_edges(open) > 0);
}

TEST_CASE("dura picture: it goes as deep as the sheet, and all soft tissue that is shown lies below it") {
  SheetConfig config;
  config.strain_limit = 1.0;
  ElasticSheet sheet = dome(config);
  DuraPicture picture(sheet, kPlace, kThickness, kVoxel);
  (void)picture.copy_for_picture(false);
  const Bounds first = picture.changed();
  CHECK(glm::all(glm::lessThan(first.lo, first.hi)));
  press(sheet, 1.5e-3, 2e-3);
  CHECK(picture.copy_for_picture(false));
  const AddedMesh mesh = mesh_of(picture);
  CHECK(open_edges(mesh) == 0);
  double lowest = 0.0;
  int above = 0;
  for (const glm::vec3& v : mesh.vertices) {
    const Vec3 p = kPlace.inverse() * Vec3(v);
    lowest = std::min(lowest, p.z);
  }
  const SheetLattice& lattice = sheet.lattice();
  for (const SheetEdge& edge : lattice.edges()) {
    if (lattice.on_rim(edge.a) || lattice.on_rim(edge.b)) continue;  // by rounding, points of the rim may lie beside the sheet
    for (const double share : {0.0, 0.5, 1.0})
      above += picture.shown(kPlace * glm::mix(sheet.position(edge.a), sheet.position(edge.b), share), kVoxel) > 0.0 ? 1 : 0;
  }
  CHECK(above == 0);
  CHECK(lowest == doctest::Approx(-sheet.state().indentation - kThickness).epsilon(0.05));
  // Where the sheet at rest was, soft tissue is gone; two voxels below the shell it is shown, as it is beside the sheet.
  CHECK(picture.shown(kPlace * Vec3(0.0, 0.0, -0.3e-3), kVoxel) == 0.0);
  CHECK(picture.shown(kPlace * Vec3(0.0, 0.0, -sheet.state().indentation - kThickness - 2.0 * kVoxel), kVoxel) == 1.0);
  CHECK(picture.shown(kPlace * Vec3(9e-3, 0.0, 0.0), kVoxel) == 1.0);
  // What changed lies inside the extent, and every point whose share changed inside the box of changes.
  const Bounds changed = picture.changed(), all = picture.extent();
  CHECK(glm::all(glm::lessThanEqual(all.lo, changed.lo + 1e-9)));
  CHECK(glm::all(glm::lessThanEqual(changed.hi, all.hi + 1e-9)));
  ElasticSheet rest = dome(config);
  DuraPicture before(rest, kPlace, kThickness, kVoxel);
  (void)before.copy_for_picture(false);
  int outside = 0, differ = 0;
  for (double x = -8e-3; x <= 8e-3; x += 0.4e-3)
    for (double y = -8e-3; y <= 8e-3; y += 0.4e-3)
      for (double z = -4e-3; z <= 1e-3; z += 0.1e-3) {
        const Vec3 p = kPlace * Vec3(x, y, z);
        if (std::abs(picture.shown(p, kVoxel) - before.shown(p, kVoxel)) < 1e-9) continue;
        ++differ;
        if (glm::any(glm::lessThan(p, changed.lo)) || glm::any(glm::greaterThan(p, changed.hi))) ++outside;
      }
  CHECK(differ > 1000);
  CHECK(outside == 0);
}

TEST_CASE("dura picture: an exact copy is that of a whole new picture, whatever the copies before have left out") {
  ElasticSheet sheet = dome({});
  DuraPicture picture(sheet, kPlace, kThickness, kVoxel);
  (void)picture.copy_for_picture(false);
  press(sheet, 15e-6, 0.6e-3);  // less than a tenth of a voxel: soft tissue below is not drawn anew
  CHECK(picture.copy_for_picture(false));
  DuraPicture whole(sheet, kPlace, kThickness, kVoxel);
  (void)whole.copy_for_picture(true);
  const auto differs = [&] {
    int out = 0;
    for (double depth = 0.0; depth < 1.5e-3; depth += 10e-6) {
      const Vec3 p = kPlace * Vec3(0.1e-3, 0.1e-3, -depth);
      out += picture.shown(p, kVoxel) != whole.shown(p, kVoxel) ? 1 : 0;
    }
    return out;
  };
  CHECK(differs() > 0);
  CHECK(picture.copy_for_picture(true));
  CHECK(differs() == 0);
  CHECK(mesh_of(picture).vertices == mesh_of(whole).vertices);
  CHECK_FALSE(picture.copy_for_picture(true));
}

TEST_CASE("dura picture: a tear is a gap with walls, over brain that lies deeper") {
  SheetConfig config;
  config.strain_limit = 0.05;
  ElasticSheet sheet = dome(config);
  DuraPicture picture(sheet, kPlace, kThickness, kVoxel);
  (void)picture.copy_for_picture(false);
  const std::size_t whole = mesh_of(picture).triangles.size();
  for (double depth = 0.0; depth < 4e-3; depth += 0.2e-3) press(sheet, depth, 0.6e-3);
  REQUIRE(sheet.state().torn > 2);
  CHECK(picture.copy_for_picture(false));
  const AddedMesh torn = mesh_of(picture);
  CHECK(torn.triangles.size() < whole);
  CHECK(open_edges(torn) == 0);
  for (std::size_t e = 0; e < sheet.lattice().edges().size(); ++e) {
    if (!sheet.is_broken(e)) continue;
    const SheetEdge& edge = sheet.lattice().edges()[e];
    const Vec3 middle = 0.5 * (sheet.rest(edge.a) + sheet.rest(edge.b));
    CHECK(picture.shown(kPlace * (middle - Vec3(0.0, 0.0, kThickness)), kVoxel) == 0.0);
  }
}

}  // namespace burrhole::test
