// The search for the worst hit by blocks against a plain scan: the same hit and the same bits, ties included, on every SIMD level.
#include "core/contact/worst_hit.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "core/base/random.h"
#include "every_level.h"
#include "surface_probe_twin.h"

using namespace burrhole;
using namespace burrhole::probe_test;

namespace {

constexpr float kNoLimit = std::numeric_limits<float>::infinity();

PointMotion motion_of(std::uint64_t trial, double offset, double turn) {
  PointMotion motion;
  for (std::size_t a = 0; a < 3; ++a) motion.offset[a] = offset * uniform11(41, 3 * trial + a);
  for (std::size_t a = 0; a < 9; ++a) motion.linear[a / 3][a % 3] = turn * uniform11(42, 9 * trial + a);
  return motion;
}

bool same(const std::optional<WorstHit>& a, const std::optional<WorstHit>& b) {
  return a.has_value() == b.has_value() && (!a || (a->hit == b->hit && a->distance == b->distance));
}

/// Hits made up, every one with its like 100 further on.
ProbeHits made_up(std::size_t count) {
  ProbeHits hits;
  hits.reserve(count);
  hits.clear();
  hits.count = count;
  const auto number = [](std::uint64_t n) { return static_cast<float>(uniform11(31, n)); };
  for (std::size_t n = 0; n < hits.count; ++n) {
    const std::uint64_t at = 8 * (n % 100);
    hits.x[n] = 0.01f * number(at), hits.y[n] = 0.01f * number(at + 1), hits.z[n] = 0.01f * number(at + 2);
    hits.nx[n] = number(at + 3), hits.ny[n] = number(at + 4), hits.nz[n] = number(at + 5);
    hits.distance[n] = 0.6f * number(at + 6);
  }
  hits.distance[55] = 1e9f;  // hidden, as the tool does with planes that it has
  return hits;
}

/// Blocks of `most` hits at most, of uneven sizes, ranges taken plainly.
void set_blocks(ProbeHits& hits, std::size_t most) {
  HitBlocks& blocks = hits.blocks;
  blocks.reserve(kHitBlock * hits.count);  // room for blocks of one hit
  blocks.count = 0;
  const LineVector<float>* const arrays[6] = {&hits.x, &hits.y, &hits.z, &hits.nx, &hits.ny, &hits.nz};
  for (std::size_t first = 0; first < hits.count;) {
    const std::size_t last = std::min(first + 1 + mix64(first) % most, hits.count), n = blocks.count++;
    const auto least = [&](const LineVector<float>& of) { return *std::min_element(of.data() + first, of.data() + last); };
    blocks.end[n] = static_cast<std::uint32_t>(last);
    blocks.distance[n] = least(hits.distance);
    for (std::size_t a = 0; a < 6; ++a) {
      blocks.lo[a][n] = least(*arrays[a]);
      blocks.hi[a][n] = *std::max_element(arrays[a]->data() + first, arrays[a]->data() + last);
    }
    first = last;
  }
}

/// Hits of a probe: 12,000 points on a ball of 3 mm in a cavity 0.1 voxel wider, so that most can be passed by.
ProbeHits probed_ball(const TrueField& field, RecordPrecision precision) {
  PointShell shell;
  for (std::uint64_t n = 0; n < 12'000; ++n)
    shell.positions.push_back(3e-3 * glm::normalize(Vec3(uniform11(7, 3 * n), uniform11(7, 3 * n + 1), uniform11(7, 3 * n + 2))));
  shell.inward_normals.assign(shell.size(), Vec3(0.0, 0.0, 1.0));
  for (std::size_t n = 0; n < shell.size(); ++n) shell.cutting.push_back(n % 3 != 0);
  const ContactShell parts = make_contact_shell(shell, 0.5e-3);
  ProbeHits hits;
  hits.reserve(shell.size());
  hits.clear();
  for (const ContactShellPart* part : {&parts.cutting, &parts.passive})
    probe_surface(field.view(precision), *part, field.map().inverse(), 0.6, hits);
  return hits;
}

const VoxelBox kBox{Vec3i(-14), Vec3i(15)};

}  // namespace

TEST_CASE("worst hit: that of a plain loop and ties go to the first, whatever the blocks") {
  constexpr std::size_t kCount = 700;
  ProbeHits hits = made_up(kCount);
  const auto check = [&](std::size_t first, std::size_t last, const PointMotion& motion, float limit) {
    CHECK(same(find_worst(hits, first, last, motion, limit), worst_plainly(hits, first, last, motion, limit)));
  };
  for (const std::size_t most : {0, 1, 7, 64, 300}) {
    CAPTURE(most);
    if (most > 0) set_blocks(hits, most);
    at_all_levels([&] {
      for (std::uint64_t trial = 0; trial < 300; ++trial) {
        const PointMotion motion = trial % 10 == 0 ? PointMotion{} : motion_of(trial, 1.0, 50.0);
        const std::size_t first = mix64(trial) % 300;
        const float limit = trial % 3 == 0 ? kNoLimit : static_cast<float>(uniform11(43, trial));
        check(first, first + 1 + trial % 70, motion, limit);
        check(first, kCount, motion, limit);
        check(0, kCount, motion, limit);
        check(first, first, motion, limit);
      }
    });
  }
}

TEST_CASE("worst hit: of a probe that found most points near, by its own blocks") {
  for (const Affine& map : test_maps()) {
    const TrueField field(map, kBox, cavity(3e-3 + 0.1 * map.mean_edge()));
    for (const RecordPrecision precision : {RecordPrecision::bits8, RecordPrecision::bits16}) {
      ProbeHits hits = probed_ball(field, precision);
      REQUIRE(hits.count > 4000);
      REQUIRE(hits.blocks.end[hits.blocks.count - 1] == hits.count);
      const std::size_t parts = hits.blocks.end[hits.blocks.count / 2];
      at_all_levels([&] {
        for (std::uint64_t trial = 0; trial < 60; ++trial) {
          const PointMotion motion = motion_of(trial, trial % 2 == 0 ? 0.1 : 1.0, trial % 4 < 2 ? 10.0 : 0.0);
          for (const float limit : {kNoLimit, 0.0f, -0.002f, -0.3f}) {
            CHECK(same(find_worst(hits, 0, hits.count, motion, limit), worst_plainly(hits, 0, hits.count, motion, limit)));
            CHECK(same(find_worst(hits, parts, hits.count, motion, limit), worst_plainly(hits, parts, hits.count, motion, limit)));
          }
        }
      });
      // Hidden one after another, as the tool does.
      const PointMotion motion = motion_of(1, 0.5, 0.0);
      for (int n = 0; n < 30; ++n) {
        const auto worst = find_worst(hits, 0, hits.count, motion);
        REQUIRE(worst);
        CHECK(same(worst, worst_plainly(hits, 0, hits.count, motion)));
        hits.distance[worst->hit] = 1e9f;
      }
    }
  }
}

TEST_CASE("worst hit: blocks that claim to be further off than they are do not pass (sabotage)") {
  const TrueField field(test_maps()[0], kBox, cavity(3e-3 + 0.1 * test_maps()[0].mean_edge()));
  ProbeHits hits = probed_ball(field, RecordPrecision::bits16);
  const auto differs = [&] {
    int different = 0;
    for (std::uint64_t trial = 0; trial < 60; ++trial) {
      const PointMotion motion = motion_of(trial, 0.3, 10.0);
      different += same(find_worst(hits, 0, hits.count, motion, 0.0f), worst_plainly(hits, 0, hits.count, motion, 0.0f)) ? 0 : 1;
    }
    return different;
  };
  CHECK(differs() == 0);
  for (std::size_t n = 0; n < hits.blocks.count; n += 2) hits.blocks.distance[n] += 0.2f;
  CHECK(differs() > 10);
}

TEST_CASE("worst hit: a motion that is not a number or beyond one finds what the plain loop finds, or nothing") {
  ProbeHits hits = made_up(700);
  set_blocks(hits, 64);
  at_all_levels([&] {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e38, -1e38, 1e300}) {
      PointMotion shifted, turned;
      shifted.offset.x = bad;
      turned.linear[1][2] = bad;
      for (const PointMotion& motion : {shifted, turned})
        CHECK(same(find_worst(hits, 200, 600, motion), worst_plainly(hits, 200, 600, motion)));
    }
  });
}
