#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "core/base/random.h"
#include "core/base/simd.h"
#include "core/voxel/surface_memory.h"
#include "core/voxel/surface_tile.h"
#include "tests/core/voxel/surface_cases.h"
#include "tests/core/voxel/voxel_cases.h"

using namespace burrhole;
using namespace burrhole::test;

// Equality here is bit for bit: an update computes each record as a rebuild does, from the same densities in the same order.

namespace {

const Affine kEven = Affine::scaling(0.25e-3, Vec3(0.0));

/// Uneven, turned and sheared.
Affine uneven() {
  Affine a;
  a.linear = Mat3(0.3e-3, 0.1e-3, 0.0, -0.05e-3, 0.35e-3, 0.1e-3, 0.1e-3, 0.0, 0.8e-3);
  return a;
}

/// Bone with noise, thin parts, holes and single voxels.
MasterWindow rough(const VoxelBox& box, std::uint64_t seed) {
  MasterWindow window;
  window.box = box;
  std::uint64_t n = 0;
  for_each_voxel(box, [&](const Vec3i& v) {
    const double wave = std::sin(0.31 * v.x + static_cast<double>(seed)) + std::sin(0.23 * v.y) + std::sin(0.41 * v.z);
    const double odd = uniform01(seed, n++);
    double d = std::clamp(0.5 + 0.6 * wave + 0.1 * (odd - 0.5), 0.0, 1.0);
    if (odd < 0.01) d = 1.0 - d;
    if (odd > 0.99) d = 0.5;  // exactly on the surface
    window.density.push_back(static_cast<float>(d));
  });
  return window;
}

void erode(MasterWindow& window, const VoxelBox& box, Dice& dice) {
  for_each_voxel(box, [&](const Vec3i& v) {
    float& d = window.density[window.box.offset_of(v)];
    const double kind = dice.next();
    d = kind < 0.4 ? 0.0f : kind < 0.7 ? d * static_cast<float>(dice.next()) : d;
  });
}

/// The first record that differs, as text; empty if none.
std::string difference(const SurfaceRecords& a, const SurfaceRecords& b, const VoxelBox& inside) {
  std::string first;
  const auto compare = [&](const auto& ours) {
    const auto& theirs = std::get<std::decay_t<decltype(ours)>>(b.records());
    for_each_voxel(inside, [&](const Vec3i& v) {
      if (!first.empty()) return;
      const auto &x = ours[a.box().offset_of(v)], &y = theirs[b.box().offset_of(v)];
      if (std::memcmp(&x, &y, sizeof x) != 0) first = std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
    });
  };
  std::visit(compare, a.records());
  return first;
}

}  // namespace

TEST_CASE("surface records: after random erosion an update equals a rebuild bit for bit, and a smaller box would not do") {
  int missed = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Dice dice{seed};
    const VoxelBox box{Vec3i(-7, 3, 11), Vec3i(-7, 3, 11) + (seed % 2 == 0 ? Vec3i(57, 30, 34) : Vec3i(31, 29, 26))};
    const Affine map = seed % 3 == 0 ? uneven() : kEven;
    const RecordPrecision precision = seed % 2 == 0 ? RecordPrecision::bits8 : RecordPrecision::bits16;
    MasterWindow window = rough(box, seed);
    SurfaceRecords kept(map, precision), fresh(map, precision), before(map, precision);
    kept.rebuild(window);
    for (int bite = 0; bite < 12; ++bite) {
      before.rebuild(window);
      const VoxelBox touched = dice.box_inside(box, 7);  // up to the window's edges
      erode(window, touched, dice);
      const VoxelBox changed = kept.update(window, touched);
      fresh.rebuild(window);
      REQUIRE(difference(kept, fresh, box) == "");
      // What lies outside the box returned is as it was.
      for_each_voxel(box, [&](const Vec3i& v) {
        if (!changed.contains(v) && difference(before, fresh, {v, v + 1}) != "") FAIL("changed outside the box returned");
      });
      // Sabotage: the reach of the band and no more, without the gradients' stencil.
      SurfaceRecords narrow(map, precision);
      narrow.rebuild(window);
      const VoxelBox too_small = touched.grown(4).intersect(box);
      bool lacks = false;
      for_each_voxel(box, [&](const Vec3i& v) {
        lacks = lacks || (!too_small.contains(v) && difference(before, narrow, {v, v + 1}) != "");
      });
      missed += lacks ? 1 : 0;
    }
  }
  CHECK(missed > 0);
}

TEST_CASE("surface records: inside the valid box a window knows what a larger one knows, and beyond it does not") {
  for (const bool even : {true, false}) {
    const Affine map = even ? kEven : uneven();
    const VoxelBox large{Vec3i(-20), Vec3i(40)};
    const MasterWindow world = rough(large, 5);
    SurfaceRecords whole(map, RecordPrecision::bits16), part(map, RecordPrecision::bits16);
    whole.rebuild(world);
    for (const VoxelBox& box : {VoxelBox{Vec3i(-9), Vec3i(30)}, VoxelBox{Vec3i(-12, -3, -8), Vec3i(23, 25, 31)}}) {
      part.rebuild(cut_out(world, box));
      REQUIRE_FALSE(part.valid_box().empty());
      CHECK(difference(part, whole, part.valid_box()) == "");
      CHECK(difference(part, whole, box) != "");
    }
  }
}

TEST_CASE("surface records: every SIMD level gives the same bits") {
  const VoxelBox box{Vec3i(0), Vec3i(40, 37, 33)};
  for (const Affine& map : {kEven, uneven()})
    for (const RecordPrecision precision : {RecordPrecision::bits8, RecordPrecision::bits16}) {
      SurfaceRecords first(map, precision), other(map, precision);
      first.rebuild(rough(box, 3));
      for (const SimdLevel level : simd_levels()) {
        CAPTURE(std::string(name_of(level)));
        REQUIRE(choose_simd(name_of(level)).ok());
        other.rebuild(rough(box, 3));
        CHECK(difference(first, other, box) == "");
      }
      REQUIRE(choose_simd("auto").ok());
    }
}

TEST_CASE("surface records: odd bone stays within bounds, its sides are the density's") {
  const VoxelBox box{Vec3i(0), Vec3i(30, 28, 26)};
  const auto filled = [&](auto&& f) {
    MasterWindow window;
    window.box = box;
    std::uint64_t n = 0;
    for_each_voxel(box, [&](const Vec3i& v) { window.density.push_back(f(v, n++)); });
    return window;
  };
  const std::vector<MasterWindow> odd{
      filled([](const Vec3i&, std::uint64_t) { return 0.0f; }),
      filled([](const Vec3i&, std::uint64_t) { return 1.0f; }),
      filled([](const Vec3i&, std::uint64_t) { return 0.5f; }),
      filled([](const Vec3i&, std::uint64_t n) { return 0.5f + 0.04f * static_cast<float>(uniform11(8, n)); }),  // noise just at 0.5
      filled([](const Vec3i&, std::uint64_t n) { return uniform01(9, n) < 0.5 ? 0.0f : 1.0f; }),                 // dust
      filled([](const Vec3i& v, std::uint64_t) { return (v.x + v.y + v.z) % 2 == 0 ? 0.0f : 1.0f; }),            // smooths to nothing
      filled([](const Vec3i& v, std::uint64_t) { return v == Vec3i(14, 13, 12) ? 1.0f : 0.0f; }),                // one voxel
      filled([](const Vec3i& v, std::uint64_t) { return v.x == 14 && v.y == 13 ? 0.0f : 1.0f; }),                // a hole of one voxel
      filled([](const Vec3i& v, std::uint64_t) { return v.z == 12 || v.z == 13 ? 1.0f : 0.0f; }),                // a wall of two
      filled([](const Vec3i& v, std::uint64_t) { return v.z < 12 ? 1.0f : std::nextafter(0.5f, 0.0f); }),        // barely outside
  };
  for (std::size_t n = 0; n < odd.size(); ++n)
    for (const Affine& map : {kEven, uneven()}) {
      CAPTURE(n);
      SurfaceRecords records(map, RecordPrecision::bits16);
      records.rebuild(odd[n]);
      const auto& all = std::get<std::vector<Record16>>(records.records());
      for (std::size_t v = 0; v < all.size(); ++v) {
        const SurfaceSample s = decode(all[v]);
        REQUIRE(std::abs(s.distance) <= kRecordBand);
        // Each component rounds by half a step.
        REQUIRE(glm::length(s.normal) < 1.0 + 2.0 * kRecord16Normal);
        REQUIRE((odd[n].density[v] >= 0.5f ? s.distance <= 0.0 : s.distance >= 0.0));
        // Nearly at the surface there is a normal, but where the field has no direction at all.
        if (n >= 6 && std::abs(s.distance) < 2.0) REQUIRE(glm::length(s.normal) > 1.0 - 2.0 * kRecord16Normal);
      }
    }
}

TEST_CASE("surface records: one voxel, a thin wall and a narrow hole have the surfaces that they have") {
  const VoxelBox box{Vec3i(0), Vec3i(30)};
  const auto at = [&](auto&& f, const Vec3i& v) {
    MasterWindow window;
    window.box = box;
    for_each_voxel(box, [&](const Vec3i& u) { window.density.push_back(f(u) ? 1.0f : 0.0f); });
    SurfaceRecords records(kEven, RecordPrecision::bits16);
    records.rebuild(window);
    return decode(std::get<std::vector<Record16>>(records.records())[box.offset_of(v)]);
  };
  const auto wall = [](const Vec3i& u) { return u.z == 12 || u.z == 13; };
  // The wall's faces lie half way to the empty voxels, at 11.5 and 13.5; a step of distance and rounding of floats.
  for (const auto& [z, expected, up] : {std::tuple{12, -0.5, -1.0}, {13, -0.5, 1.0}, {10, 1.5, -1.0}, {15, 1.5, 1.0}, {16, 2.5, 1.0}}) {
    const SurfaceSample s = at(wall, {15, 14, z});
    CHECK(std::abs(s.distance - expected) < 1.01 * kRecord16Distance);
    CHECK(std::abs(s.normal.z - up) < 1.01 * kRecord16Normal);
  }
  const auto hole = [](const Vec3i& u) { return u.x != 15 || u.y != 14; };
  // Detail finer than a voxel is seen as its facets' surfels: the right side, within 0.35 voxel (the facet's depth under its tips, which
  // lie half a voxel from the middle) and 30 degrees (a facet's turn from its tip).
  const auto near = [](double value, double expected) { return std::abs(value - expected) < 0.35; };
  const double turned = std::cos(30.0 / 180.0 * std::numbers::pi);
  CHECK(near(at(hole, {15, 14, 15}).distance, 0.5));
  CHECK(near(at(hole, {17, 14, 15}).distance, -1.5));
  CHECK(at(hole, {17, 14, 15}).normal.x < -turned);
  const auto single = [](const Vec3i& u) { return u == Vec3i(15, 14, 13); };
  CHECK(near(at(single, {15, 14, 13}).distance, -0.5));
  CHECK(near(at(single, {17, 14, 13}).distance, 1.5));
  CHECK(at(single, {17, 14, 13}).normal.x > turned);
}

TEST_CASE("surface records: windows of any size, and updates that miss them") {
  for (const Vec3i& size : {Vec3i(5), Vec3i(1, 9, 9), Vec3i(9, 1, 2), Vec3i(2), Vec3i(16, 5, 49), Vec3i(97, 5, 6)}) {
    const VoxelBox box{Vec3i(4), Vec3i(4) + size};
    SurfaceRecords records(kEven, RecordPrecision::bits8);
    CHECK(records.precision() == RecordPrecision::bits8);
    const MasterWindow window = rough(box, 2);
    records.rebuild(window);
    CHECK(records.box() == box);
    CHECK(std::get<std::vector<Record8>>(records.records()).size() == box.count());
    CHECK(records.update(window, VoxelBox{}).empty());
    CHECK(records.update(window, VoxelBox{Vec3i(-50), Vec3i(-40)}).empty());
    CHECK(records.update(window, box.grown(3)) == box);
  }
}

TEST_CASE("surface records: the memory of a tile is that which is predicted, and a larger tile leaves none of a smaller one") {
  // What is found decides the surfels alone, which are not made here. A voxel of a cube's edge more or less is 4 % of its volume.
  for (const Affine& map : {kEven, uneven()})
    for (const int edge : {20, 40, 54}) {
      SurfaceTile grown, at_once;
      for (int smaller = 8; smaller < edge; smaller += 3)
        grown.lay_out({Vec3i(0), Vec3i(smaller)}, {Vec3i(-50), Vec3i(150)}, SurfaceMap(map));
      for (SurfaceTile* tile : {&grown, &at_once}) tile->lay_out({Vec3i(0), Vec3i(edge)}, {Vec3i(-50), Vec3i(150)}, SurfaceMap(map));
      CHECK(grown.bytes() == at_once.bytes());
      const auto predicted = static_cast<double>(record_scratch_bytes(static_cast<std::uint64_t>(edge) * edge * edge, map));
      CHECK(predicted == doctest::Approx(static_cast<double>(at_once.bytes())).epsilon(0.05));
    }
  CHECK(record_scratch_bytes(1'000'000, kEven) == record_scratch_bytes(10'000'000, kEven));  // a larger window is made in several tiles
}
