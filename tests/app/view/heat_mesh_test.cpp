// The colour of heat: against the closed form of a source under an insulated face, against the cells round each vertex in uneven bone and oblique
// frames; its edge, its size, and what it must not do. A colour taken from the next cell, and a wrong diffusivity, are noticed.
#include "app/view/heat_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace burrhole::test {
namespace {

constexpr double kPi = std::numbers::pi, kBody = 37.0;
constexpr int kCellVoxels = 2;
const BoneCells kCells(kCellVoxels);
const HeatPictureConfig kScale{.lowest = 40.0, .highest = 70.0};

/// The stops of the report's map, written out again.
Vec3 plain_ramp(double share) {
  const std::array<double, 6> at{0.0, 0.25, 0.5, 0.75, 0.9, 1.0};
  const std::array<Vec3, 6> color{{{44, 17, 95}, {114, 31, 129}, {183, 55, 121}, {241, 96, 93}, {254, 176, 120}, {252, 253, 191}}};
  for (std::size_t n = 1; n < at.size(); ++n)
    if (share <= at[n]) return glm::mix(color[n - 1], color[n], (share - at[n - 1]) / (at[n] - at[n - 1]));
  return color.back();
}
/// The place on the scale that a colour stands for, by search. A channel is rounded by half a step, of at least 280 steps a unit of the scale in
/// the steepest channel of each part: within kDecoded.
constexpr double kDecoded = 0.004;
double decoded(const Rgba8& color) {
  double best = 0.0, least = 1e9;
  for (int n = 0; n <= 2000; ++n) {
    const double apart = glm::length(plain_ramp(n / 2000.0) - Vec3(color.r, color.g, color.b));
    if (apart < least) {
      least = apart;
      best = n / 2000.0;
    }
  }
  return best;
}
bool is_edge(const Rgba8& color) { return color.r == 44 && color.g == 17 && color.b == 95; }

Affine oblique(double x, double y, double z) {
  const Mat3 turn = glm::mat3_cast(glm::normalize(Quat(0.9, 0.2, -0.1, 0.3)));
  return {{turn[0] * x, turn[1] * y, turn[2] * z}, Vec3(0.03, -0.02, 0.01)};
}
Vec3 edges_of(const Affine& frame) {
  return Vec3(glm::length(frame.linear[0]), glm::length(frame.linear[1]), glm::length(frame.linear[2])) * static_cast<double>(kCellVoxels);
}

struct Site {
  Affine frame;
  HeatField field;
  HeatPicture picture;
  std::vector<float> density;

  /// @param bone density of a voxel.
  template <class Bone>
  Site(const Affine& at, const VoxelBox& cells, const HeatPictureConfig& config, const Bone& bone)
      : frame(at), field(make_field(at, cells)), picture(field, kCells, kCells.voxels_of(cells), at, kBody, config) {
    const VoxelBox voxels = kCells.voxels_of(cells);
    for_each_voxel(voxels, [&](const Vec3i& voxel) { density.push_back(bone(voxel)); });
    std::vector<float> share(cells.count());
    kCells.mean(cells, density, share);
    field.set_bone(cells, share);
    field.forget_losses();
    picture.set_bone(voxels, density);
  }
  static HeatField make_field(const Affine& at, const VoxelBox& cells) {
    auto made = HeatField::create({}, edges_of(at), cells);
    REQUIRE(made.ok());
    return std::move(made).value();
  }
  [[nodiscard]] AddedMesh mesh() {
    (void)picture.copy_for_picture(false);
    AddedMesh out;
    picture.append_mesh(out);
    CHECK(out.colors.size() == out.vertices.size());
    CHECK(out.unlit == std::vector<std::uint8_t>(out.vertices.size(), kHeatUnlit));
    for (const auto& triangle : out.triangles)
      for (const std::uint32_t n : triangle) REQUIRE(n < out.vertices.size());
    for (const glm::vec3& p : out.vertices) REQUIRE(is_finite(Vec3(p)));
    return out;
  }
};

float below_zero(const Vec3i& voxel) { return voxel.z < 0 ? 1.0f : 0.0f; }

/// A source of `joule` in the cell under an insulated face, released at once: twice the closed form of endless bone.
struct Source {
  double joule, diffusivity, heat = 1810.0 * 1250.0;
  [[nodiscard]] double rise(double r, double t) const {
    return 2.0 * joule / (heat * std::pow(4.0 * kPi * diffusivity * t, 1.5)) * std::exp(-r * r / (4.0 * diffusivity * t));
  }
  [[nodiscard]] double largest(double r) const { return rise(r, r * r / (6.0 * diffusivity)); }
};

struct HotSpot {
  double worst = 0.0;                                               // error over its bound, of colours beyond 2 cells
  double nearest = 1e9, farthest = 0.0, radius = 0.0, slack = 0.0;  // [m] of the edge, of the closed form, and its bound
  double area = 0.0;                                                // [m^2]
};

/// @param assumed diffusivity of the closed form over that of the field. @param shift [voxels] by which the picture is displaced.
HotSpot draw_hot_spot(double assumed, const Vec3& shift) {
  const double edge = 0.25e-3, cell = kCellVoxels * edge;
  Site site(oblique(edge, edge, edge), {Vec3i(-22, -22, -22), Vec3i(22, 22, 2)}, kScale, below_zero);
  const HeatConfig config{};
  const double end = 16.0 * cell * cell / (2.0 * config.diffusivity());  // the deviation sqrt(2 alpha t) is 4 cells
  const Source real{.joule = 1.0, .diffusivity = config.diffusivity()};
  const Source source{.joule = 30.0 / real.rise(0.0, end), .diffusivity = config.diffusivity() * assumed};  // 30 K in the middle
  site.field.release_at({0, 0, -1}, source.joule);
  double time = 0.0;
  while (time < end) {
    site.field.step(site.field.longest_step());
    time += site.field.longest_step();
  }
  const AddedMesh mesh = site.mesh();
  REQUIRE(mesh.triangles.size() > 500);
  // The middle of the cell of the source, on the face at index z = -1/2.
  const Vec3 middle(0.5, 0.5, -0.5);
  const double top = source.rise(0.0, time);
  HotSpot out;
  // Bilinear between cells, 2 h^2 / 8, and the depth of a cell's middle, (h / 2)^2 / 2, times the largest second derivative, top / (16 h^2);
  // the field itself within 3 % of the largest rise at its place (heat_test); the colour within kDecoded of the scale, 30 K.
  const auto bound = [&](double r) { return (0.25 + 0.125) * top / 16.0 + 0.03 * source.largest(r) + kDecoded * 30.0; };
  double lo = 2.0 * cell, hi = 20.0 * cell;
  for (int n = 0; n < 60; ++n) (source.rise(0.5 * (lo + hi), time) > 3.0 ? lo : hi) = 0.5 * (lo + hi);  // 40 C
  out.radius = lo;
  out.slack = bound(lo) / (lo / (2.0 * source.diffusivity * time) * 3.0);  // over the slope of the rise
  const Affine index_from_bone = site.frame.inverse();
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    const Vec3 way = index_from_bone * Vec3(mesh.vertices[n]) + shift - middle;
    CHECK(way.z == doctest::Approx(0.25).epsilon(0.01));  // [voxels] lifted
    const double r = std::hypot(way.x, way.y) * edge;
    if (is_edge(mesh.colors[n])) {
      out.nearest = std::min(out.nearest, r);
      out.farthest = std::max(out.farthest, r);
    } else if (r > 2.0 * cell) {
      const double shown = kBody + 3.0 + 30.0 * decoded(mesh.colors[n]);
      out.worst = std::max(out.worst, std::abs(shown - kBody - source.rise(r, time)) / bound(r));
    }
  }
  for (const auto& [a, b, c] : mesh.triangles)
    out.area += 0.5 * glm::length(glm::cross(Vec3(mesh.vertices[b] - mesh.vertices[a]), Vec3(mesh.vertices[c] - mesh.vertices[a])));
  return out;
}

}  // namespace

TEST_CASE("heat mesh: a source under a face is a round spot with the colours and the edge of the closed form") {
  const HotSpot spot = draw_hot_spot(1.0, Vec3(0.0));
  MESSAGE("colours: " << spot.worst << " of the bound; edge at " << spot.nearest * 1e3 << " to " << spot.farthest * 1e3 << " mm, "
                      << spot.radius * 1e3 << " +- " << spot.slack * 1e3 << " expected");
  CHECK(spot.worst < 1.0);
  CHECK(spot.nearest > spot.radius - spot.slack);
  CHECK(spot.farthest < spot.radius + spot.slack);
  // Whole, without holes: between the discs of the two radii.
  CHECK(spot.area > kPi * std::pow(spot.radius - spot.slack, 2));
  CHECK(spot.area < kPi * std::pow(spot.radius + spot.slack, 2));
  // The sabotage: a spot that is displaced by two cells, and another conductivity.
  CHECK(draw_hot_spot(1.0, Vec3(4.0, 0.0, 0.0)).worst > 1.0);
  CHECK(draw_hot_spot(1.3, Vec3(0.0)).worst > 1.0);
}

TEST_CASE("heat mesh: in uneven bone and in any frame a vertex has a colour between those of the bone's cells round it") {
  const double e = 0.25e-3;
  for (const Affine& frame : {Affine::scaling(e, Vec3(0.0)), oblique(e, 1.4 * e, 0.8 * e), oblique(-e, e, 1.2 * e)}) {
    std::mt19937 dice(7);
    std::uniform_real_distribution<float> any(0.0f, 1.0f);
    const VoxelBox cells{Vec3i(-6), Vec3i(6)};
    Site site(frame, cells, kScale, [&](const Vec3i&) { return any(dice); });
    for_each_voxel(cells, [&](const Vec3i& cell) { site.field.release_at(cell, 5e-3 * static_cast<double>(any(dice))); });
    site.field.step(1e-6);
    const AddedMesh mesh = site.mesh();
    REQUIRE(mesh.triangles.size() > 1000);
    const Affine index_from_bone = frame.inverse();
    // Vertices outside of the range of their cells, displaced by `shift` cells; floats of 0.03 m have 4e-9 m, 2e-5 voxels.
    const auto outside = [&](const Vec3i& shift) {
      std::size_t count = 0;
      for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
        if (is_edge(mesh.colors[n])) continue;  // on the isotherm, between two vertices
        const Vec3 at = (index_from_bone * Vec3(mesh.vertices[n]) - 0.5) / static_cast<double>(kCellVoxels);
        double least = 1e9, most = -1e9;
        for_each_voxel({floor_int(at) - 1, floor_int(at) + 3}, [&](const Vec3i& cell) {
          if (glm::any(glm::greaterThan(glm::abs(Vec3(cell) - at), Vec3(1.0 + 1e-3))) || !(site.field.share(cell + shift) > 0.02f)) return;
          const double place = (kBody + static_cast<double>(site.field.rise(cell + shift)) - 40.0) / 30.0;
          least = std::min(least, place);
          most = std::max(most, place);
        });
        const double place = decoded(mesh.colors[n]);
        count += place < std::min(1.0, least) - kDecoded || place > std::max(0.0, most) + kDecoded ? 1 : 0;
      }
      return count;
    };
    CHECK(outside(Vec3i(0)) == 0);
    CHECK(outside(Vec3i(2, 0, 0)) > mesh.vertices.size() / 20);  // the sabotage
  }
}

TEST_CASE("heat mesh: it lies over the face, faces outwards in mirrored frames too, and cold bone has none") {
  const double e = 0.3e-3;
  for (const Affine& frame : {Affine::scaling(e, Vec3(0.0)), oblique(-e, e, e)}) {
    Site site(frame, {Vec3i(-8, -8, -4), Vec3i(8, 8, 2)}, {}, below_zero);
    CHECK(site.picture.copy_for_picture(false));
    CHECK(site.mesh().triangles.empty());
    site.field.release_at({0, 0, -1}, 0.01);
    CHECK(site.picture.copy_for_picture(false));
    CHECK_FALSE(site.picture.copy_for_picture(false));  // nothing changed
    const AddedMesh mesh = site.mesh();
    REQUIRE_FALSE(mesh.triangles.empty());
    const Vec3 outward = glm::normalize(glm::transpose(glm::inverse(frame.linear)) * Vec3(0.0, 0.0, 1.0));
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 normal = glm::cross(Vec3(mesh.vertices[b] - mesh.vertices[a]), Vec3(mesh.vertices[c] - mesh.vertices[a]));
      CHECK(glm::dot(normal, outward) >= 0.99 * glm::length(normal));
    }
  }
}

TEST_CASE("heat mesh: the highest temperature and the dose stay when bone is cold again, the present one fades; scales are as named") {
  std::array<std::size_t, 3> hot{}, cold{};
  for (std::size_t n = 0; n < 3; ++n) {
    const HeatPictureConfig config{.quantity = static_cast<HeatQuantity>(n)};
    Site site(Affine::scaling(0.25e-3, Vec3(0.0)), {Vec3i(-12, -12, -8), Vec3i(12, 12, 2)}, config, below_zero);
    site.field.release_at({0, 0, -1}, 0.05);
    site.field.advance(0.5);
    hot[n] = site.mesh().triangles.size();
    site.field.advance(60.0);
    cold[n] = site.mesh().triangles.size();
  }
  CHECK(hot[0] > 0);
  CHECK(cold[0] == 0);
  CHECK(cold[1] >= hot[1]);
  CHECK(cold[2] >= hot[2]);
  CHECK(hot[2] > 0);
  const HeatPictureConfig dose{.quantity = HeatQuantity::dose};
  CHECK(place_on_scale(dose, 1.0) == doctest::Approx(0.0));
  CHECK(place_on_scale(dose, 16.0) == doctest::Approx(0.5));
  CHECK(place_on_scale(dose, 256.0) == doctest::Approx(1.0));
  CHECK(place_on_scale(dose, 0.0) < 0.0);
  CHECK(place_on_scale(kScale, 55.0) == doctest::Approx(0.5));
  CHECK(color_bar(kScale).marks.front().second == "40");
  CHECK(color_bar(kScale).marks.back().second == "70");
  CHECK(color_bar(dose).marks[2].second == "16");
}

TEST_CASE("heat mesh: a change that cannot be seen waits, unless the copy is exact; triangles of others stay lit") {
  Site site(Affine::scaling(0.25e-3, Vec3(0.0)), {Vec3i(-12, -12, -8), Vec3i(12, 12, 2)}, {}, below_zero);
  site.field.release_at({0, 0, -1}, 0.05);
  site.field.advance(0.5);
  CHECK(site.picture.copy_for_picture(false));
  const std::vector<float> before = site.picture.shown().place;
  site.field.release_at({0, 0, -1}, 1e-6);  // a cell holds 0.28 mJ/K: 3.5 mK, 0.0002 of the scale; 1/128 is seen
  CHECK_FALSE(site.picture.copy_for_picture(false));
  CHECK(site.picture.shown().place == before);
  CHECK(site.picture.copy_for_picture(true));
  CHECK(site.picture.shown().place != before);
  CHECK_FALSE(site.picture.copy_for_picture(true));
  AddedMesh mesh{.vertices = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}},
                 .colors = {{}, {}, {}},
                 .unlit = {},
                 .triangles = {{0, 1, 2}}};
  site.picture.append_mesh(mesh);
  REQUIRE(mesh.vertices.size() > 3);
  REQUIRE(mesh.unlit.size() == mesh.vertices.size());
  for (std::size_t n = 0; n < mesh.unlit.size(); ++n) CHECK(mesh.unlit[n] == (n < 3 ? 0 : kHeatUnlit));
}

TEST_CASE("heat mesh: noise in a large box stays within the bound of triangles") {
  const VoxelBox cells{Vec3i(-50), Vec3i(50)};
  std::mt19937 dice(3);
  std::uniform_int_distribution<int> any(0, 1);
  Site site(Affine::scaling(0.25e-3, Vec3(0.0)), cells, {}, [&](const Vec3i&) { return static_cast<float>(any(dice)); });
  for_each_voxel(cells, [&](const Vec3i& cell) { site.field.release_at(cell, 3e-3); });
  const AddedMesh mesh = site.mesh();
  CHECK(mesh.triangles.size() > 100'000);
  CHECK(mesh.vertices.size() <= 19 * kMostPatchPoints);   // and one for each edge of a triangle
  CHECK(mesh.triangles.size() <= 12 * kMostPatchPoints);  // each of 6 at a point is cut in two at most
}

}  // namespace burrhole::test
