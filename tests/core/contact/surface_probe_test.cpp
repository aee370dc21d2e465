// surface_probe against its plain twin, bit for bit on every SIMD level, and against the truth of closed forms.
#include "core/contact/surface_probe.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/random.h"
#include "core/base/simd.h"
#include "every_level.h"
#include "surface_probe_twin.h"

using namespace burrhole;
using namespace burrhole::probe_test;

namespace {

constexpr double kLookAhead = 0.6;  // [voxel edges]
constexpr double kAllNear = 100.0;  // [voxel edges] beyond what records say
constexpr RecordPrecision kPrecisions[] = {RecordPrecision::bits8, RecordPrecision::bits16};

const VoxelBox kBox{Vec3i(-12, -10, -11), Vec3i(14, 13, 12)};

/// A tool of `count` points scattered through a ball of 6 mm, as its one part of cutting points.
ContactShellPart random_part(std::size_t count, std::uint64_t seed, double radius = 6e-3) {
  PointShell shell;
  for (std::uint64_t n = 0; n < count; ++n)
    shell.positions.push_back(radius * Vec3(uniform11(seed, 3 * n), uniform11(seed, 3 * n + 1), uniform11(seed, 3 * n + 2)));
  shell.inward_normals.assign(count, Vec3(0.0, 0.0, 1.0));
  shell.cutting.assign(count, 1);
  return make_contact_shell(shell, 0.5e-3).cutting;
}

Affine index_from_tool(const Affine& bone_from_index, std::uint64_t seed, double far = 2e-3) {
  const auto number = [&](std::uint64_t n) { return uniform11(seed, n); };
  const Pose pose{glm::normalize(Quat(number(0), number(1), number(2), number(3) + 1.5)), far * Vec3(number(4), number(5), number(6))};
  return bone_from_index.inverse() * Affine::from_pose(pose);
}

ProbeHits probed(const RecordView& bone, const ContactShellPart& part, const Affine& map, double look_ahead = kLookAhead) {
  ProbeHits hits;
  hits.reserve(part.size());
  hits.clear();
  probe_surface(bone, part, map, look_ahead, hits);
  return hits;
}

std::vector<TrueField> test_fields() {
  std::vector<TrueField> out;
  for (const Affine& map : test_maps())
    for (const Truth& truth : {half_space(Vec3(0.3, -0.2, 1.0), 0.4e-3), plate(Vec3(1.0, 0.5, -0.2), 2e-3), sphere(3e-3), cavity(3e-3)})
      out.emplace_back(map, kBox, truth);
  return out;
}

Vec3 index_of(const ContactShellPart& part, std::size_t n, const Affine& map) {
  return map * Vec3(static_cast<double>(part.x[n]), static_cast<double>(part.y[n]), static_cast<double>(part.z[n]));
}

}  // namespace

TEST_CASE("surface probe: the same bits as the plain twin on every level") {
  const std::vector<TrueField> fields = test_fields();
  // At the second look-ahead all points are near that have records: whole blocks are then taken in one pass, unless a point of them has
  // none.
  for (const double look_ahead : {kLookAhead, kAllNear}) {
    std::size_t hits = 0;
    for (const std::size_t count : {1u, 15u, 16u, 17u, 127u, 128u, 129u, 255u, 1000u, 3001u}) {
      const ContactShellPart part = random_part(count, count);
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const Affine map = index_from_tool(fields[f].map(), 100 + f);
        for (const RecordPrecision precision : kPrecisions) {
          RecordView bone = fields[f].view(precision);
          if (f % 2 == 0) bone.cut = {Vec3i(-5, -4, -20), Vec3i(6, 20, 5)};  // part of the points
          const TwinProbe twin = probe_plainly(bone, part, map, look_ahead);
          at_all_levels([&] {
            CAPTURE(count);
            CAPTURE(f);
            const ProbeHits found = probed(bone, part, map, look_ahead);
            CHECK(hits_of(found) == twin.hits);  // the same points in the same order, all values to the last bit
            CHECK(found.nearest == twin.nearest);
            CHECK(found.outside == twin.outside);
            hits += found.count;
          });
        }
      }
    }
    CHECK(hits > 10'000);
  }
}

TEST_CASE("surface probe: the twin detects records that differ by a step") {
  TrueField field(test_maps()[2], kBox, half_space(Vec3(0.3, -0.2, 1.0), 0.4e-3));
  const ContactShellPart part = random_part(1000, 5);
  const Affine map = index_from_tool(field.map(), 6);
  for (const double look_ahead : {kLookAhead, kAllNear})
    for (const RecordPrecision precision : kPrecisions) {
      const auto before = probe_plainly(field.view(precision), part, map, look_ahead);
      REQUIRE(before.hits.size() > 10);
      TrueField nudged = field;
      nudged.nudge();
      CHECK_FALSE(hits_of(probed(nudged.view(precision), part, map, look_ahead)) == before.hits);
    }
}

TEST_CASE("surface probe: the twin detects a curvature term that is left out where the axes are oblique") {
  // What the kernel does on straight maps: only the part of each axis on itself counts.
  const Truth ball = sphere(3e-3);
  const ContactShellPart part = random_part(1000, 5);
  for (const Affine& map : test_maps()) {
    const TrueField field(map, kBox, ball);
    RecordView bone = field.view(RecordPrecision::bits16);
    const Affine index = index_from_tool(map, 6);
    const auto hits = hits_of(probed(bone, part, index));
    const bool straight = map.linear[0] == Vec3(map.linear[0].x, 0.0, 0.0) && map.linear[1] == Vec3(0.0, map.linear[1].y, 0.0) &&
                          map.linear[2] == Vec3(0.0, 0.0, map.linear[2].z);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t c = 0; c < 3; ++c)
        if (a != c) bone.bone_from_index.linear[a][c] = 0.0;
    CHECK((probe_plainly(bone, part, index, kLookAhead).hits == hits) == straight);
  }
}

TEST_CASE("surface probe: points outside and at the edges of what is known") {
  const TrueField field(Affine::scaling(0.5e-3, Vec3(0.0)), kBox, half_space(Vec3(0.0, 0.0, 1.0), 0.0));
  const RecordView bone = field.view(RecordPrecision::bits16);
  // One point at the tool origin, put at index coordinates. Bone fills half of them; at the edges a wrong record would say "deep inside".
  const ContactShellPart part = random_part(1, 1, 0.0);
  const auto at = [&](const Vec3& index) { return probed(bone, part, {bone.bone_from_index.inverse().linear, index}, 100.0); };
  const Vec3 lo(bone.valid.lo), hi(bone.valid.hi - 1), middle = Vec3(0.25, 0.5, 0.75);
  at_all_levels([&] {
    for (std::size_t a = 0; a < 3; ++a) {
      CAPTURE(a);
      const auto moved = [&](double to) {
        Vec3 p = middle;
        p[a] = to;
        return p;
      };
      // Window coordinates are single precision, of some 10: 1e-5 is above their rounding, 1e-9 below.
      for (const double known : {lo[a], lo[a] + 1e-5, hi[a] - 1e-5}) {
        const ProbeHits hits = at(moved(known));
        REQUIRE(hits.count == 1);
        CHECK_FALSE(hits.outside);
        const double truth = std::clamp(moved(known).z, -kRecordBand, kRecordBand);
        CHECK(std::abs(static_cast<double>(hits.distance[0]) - truth) <= 0.5 / 4096.0 + 1e-5);  // a step, and as above
      }
      for (const double unknown : {lo[a] - 1e-5, hi[a], hi[a] + 1e-5, hi[a] + 1.0, lo[a] - 1e6, 1e30,
                                   std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        const ProbeHits hits = at(moved(unknown));
        CHECK(hits.count == 0);
        CHECK(hits.outside);
        CHECK(std::isfinite(hits.nearest));
      }
    }
  });
}

TEST_CASE("surface probe: nearest is a lower bound of the true distance and not far below it") {
  const std::vector<TrueField> fields = test_fields();
  for (std::size_t f = 0; f < fields.size(); ++f)
    for (std::uint64_t trial = 0; trial < 40; ++trial) {
      const ContactShellPart part = random_part(1 + trial, 1000 * f + trial, 1e-3);
      const Affine map = index_from_tool(fields[f].map(), 77 + 1000 * f + trial, 3e-3);
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t n = 0; n < part.size(); ++n) least = std::min(least, fields[f].distance_at(index_of(part, n, map)));
      for (const RecordPrecision precision : kPrecisions) {
        const ProbeHits hits = probed(fields[f].view(precision), part, map);
        if (hits.outside) continue;
        CAPTURE(f);
        CAPTURE(trial);
        CHECK(static_cast<double>(hits.nearest) <= std::max(least, -kRecordBand));  // records tell no more
        CHECK(static_cast<double>(hits.nearest) <= kRecordBand);
        // Half a diagonal of a cell to its voxel and the same back: at most 1 edge each for these maps.
        CHECK(static_cast<double>(hits.nearest) >= std::clamp(least, -kRecordBand, kRecordBand) - 2.1);
      }
    }
}

TEST_CASE("surface probe: the bound breaks where distance grows faster than the way") {
  TrueField field(test_maps()[0], kBox, half_space(Vec3(0.0, 0.0, 1.0), 0.0));
  field.stretch(3.0);
  int broken = 0;
  for (std::uint64_t trial = 0; trial < 100; ++trial) {
    const ContactShellPart part = random_part(1, trial, 1e-3);
    const Affine map = index_from_tool(field.map(), 77 + trial, 1e-3);
    const ProbeHits hits = probed(field.view(RecordPrecision::bits16), part, map);
    broken += static_cast<double>(hits.nearest) > field.distance_at(index_of(part, 0, map));
  }
  CHECK(broken > 10);
}

TEST_CASE("surface probe: nothing within the search distance is missed") {
  for (const Affine& map : test_maps()) {
    const double edge = map.mean_edge();
    double bend = 0.0;  // [m] second differences: trilinear interpolation errs by at most sum |cell edge|^2 / (8 radius of curvature)
    for (std::size_t a = 0; a < 3; ++a) bend += glm::dot(map.linear[a], map.linear[a]) / 8.0;
    struct Case {
      Truth truth;
      double error;  // [voxel edges]
    };
    const double nearest_centre = 3e-3 - 2.6 * edge;  // [m] of the corners of cells that hold such points
    for (const Case& one : {Case{half_space(Vec3(0.3, -0.2, 1.0), 0.4e-3), 0.0}, Case{plate(Vec3(1.0, 0.5, -0.2), 4e-3), 0.0},
                            Case{sphere(3e-3), bend / nearest_centre / edge}, Case{cavity(3e-3), bend / nearest_centre / edge}}) {
      const TrueField field(map, kBox, one.truth);
      for (const RecordPrecision precision : kPrecisions) {
        // Half a step of what is stored, and single precision of coordinates of some 10.
        const double allowed = one.error + (precision == RecordPrecision::bits8 ? 0.5 / 32.0 : 0.5 / 4096.0) + 1e-5;
        const ContactShellPart part = random_part(4000, 9, 4e-3);
        const Affine index = index_from_tool(map, 10, 1e-3);
        const ProbeHits hits = probed(field.view(precision), part, index);
        std::vector<const float*> found(4000);
        for (std::size_t n = 0; n < hits.count; ++n) found[hits.point[n]] = &hits.distance[n];
        int near = 0;
        for (std::size_t n = 0; n < part.size(); ++n) {
          const Vec3 p = index_of(part, n, index);
          const RecordView bone = field.view(precision);
          if (glm::any(glm::lessThan(p, Vec3(bone.valid.lo) + 1e-5)) || glm::any(glm::greaterThan(p, Vec3(bone.valid.hi - 1) - 1e-5)))
            continue;
          const double truth = field.distance_at(p);
          const float* distance = found[part.point[n]];
          if (truth < kLookAhead - allowed) CHECK(distance != nullptr);
          if (truth > kLookAhead + allowed) CHECK(distance == nullptr);
          if (distance == nullptr || std::abs(truth) > 0.6) continue;
          ++near;
          CHECK(std::abs(static_cast<double>(*distance) - truth) <= allowed);
        }
        CHECK(near > 50);
      }
    }
  }
}

// Of planes, tangents are exact where corners of the cell know each plane. What is left comes from cells that hold so little of the second
// plane that the slope changes by less than 1/2: there the parabola is too low by an eighth of that.
TEST_CASE("surface probe: thin walls and convex edges are where their faces are") {
  const double edge = 0.5e-3;
  const Vec3 up(0.0, 0.0, 1.0), along(1.0, 0.0, 0.0), slanted(1.0, 0.5, -0.2);
  for (const Truth& truth_of :
       {plate(up, 1.07 * edge), plate(up, 1.4 * edge), plate(slanted, 1.3 * edge), rim(up, along), rim(slanted, Vec3(0.2, -1.0, 0.1))}) {
    const TrueField field(Affine::scaling(edge, Vec3(1e-4, -0.7e-4, 0.3e-4)), kBox, truth_of);
    RecordView bone = field.view(RecordPrecision::bits16);
    bone.cut = bone.box;
    const ContactShellPart part = random_part(4000, 9, 4e-3);
    const Affine index = index_from_tool(field.map(), 10, 1e-3);
    struct Errors {
      double high = 0.0, low = 0.0;  // [voxel edges]
      int points = 0;
    };
    const auto errors = [&] {
      Errors out;
      const ProbeHits hits = probed(bone, part, index);
      const RecordSampler sampler(bone);
      for (std::size_t n = 0; n < hits.count; ++n) {
        const Vec3 p = index * Vec3(static_cast<double>(hits.x[n]), static_cast<double>(hits.y[n]), static_cast<double>(hits.z[n]));
        const double truth = field.distance_at(p), found = static_cast<double>(hits.distance[n]);
        if (std::abs(truth) > 0.3) continue;
        ++out.points;
        out.high = std::max(out.high, found - truth);
        out.low = std::max(out.low, truth - found);
        if (const auto sample = sampler.at(p)) CHECK(sample->distance == doctest::Approx(found).epsilon(1e-4).scale(1.0));
      }
      return out;
    };
    const Errors here = errors();
    MESSAGE("too high by " << here.high << ", too low by " << here.low << " voxel at most");
    CHECK(here.points > 50);
    CHECK(here.low <= 0.5 / 8.0);
    CHECK(here.high <= 0.5 / 8.0);
    bone.cut = {};
    const Errors mixed = errors();
    CHECK(std::max(mixed.low, mixed.high) > 0.1);  // sabotage: without tangents
  }
}

TEST_CASE("surface probe: a second part is appended and the first kept") {
  const TrueField field(test_maps()[1], kBox, plate(Vec3(1.0, 0.5, -0.2), 2e-3));
  const RecordView bone = field.view(RecordPrecision::bits8);
  const Affine map = index_from_tool(field.map(), 5);
  const ContactShellPart first = random_part(333, 1), second = random_part(1001, 2, 0.8e-3);
  at_all_levels([&] {
    ProbeHits hits;
    hits.reserve(first.size() + second.size());
    for (int again = 0; again < 2; ++again) {  // what an earlier look left does not show
      hits.clear();
      probe_surface(bone, first, map, kLookAhead, hits);
      const std::size_t between = hits.count;
      const float nearest = hits.nearest;
      probe_surface(bone, {}, map, kLookAhead, hits);
      CHECK(hits.count == between);
      probe_surface(bone, second, map, kLookAhead, hits);
      auto expected = probe_plainly(bone, first, map, kLookAhead);
      CHECK(between == expected.hits.size());
      CHECK(nearest == expected.nearest);
      const auto more = probe_plainly(bone, second, map, kLookAhead);
      CHECK(expected.nearest < more.nearest);  // or the least of both would be the last
      expected.hits.insert(expected.hits.end(), more.hits.begin(), more.hits.end());
      CHECK(hits_of(hits) == expected.hits);
      CHECK(hits.nearest == std::min(expected.nearest, more.nearest));
      CHECK(hits.outside == (expected.outside || more.outside));
    }
  });
}

TEST_CASE("surface probe: one point by the scalar path is exact on a plane except for quantisation") {
  for (const Affine& map : test_maps()) {
    const Vec3 normal = glm::normalize(Vec3(0.3, -0.2, 1.0));
    const TrueField field(map, kBox, half_space(normal, 0.4e-3));
    for (const RecordPrecision precision : kPrecisions) {
      const RecordView bone = field.view(precision);
      const bool small = precision == RecordPrecision::bits8;
      const double step = small ? 1.0 / 32.0 : 1.0 / 4096.0, turn = small ? 1.0 / 127.0 : 1.0 / 32767.0;
      int near = 0;
      for (std::uint64_t n = 0; n < 3000; ++n) {
        const Vec3 p =
            Vec3(bone.valid.lo) + Vec3(bone.valid.size() - 1) * Vec3(uniform01(1, 3 * n), uniform01(1, 3 * n + 1), uniform01(1, 3 * n + 2));
        const auto sample = sample_records(bone, p);
        REQUIRE(sample);
        const double truth = field.distance_at(p);
        if (std::abs(truth) > 1.2) continue;  // further out a corner of the cell may lie past the band
        ++near;
        CHECK(std::abs(sample->distance - truth) <= 0.5 * step + 1e-12);  // a mean of roundings to half a step
        CHECK(std::abs(glm::length(sample->normal) - 1.0) <= 1e-12);
        // Each of three components is off by half a step at most, and the length is made 1 again (3 % more, to be sure).
        CHECK(glm::length(sample->normal - normal) <= 1.03 * std::sqrt(3.0) * 0.5 * turn);
      }
      CHECK(near > 100);
      const Vec3 lo(bone.valid.lo), hi(bone.valid.hi - 1);
      CHECK(sample_records(bone, lo));
      CHECK_FALSE(sample_records(bone, hi));
      for (std::size_t a = 0; a < 3; ++a)
        for (const double out : {lo[a] - 1e-9, hi[a], 1e300, std::numeric_limits<double>::quiet_NaN()}) {
          Vec3 p = 0.5 * (lo + hi);
          CHECK(sample_records(bone, p));
          p[a] = out;
          CHECK_FALSE(sample_records(bone, p));
        }
    }
  }
}
