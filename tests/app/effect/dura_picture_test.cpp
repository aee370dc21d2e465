// The dura in pictures: a closed shell of its thickness, over all soft tissue that is shown, open where it is torn.
#include "app/effect/dura_picture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/effect/dura_looks.h"
#include "app/effect/dura_rent.h"

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

namespace {

/// A dome that a pin has torn, and its picture.
struct Torn {
  Torn() : sheet(dome({.strain_limit = 0.05})), picture(sheet, kPlace, kThickness, kVoxel) {
    (void)picture.copy_for_picture(false);
    whole = mesh_of(picture);
    for (double depth = 0.0; depth < 4e-3; depth += 0.2e-3) press(sheet, depth, 0.6e-3);
    REQUIRE(sheet.state().torn > 2);
    CHECK(picture.copy_for_picture(false));
    all = mesh_of(picture);
  }
  ElasticSheet sheet;
  DuraPicture picture;
  AddedMesh whole{}, all{};
};

bool is_brain(const AddedMesh& mesh, const std::array<std::uint32_t, 3>& triangle) { return mesh.colors[triangle[0]].a == kBrainShine; }

AddedMesh part_of(const AddedMesh& mesh, bool brain) {
  AddedMesh out = mesh;
  std::erase_if(out.triangles, [&](const auto& triangle) { return is_brain(mesh, triangle) != brain; });
  return out;
}

/// Whether a triangle lies over or under a point, along z of the sheet.
bool covers(const AddedMesh& mesh, const Vec3& p) {
  const auto side = [&](const Vec3& a, const Vec3& b) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); };
  return std::ranges::any_of(mesh.triangles, [&](const auto& t) {
    const Vec3 a = kPlace.inverse() * Vec3(mesh.vertices[t[0]]), b = kPlace.inverse() * Vec3(mesh.vertices[t[1]]),
               c = kPlace.inverse() * Vec3(mesh.vertices[t[2]]);
    const double u = side(a, b), v = side(b, c), w = side(c, a);
    return (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
  });
}

/// The largest angle [deg] between the normals of a triangle and of its corners, which light is computed with, within `reach` of the middle of the
/// sheet. A normal is the mean over the triangles at a vertex, as the renderer has it. 90 degrees and more: a face is lit from its wrong side.
double sharpest(const AddedMesh& mesh, double reach) {
  const auto normal_of = [&](const auto& t) {
    const Vec3 a(mesh.vertices[t[0]]);
    return glm::cross(Vec3(mesh.vertices[t[1]]) - a, Vec3(mesh.vertices[t[2]]) - a);
  };
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3(0.0));
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t n : t) normals[n] += normal_of(t);
  double least = 1.0;
  for (const auto& t : mesh.triangles) {
    if (glm::length(Vec3(mesh.vertices[t[0]]) - kPlace.translation) > reach) continue;
    for (const std::uint32_t n : t) least = std::min(least, glm::dot(glm::normalize(normal_of(t)), glm::normalize(normals[n])));
  }
  return std::acos(least) * 180.0 / 3.14159265358979;
}

/// Places with several vertices of different normals, within `reach` of the middle: creases, where light jumps.
int creases(const AddedMesh& mesh, double reach) {
  std::map<std::array<float, 3>, std::uint32_t> first;
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t n : t) used[n] = 1;
  int out = 0;
  for (std::uint32_t n = 0; n < mesh.vertices.size(); ++n) {
    const glm::vec3& v = mesh.vertices[n];
    if (used[n] == 0 || glm::length(Vec3(v) - kPlace.translation) > reach) continue;
    out += first.try_emplace({v.x, v.y, v.z}, n).second ? 0 : 1;
  }
  return out;
}

}  // namespace

TEST_CASE("dura picture: a rent is a gap in a closed shell, over brain that lies deeper and reaches under its edge") {
  const Torn torn;
  const AddedMesh shell = part_of(torn.all, false), brain = part_of(torn.all, true);
  CHECK(open_edges(shell) == 0);
  CHECK(volume_of(shell) < volume_of(torn.whole));
  REQUIRE_FALSE(brain.triangles.empty());
  CHECK(part_of(torn.whole, true).triangles.empty());
  CHECK(torn.all.colors.size() == torn.all.vertices.size());
  int gaps = 0;
  for (std::size_t e = 0; e < torn.sheet.lattice().edges().size(); ++e) {
    if (!torn.sheet.is_broken(e)) continue;
    const SheetEdge& edge = torn.sheet.lattice().edges()[e];
    const Vec3 middle = 0.5 * (torn.sheet.rest(edge.a) + torn.sheet.rest(edge.b));
    CHECK(torn.picture.shown(kPlace * (middle - Vec3(0.0, 0.0, kThickness)), kVoxel) == 0.0);
    CHECK(covers(torn.whole, middle));
    CHECK(covers(brain, middle));
    gaps += covers(shell, middle) ? 0 : 1;
  }
  CHECK(gaps > 2);
  // The brain lies below the inner face everywhere, and below its voxels nowhere within the gap.
  for (const auto& t : brain.triangles) {
    const Vec3 p = kPlace.inverse() * Vec3(brain.vertices[t[0]]);
    CHECK(p.z < -kThickness);
    if (!covers(shell, p)) CHECK(torn.picture.shown(kPlace * p, kVoxel) == 0.0);
  }
}

TEST_CASE("dura picture: light runs round the edge of a rent: no crease, and no normal far from its faces; a square edge is noticed") {
  const Torn torn;
  const AddedMesh shell = part_of(torn.all, false);
  constexpr double kWithin = 6e-3;  // [m] the rim of the sheet, which is cut square, lies at 8 mm
  CHECK(creases(shell, kWithin) == 0);
  // A lip is a half circle in 5 parts: its faces turn by 36 degrees. At its ends, and across a corner of the edge, a normal is a mean of faces that
  // differ by twice that.
  CHECK(sharpest(shell, kWithin) < 75.0);
  // The sabotage: faces that share no vertex, as flat strips; and a vertex moved through the shell.
  AddedMesh strips = shell;
  for (auto& t : strips.triangles)
    for (std::uint32_t& n : t) {
      strips.vertices.push_back(glm::vec3(strips.vertices[n]));
      n = static_cast<std::uint32_t>(strips.vertices.size() - 1);
    }
  CHECK(creases(strips, kWithin) > 100);
  AddedMesh dented = shell;
  dented.vertices[dented.triangles[dented.triangles.size() / 2][0]] -= glm::vec3(kPlace.rotate(Vec3(0.0, 0.0, 2.0 * kThickness)));
  CHECK(sharpest(dented, kWithin) > 75.0);
}

TEST_CASE("dura picture: a sheet that tears further, and one that is whole again, are drawn as by a picture that has seen nothing else") {
  ElasticSheet sheet = dome({.strain_limit = 0.05});
  DuraPicture picture(sheet, kPlace, kThickness, kVoxel);
  const auto same = [&] {
    (void)picture.copy_for_picture(true);
    DuraPicture fresh(sheet, kPlace, kThickness, kVoxel);
    (void)fresh.copy_for_picture(true);
    const AddedMesh mesh = mesh_of(picture), anew = mesh_of(fresh);
    return mesh.vertices == anew.vertices && mesh.triangles == anew.triangles && mesh.colors == anew.colors;
  };
  CHECK(same());
  std::size_t before = 0;
  int further = 0;
  for (const double wide : {0.6e-3, 1.5e-3, 2.5e-3}) {
    press(sheet, 1e-3, wide);
    press(sheet, 4e-3, wide);
    CHECK(same());
    further += sheet.state().torn > before ? 1 : 0;
    before = sheet.state().torn;
  }
  CHECK(further > 1);
  sheet = dome({.strain_limit = 0.05});
  CHECK(same());
}

TEST_CASE(
    "dura rent: a lattice torn at random has the opening of a plain sum over all its torn triangles, and its near nodes are in their "
    "reach") {
  auto lattice = SheetLattice::create(9e-3, 0.4e-3);
  REQUIRE(lattice);
  std::vector<std::uint8_t> broken(lattice->edges().size(), 0);
  std::uint32_t dice = 7;
  const auto next = [&] {
    dice = dice * 1664525u + 1013904223u;
    return dice >> 8;
  };
  for (std::uint8_t& one : broken) one = next() % 40 == 0 ? 1 : 0;
  const DuraRent rent(*lattice, broken);
  std::vector<glm::dvec2> torn;
  for_each_triangle(*lattice, [&](const DuraRent::Nodes& nodes) {
    bool whole = true;
    glm::dvec2 middle(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      whole = whole && rent.is_held(nodes[k]) && broken[lattice->edge(nodes[k], nodes[(k + 1) % 3])] == 0;
      middle += glm::dvec2(lattice->x(nodes[k]), lattice->y(nodes[k])) / 3.0;
    }
    if (!whole) torn.push_back(middle);
  });
  REQUIRE(torn.size() > 100);
  const double spacing = lattice->spacing(), width = DuraRent::kBlur * spacing;
  const auto plain = [&](const glm::dvec2& p) {
    double sum = 0.0;
    for (const glm::dvec2& middle : torn)
      if (glm::length(p - middle) <= 3.0 * width) sum += std::exp(-0.5 * glm::dot(p - middle, p - middle) / (width * width));
    return sum * 0.25 * std::sqrt(3.0) * spacing * spacing / (2.0 * 3.14159265358979 * width * width);
  };
  int open = 0;
  for (int n = 0; n < 2000; ++n) {
    const glm::dvec2 p = (glm::dvec2(next() % 10000, next() % 10000) / 10000.0 - 0.5) * 18e-3;
    CHECK(std::abs(rent.at(p).share - plain(p)) < 1e-12);
    open += plain(p) > 0.0 ? 1 : 0;
  }
  CHECK(open > 100);
  std::size_t near = 0;
  for (std::uint32_t n = 0; n < lattice->nodes(); ++n) {
    const glm::dvec2 p(lattice->x(n), lattice->y(n));
    double nearest = 1.0;
    for (const glm::dvec2& middle : torn) nearest = std::min(nearest, glm::length(p - middle));
    const double reach = (3.0 * DuraRent::kBlur + 1.0) * spacing;
    if (std::abs(nearest - reach) < 1e-9 * spacing) continue;  // by rounding either
    CHECK(rent.is_near(n) == (nearest < reach));
    near += rent.is_near(n) ? 1 : 0;
  }
  CHECK(near > 100);
  CHECK(near < lattice->nodes());
}

TEST_CASE("dura rent: in the middle of a wide rent what no edge holds follows a level rim") {
  auto lattice = SheetLattice::create(20e-3, 0.3e-3);
  REQUIRE(lattice);
  const std::vector<std::uint8_t> broken(lattice->edges().size(), 1);
  const DuraRent rent(*lattice, broken);
  std::vector<Vec3> moved(lattice->nodes(), Vec3(0.0, 0.0, 1e-3));
  for (std::uint32_t n = 0; n < moved.size(); ++n)
    if (!rent.is_held(n)) moved[n] = Vec3(7.0);
  rent.fill_lost(moved);
  for (const Vec3& m : moved) CHECK(glm::length(m - Vec3(0.0, 0.0, 1e-3)) < 1e-9);  // means of equal vectors; sweeps from rest leave 1e-3
}

TEST_CASE("dura rent: where all is torn the opening is 1, its slope is its derivative, and what no edge holds has its neighbours' motion") {
  auto lattice = SheetLattice::create(6e-3, 1e-3);
  REQUIRE(lattice);
  std::vector<std::uint8_t> broken(lattice->edges().size(), 0);
  CHECK(DuraRent(*lattice, broken).empty());
  for (std::size_t e = 0; e < broken.size(); ++e) {
    const SheetEdge& edge = lattice->edges()[e];
    const auto within = [&](std::uint32_t n) { return std::hypot(lattice->x(n), lattice->y(n)) < 2.6e-3; };
    broken[e] = within(edge.a) || within(edge.b) ? 1 : 0;
  }
  const DuraRent rent(*lattice, broken);
  std::vector<Vec3> moved(lattice->nodes(), Vec3(0.0, 0.0, 1e-3));
  std::size_t lost = 0;
  for (std::uint32_t n = 0; n < moved.size(); ++n)
    if (!rent.is_held(n)) moved[n] = Vec3(7.0), ++lost;
  CHECK(lost > 10);
  rent.fill_lost(moved);
  for (const Vec3& m : moved) CHECK(glm::length(m - Vec3(0.0, 0.0, 1e-3)) < 1e-5);  // 40 sweeps over four rings
  // The sum over a lattice is the integral but for its first harmonic, 4 pi / (sqrt(3) s): below exp(-(7.26 x 0.42)^2 / 2) = 1 %, six of them.
  for (double x = -0.9e-3; x < 0.9e-3; x += 0.13e-3) {
    const glm::dvec2 p(x, 0.4 * x);
    CHECK(rent.at(p).share == doctest::Approx(1.0).epsilon(0.06));
    const glm::dvec2 edge = p + glm::dvec2(2.8e-3, 0.0);
    const double h = 1e-7;
    CHECK((rent.at(edge + glm::dvec2(h, 0.0)).share - rent.at(edge - glm::dvec2(h, 0.0)).share) / (2.0 * h) ==
          doctest::Approx(rent.at(edge).slope.x).epsilon(0.02));
  }
  CHECK(rent.at({5.5e-3, 0.0}).share < 0.01);
}

}  // namespace burrhole::test
