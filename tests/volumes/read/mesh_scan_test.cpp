#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "core/base/random.h"
#include "core/base/units.h"
#include "tests/support/mesh_samples.h"
#include "tests/support/plain_trilinear.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"
#include "volumes/read/scan.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kMm = 1e-3;
constexpr std::uint64_t kSeed = 23;

ReadOptions options(std::optional<double> unit, std::optional<double> pitch = std::nullopt) {
  ReadOptions made;
  made.unit = unit;
  made.pitch = pitch;
  return made;
}

Scan scan_of(const SurfaceMesh& mesh, double pitch, MeshForm form = MeshForm::stl_binary) {
  const TemporaryFolder folder;
  const auto read = read_mesh_scan(write_mesh(folder.file("mesh"), mesh, form), options(kMm, pitch));
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  CHECK(read->scan.quantity == Quantity::occupancy);
  return read->scan;
}

std::string refusal(const std::string& path, const ReadOptions& asked, ErrorCode code = ErrorCode::bad_input) {
  const auto read = read_mesh_scan(path, asked);
  if (read) return "";
  CHECK(read.error().code == code);
  CHECK(read.error().place == path);
  return read.error().message;
}

float at(const Scan& scan, const Vec3i& v) { return scan.values[VoxelBox{Vec3i(0), scan.dims}.offset_of(v)]; }

/// Trilinear occupancy at a point of the bone frame; 0 beyond the grid.
double occupancy(const Scan& scan, const Vec3& p) {
  const Vec3 v = scan.bone_from_index.inverse() * p;
  const Vec3i lo = floor_int(v);
  if (glm::any(glm::lessThan(lo, Vec3i(0))) || glm::any(glm::greaterThanEqual(lo + 1, scan.dims))) return 0.0;
  return test::plain_trilinear(v, [&](const Vec3i& corner) { return at(scan, corner); });
}

/// Where the 0.5 level lies along from + t * along, t in [t0, t1], occupancy falling; by bisection.
double level(const Scan& scan, const Vec3& from, const Vec3& along, double t0, double t1) {
  REQUIRE(occupancy(scan, from + t0 * along) >= 0.5);
  REQUIRE(occupancy(scan, from + t1 * along) < 0.5);
  for (int n = 0; n < 60; ++n) {
    const double t = 0.5 * (t0 + t1);
    (occupancy(scan, from + t * along) >= 0.5 ? t0 : t1) = t;
  }
  return 0.5 * (t0 + t1);
}

Vec3 direction(std::uint64_t n) {
  const double z = uniform11(kSeed, 2 * n), angle = std::numbers::pi * uniform11(kSeed, 2 * n + 1);
  return {std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z};
}

/// Largest difference of a value from the ramp over the true distance to a sphere.
double farthest_value(const Scan& scan, const Vec3& centre, double radius) {
  double worst = 0.0;
  for_each_voxel({Vec3i(0), scan.dims}, [&](const Vec3i& v) {
    const Vec3 from_centre = scan.bone_from_index * Vec3(v) - centre;
    const Vec3 n = glm::normalize(from_centre);
    const double w = scan.bone_from_index.mean_edge() * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    const double expected = std::clamp(0.5 - (glm::length(from_centre) - radius) / (2 * w), 0.0, 1.0);
    worst = std::max(worst, std::abs(expected - static_cast<double>(at(scan, v))));
  });
  return worst;
}

/// Largest angle between a facet and the sphere at its corners [rad].
double largest_tilt(const SurfaceMesh& mesh, const Vec3& centre) {
  double least = 1.0;
  for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
    const Vec3 &a = mesh.positions[mesh.indices[n]], &b = mesh.positions[mesh.indices[n + 1]], &c = mesh.positions[mesh.indices[n + 2]];
    const Vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    for (const Vec3& p : {a, b, c}) least = std::min(least, glm::dot(normal, glm::normalize(p - centre)));
  }
  return std::acos(least);
}

double occupancy_volume(const Scan& scan) {
  double sum = 0.0;
  for (const float v : scan.values) sum += static_cast<double>(v);
  return sum * scan.bone_from_index.cell_volume();
}

/// Volume of a ball as its ramp shows it: the outer half weighs more on a curved surface, by (w / radius)^2, own derivation. The mean of
/// w^2 over all directions is pitch^2 (1 + 4 / pi).
double ramped_ball(double volume, double radius, double pitch) {
  return volume * (1.0 + (1.0 + 4.0 / std::numbers::pi) * (pitch / radius) * (pitch / radius));
}

double solid_volume(const Scan& scan) {
  const auto count = std::count_if(scan.values.begin(), scan.values.end(), [](float v) { return v >= 0.5f; });
  return static_cast<double>(count) * scan.bone_from_index.cell_volume();
}

Pose tilted(const Vec3& shift) { return {glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, 3))), shift}; }

/// Index of the voxel that holds a point.
Vec3i voxel_at(const Scan& scan, const Vec3& p) { return voxel_of(scan.bone_from_index.inverse() * p); }

}  // namespace

TEST_CASE("mesh to occupancy: the 0.5 level of a sphere is its surface in every direction, from every format") {
  const Vec3 centre(0.011, -0.007, 0.003);
  const double radius = 20 * kMm, pitch = 1 * kMm;
  const SurfaceMesh mesh = sphere_mesh(centre, radius, 5);
  for (const MeshForm form : {MeshForm::stl_binary, MeshForm::stl_text, MeshForm::obj, MeshForm::ply}) {
    const Scan scan = scan_of(mesh, pitch, form);
    double worst = 0.0, mean = 0.0;
    constexpr int kRays = 2000;
    for (std::uint64_t n = 0; n < kRays; ++n) {
      const double off = level(scan, centre, direction(n), 0.0, 1.3 * radius) - radius;
      worst = std::max(worst, std::abs(off));
      mean += off / kRays;
    }
    MESSAGE("0.5 level of a sphere of 20 voxels: worst " << worst / pitch << ", mean " << mean / pitch << " voxel off; values "
                                                         << farthest_value(scan, centre, radius));
    // Curvature under linear interpolation: pitch / (4 radius) of a voxel = 0.0125 (phantom.h); chords: edge 0.035 radius, so up to
    // edge^2 / (6 radius) = 0.004; and w turns with the normal from corner to corner of a cell, by up to sqrt(2) * 0.87 / 20 = 0.06 of
    // itself, which weighs distances of 0.3 voxel, mostly cancelling: 0.005. Together 0.0215.
    CHECK(worst < 0.0215 * pitch);
    // Voxel by voxel the ramp is the closed form's, less the chords: depth / (2 w), w >= 1 voxel; and less the facets' tilt, which turns n
    // and so changes w by up to sqrt(2) times itself, over at most half the ramp. A voxel sqrt(3) below the surface sees it larger.
    const double facet = largest_tilt(mesh, centre), depth = radius / pitch * (1.0 - std::cos(facet));
    const double tilt = facet * radius / (radius - std::sqrt(3.0) * pitch);
    CHECK(farthest_value(scan, centre, radius) < 0.5 * depth + 0.5 * std::sqrt(2.0) * tilt);
  }
}

TEST_CASE("mesh to occupancy: the 0.5 level of a tilted box is exactly its faces, away from its edges") {
  const Vec3 half(12 * kMm, 9 * kMm, 15 * kMm);
  const Pose pose = tilted({5 * kMm, 2 * kMm, -3 * kMm});
  const double pitch = 0.9 * kMm;
  const Scan scan = scan_of(box_mesh(half, pose), pitch);
  double worst = 0.0, worst_near_edges = 0.0;
  int plain = 0;
  for (std::uint64_t n = 0; n < 3000; ++n) {
    const Vec3 d = direction(n), t = half / glm::abs(d);
    const double exact = std::min({t.x, t.y, t.z});
    const double off = std::abs(level(scan, pose.translation, pose.rotate(d), 0.0, exact + 6 * kMm) - exact);
    Vec3 rest = half - glm::abs(exact * d);  // one is 0; the other two are the distances to the edges of that face
    const double edge = rest.x + rest.y + rest.z - std::max({rest.x, rest.y, rest.z});
    if (edge > 2.8 * pitch) {
      worst = std::max(worst, off);
      ++plain;
    } else {
      worst_near_edges = std::max(worst_near_edges, off);
    }
  }
  MESSAGE(plain << " rays on plain faces: worst " << worst / pitch << " voxel; near edges " << worst_near_edges / pitch);
  CHECK(plain > 1000);
  // Float coordinates in the file (2^-24 of 25 mm in 0.9 mm: 2e-6), float values on a slope of at least 1 / (2 * 1.74): 4e-7; and rays
  // meet a face at up to 60 degrees: twice that.
  CHECK(worst < 1e-5 * pitch);
  // Rounded edges: both faces are off together by less than a voxel along a slanted ray; stated, not exact.
  CHECK(worst_near_edges < 1.0 * pitch);
}

TEST_CASE("mesh to occupancy: volume is conserved") {
  const double pitch = 0.5 * kMm;
  const SurfaceMesh sphere = sphere_mesh({1 * kMm, 2 * kMm, 3 * kMm}, 12 * kMm, 5);
  const double ball = ramped_ball(check_mesh(sphere).volume, 12 * kMm, pitch);
  const double off = occupancy_volume(scan_of(sphere, pitch)) / ball - 1.0;
  const Vec3 half(6.1 * kMm, 7.3 * kMm, 8.9 * kMm);
  const SurfaceMesh box = box_mesh(half, tilted(Vec3(0)));
  const Scan scan = scan_of(box, pitch);
  const double exact = check_mesh(box).volume, length = 8.0 * (half.x + half.y + half.z);
  const double by_edges = (occupancy_volume(scan) - exact) / (length * pitch * pitch);
  MESSAGE("sphere: " << off << " off; box by voxels " << solid_volume(scan) / exact - 1.0 << " off, by its edges " << by_edges);
  CHECK(std::abs(off) < 3e-4);  // the next order: (w / radius)^4 = 1.6e-5, chords' w, and the sum's own chance of 1e-4
  // Voxels: n = 5000 at the surface err by chance, 0.3 of one each: 0.3 sqrt(n) / 25000 = 8e-4, and 2e-3 holds two of it.
  CHECK(std::abs(solid_volume(scan) / exact - 1.0) < 2e-3);
  // A plane's ramp keeps the volume; an edge adds pi/24 w^2 outside and lacks w^2/6 of the inner ramps' overlap: 0.298 w^2 a length, with w
  // between 1 and sqrt(3) voxels.
  CHECK(by_edges > 0.298);
  CHECK(by_edges < 3.0 * 0.298);
}

TEST_CASE("mesh to occupancy: nested shells give a hollow solid, and without the cavity's winding a full one") {
  const SurfaceMesh outer = sphere_mesh(Vec3(0), 20 * kMm, 4), inner = sphere_mesh({1 * kMm, 0, 0}, 14 * kMm, 4);
  const Scan hollow = scan_of(joined(outer, inside_out(inner)), 0.8 * kMm);
  CHECK(at(hollow, voxel_at(hollow, Vec3(0))) == 0.0f);
  CHECK(at(hollow, voxel_at(hollow, {17 * kMm, 1 * kMm, 0})) == 1.0f);
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 1000; ++n) {
    const Vec3 d = direction(n), centre(1 * kMm, 0, 0);
    // From the middle of the wall inward, so that occupancy falls.
    worst = std::max(worst, std::abs(level(hollow, centre, -d, -16.5 * kMm, 0.0) + 14 * kMm));
  }
  MESSAGE("inner wall: worst " << worst / (0.8 * kMm) << " voxel off");
  // As above: pitch / (4 radius) = 0.014; chords of 0.07 radius, edge^2 / (6 radius) = 0.011 mm = 0.014 voxel; the turning of w 0.006.
  CHECK(worst < 0.034 * 0.8 * kMm);
  const double exact =
      ramped_ball(check_mesh(outer).volume, 20 * kMm, 0.8 * kMm) - ramped_ball(check_mesh(inner).volume, 14 * kMm, 0.8 * kMm);
  CHECK(std::abs(occupancy_volume(hollow) / exact - 1.0) < 5e-4);  // as for one sphere, of a wall that is 0.66 of the ball
  const Scan full = scan_of(joined(outer, inner), 0.8 * kMm);
  CHECK(at(full, voxel_at(full, Vec3(0))) == 1.0f);
}

TEST_CASE("mesh to occupancy: overlapping parts are one solid without walls") {
  const SurfaceMesh two =
      joined(box_mesh({10 * kMm, 5 * kMm, 5 * kMm}, tilted(Vec3(0))), box_mesh({5 * kMm, 10 * kMm, 5 * kMm}, tilted(Vec3(0))));
  const Scan scan = scan_of(two, 0.5 * kMm);
  // Walls of either box inside the other lie along x = 5 and y = 5 mm of the boxes' frame.
  const Pose pose = tilted(Vec3(0));
  for (double x = -8; x <= 8; x += 0.25) {
    CHECK(occupancy(scan, pose * Vec3(x * kMm, 0, 0)) > 1.0 - 1e-12);  // the weights' own rounding
    CHECK(occupancy(scan, pose * Vec3(0, x * kMm, 0)) > 1.0 - 1e-12);
  }
}

TEST_CASE("mesh to occupancy: every value agrees with the distance over all triangles") {
  // The slow twin takes the distance to each triangle by minimising over a fine grid of its barycentric coordinates.
  const SurfaceMesh mesh = box_mesh({3 * kMm, 4 * kMm, 5 * kMm}, tilted(Vec3(0)));
  const double pitch = 1 * kMm;
  const Scan scan = scan_of(mesh, pitch);
  int compared = 0;
  double worst = 0.0;
  for_each_voxel({Vec3i(0), scan.dims}, [&](const Vec3i& v) {
    const Vec3 p = scan.bone_from_index * Vec3(v);
    const float value = at(scan, v);
    const bool inside = winding_number(mesh, p) > 0.5;
    CHECK((value >= 0.5f) == inside);
    if (value == 0.0f || value == 1.0f) return;
    double best = 1e9;
    Vec3 offset(0);
    for (std::size_t n = 0; n < mesh.indices.size(); n += 3) {
      const Vec3 a = mesh.positions[mesh.indices[n]], b = mesh.positions[mesh.indices[n + 1]], c = mesh.positions[mesh.indices[n + 2]];
      constexpr int kSteps = 100;
      for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; i + j <= kSteps; ++j) {
          const Vec3 d = p - (a + (b - a) * (i / 100.0) + (c - a) * (j / 100.0));
          if (glm::length(d) < best) best = glm::length(offset = d);
        }
    }
    if (best < 0.3 * pitch) return;  // the grid's own step of 0.1 mm would turn the direction too far
    const Vec3 n = offset / best;
    const double step = best / (2 * pitch * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)));
    worst = std::max(worst, std::abs(std::clamp(inside ? 0.5 + step : 0.5 - step, 0.0, 1.0) - static_cast<double>(value)));
    ++compared;
  });
  MESSAGE(compared << " values compared, worst " << worst);
  CHECK(compared > 300);
  // The grid's nearest point is up to 0.06 mm from the true one, across the direction: the direction errs by 0.06 / 0.3 and w by at most
  // that share of its span (1.74 - 1), the distance by 0.06^2 / (2 * 0.3): under 0.06 of the ramp in the worst corner.
  CHECK(worst < 0.06);
}

TEST_CASE("read_mesh_scan: what is assumed is reported") {
  const TemporaryFolder folder;
  const std::string path = write_mesh(folder.file("ball"), sphere_mesh(Vec3(0), 20 * kMm, 3), MeshForm::obj);
  double last = -1.0;
  ReadOptions watched = options(kMm);
  watched.progress = [&](double share) {
    CHECK(share >= last);
    last = share;
  };
  const auto read = read_mesh_scan(path, watched);
  REQUIRE(read.ok());
  CHECK(last == 1.0);
  CHECK(read->report.format == "OBJ");
  CHECK(read->scan.dims == Vec3i(256 + 7, 256 + 7, 256 + 7));
  const auto& told = read->report.assumed;
  REQUIRE(told.size() == 4);
  CHECK(told[0] == "mesh coordinates are patient LPS: +x left, +y back, +z up");
  CHECK(told[1].rfind("one unit of the file is 1 mm: the mesh is ", 0) == 0);
  CHECK(told[2] == "pitch 0.1562 mm: longest side / 256");
  CHECK(told[3].rfind("solid within 1 closed surface, ", 0) == 0);
  // Three layers of nothing on every side.
  for_each_voxel({Vec3i(0), read->scan.dims}, [&](const Vec3i& v) {
    if (glm::any(glm::lessThan(v, Vec3i(2))) || glm::any(glm::greaterThanEqual(v, read->scan.dims - 2))) REQUIRE(at(read->scan, v) == 0.0f);
  });
}

TEST_CASE("read_mesh_scan: refusals say what and how much") {
  const TemporaryFolder folder;
  const SurfaceMesh box = box_mesh({10 * kMm, 10 * kMm, 2 * kMm});
  const std::string good = write_mesh(folder.file("good"), box, MeshForm::stl_binary);
  CHECK(refusal(good, {}) == "mesh files carry no unit of length: give mm, cm, m or in (--unit; unit in a scene)");
  CHECK(refusal(good, options(-1.0)) == "unit = -1 m must be > 0");
  CHECK(refusal(good, options(kMm, 0.0)) == "pitch = 0 mm must be > 0");
  CHECK(refusal(good, options(kMm, 1.5 * kMm)) ==
        "a pitch of 1.5 mm leaves 2.7 voxels across the thinnest side of 4 mm, at least 4 are needed");
  CHECK(refusal(good, options(kMm, 0.005 * kMm)) ==
        "a pitch of 0.005 mm makes 1.3e+10 voxels (51.8 GB), at most 1e+09 are allowed: take a coarser pitch");
  CHECK(refusal(good, options(kMm, 1e-300)).rfind("a pitch of 1e-297 mm makes inf voxels", 0) == 0);
  CHECK(refusal(good, options(1.0)) == "is 2e+04 x 2e+04 x 4000 mm with this unit, and must be 1 mm to 2 m long: another --unit?");
  ReadOptions little = options(kMm, 0.1 * kMm);
  little.memory = 1e6;
  CHECK(refusal(good, little, ErrorCode::unavailable).starts_with("a pitch of 0.1 mm needs 0.00"));
  SurfaceMesh open = box;
  open.indices.resize(open.indices.size() - 3);
  CHECK(refusal(write_mesh(folder.file("open"), open, MeshForm::ply), options(kMm)) ==
        "open: 3 edges without a neighbour in 1 hole, the longest 44.4 mm around; close them in a mesh editor");
  CHECK(refusal(write_mesh(folder.file("in"), inside_out(box), MeshForm::obj), options(kMm)) ==
        "inside-out: its normals point inwards; flip them (signed volume -1.6 cm3)");
  CHECK(refusal(folder.file("none.stl"), options(kMm)) == "cannot be read: No such file or directory");
}

TEST_CASE("read_mesh_scan: triangles without area and doubled vertices are repaired by name, other bad edges are refused in one line") {
  const TemporaryFolder folder;
  const SurfaceMesh box = box_mesh({10 * kMm, 10 * kMm, 10 * kMm});
  const auto path_of = [&](const SurfaceMesh& mesh) { return write_mesh(folder.file("mesh"), mesh, MeshForm::ply); };
  const auto whole = read_mesh_scan(path_of(box), options(kMm, 1 * kMm));
  REQUIRE(whole.ok());
  SurfaceMesh soup;  // each corner of each triangle is a vertex of its own
  for (const auto index : box.indices) {
    soup.indices.push_back(static_cast<std::uint32_t>(soup.positions.size()));
    soup.positions.push_back(box.positions[index]);
  }
  SurfaceMesh thin = box;
  for (const std::uint32_t n : {0u, 0u, 1u, 2u, 3u, 3u}) thin.indices.push_back(n);
  for (const SurfaceMesh* mesh : {&soup, &thin}) {
    const auto read = read_mesh_scan(path_of(*mesh), options(kMm, 1 * kMm));
    REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
    CHECK(read->report.skipped.size() == (mesh == &thin ? 1u : 0u));
    if (mesh == &thin) CHECK((read->report.skipped[0].reason == "triangle without area" && read->report.skipped[0].count == 2));
    CHECK(read->scan.dims == whole->scan.dims);
    for_each_voxel({Vec3i(0), read->scan.dims}, [&](const Vec3i& v) { REQUIRE(at(read->scan, v) == at(whole->scan, v)); });
  }
  SurfaceMesh doubled = box, touching = box, fin = box, mixed = box, flat = box;
  doubled.indices.insert(doubled.indices.end(), box.indices.begin(), box.indices.begin() + 3);
  for (const auto index : box.indices) touching.indices.push_back(index + static_cast<std::uint32_t>(box.positions.size()));
  for (const auto& p : box.positions) touching.positions.push_back(p + Vec3(20 * kMm, 20 * kMm, 0.0));  // one edge is the other's
  fin.positions.push_back(Vec3(0.0, 0.0, 50 * kMm));
  for (const auto n : {box.indices[0], box.indices[1], static_cast<std::uint32_t>(box.positions.size())}) fin.indices.push_back(n);
  std::swap(mixed.indices[0], mixed.indices[1]);
  for (auto& p : flat.positions) p.z = 0.0;
  const auto refused = [&](const SurfaceMesh& mesh, const std::string& words) {
    const std::string text = refusal(path_of(mesh), options(kMm, 1 * kMm));
    CHECK_MESSAGE(text.find(words) != std::string::npos, text);
    CHECK(text.find('\n') == std::string::npos);
  };
  refused(doubled, "not a solid: 3 edges are shared by more than two triangles; delete");
  refused(touching, "not a solid: 1 edges are shared");
  refused(fin, "open: 2 edges without a neighbour");
  refused(mixed, "wound both ways: the triangles at 3 edges do not agree");
  CHECK(!read_mesh_scan(path_of(flat), options(kMm, 1 * kMm)).ok());
}

TEST_CASE("read_mesh_scan: vertices that differ by a rounding are joined by name") {
  const TemporaryFolder folder;
  const SurfaceMesh box = box_mesh({10 * kMm, 10 * kMm, 10 * kMm}, {Quat(0.0, 0.0, 0.0, 1.0), {10 * kMm, 0.0, 0.0}});
  const auto path_of = [&](double by) {  // one triangle has copies of its corners, moved along x
    SurfaceMesh mesh = box;
    for (std::size_t i = 0; i < 3; ++i) {
      mesh.positions.push_back(mesh.positions[mesh.indices[i]] + Vec3(by, 0.0, 0.0));
      mesh.indices[i] = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
    return write_mesh(folder.file("mesh"), mesh, MeshForm::stl_text);
  };
  const auto whole = read_mesh_scan(write_mesh(folder.file("whole"), box, MeshForm::stl_text), options(kMm, 1 * kMm));
  const auto read = read_mesh_scan(path_of(-2.9e-16 * kMm), options(kMm, 1 * kMm));
  REQUIRE(whole.ok());
  REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
  REQUIRE(read->report.assumed.size() >= 2);
  CHECK(read->report.assumed[read->report.assumed.size() - 2] ==
        "1 vertex of an open edge lies within 4.8e-06 mm of another, a rounding of 32-bit coordinates: joined");
  CHECK(read->report.assumed.size() == whole->report.assumed.size() + 1);
  CHECK(read->scan.dims == whole->scan.dims);
  double most = 0.0;
  for_each_voxel({Vec3i(0), read->scan.dims},
                 [&](const Vec3i& v) { most = std::max(most, static_cast<double>(std::abs(at(read->scan, v) - at(whole->scan, v)))); });
  CHECK(most < 1e-5);  // a shift of 4.8 nm in a ramp of 2 mm
  // Sabotage: a gap of a hundredth of a millimetre is an opening.
  CHECK(refusal(path_of(-0.01 * kMm), options(kMm, 1 * kMm)).starts_with("open: 6 edges without a neighbour in 2 holes"));
}

TEST_CASE("read_mesh_scan: real bones keep their volume") {
  const std::string data = real_data("meshes").string();
  for (const auto& [file, unit] : {std::pair{"skull.obj", 0.01}, std::pair{"footbones.ply", 0.0254}, std::pair{"apple.stl", 1.0}}) {
    const std::string path = data + "/" + file;
    const auto read = read_mesh_scan(path, options(unit));
    REQUIRE_MESSAGE(read.ok(), (read ? "" : read.error().text()));
    const Vec3i d = read->scan.dims;
    CHECK(std::max({d.x, d.y, d.z}) == 263);
    const auto mesh_volume = std::stod(read->report.assumed[3].substr(read->report.assumed[3].rfind(", ") + 2)) * 1e-6;
    MESSAGE(std::string(file) << ": " << read->report.assumed[1] << "; voxels hold " << solid_volume(read->scan) / mesh_volume - 1.0
                              << " more than the mesh");
    // Tens of thousands of surface voxels in 1e6: chance alone is 1e-4; parts that overlap count twice in the mesh's own volume.
    CHECK(std::abs(solid_volume(read->scan) / mesh_volume - 1.0) < 5e-3);
  }
}
