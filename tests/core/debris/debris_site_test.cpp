// What blocks a chip: the 0.5 level between voxels, soft tissue, full cells; ways that are tested without tunnelling; losses by place.

#include "core/debris/debris_site.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/random.h"
#include "tests/core/debris/small_site.h"

namespace burrhole::test {

TEST_CASE("debris site: the surface is the 0.5 level, found along a way to a sixteenth of a voxel, on skewed voxels too") {
  // A ramp of four voxels, which trilinear values follow exactly near its middle.
  Affine skewed = Affine::scaling(0.25e-3, Vec3(-5e-3));
  skewed.linear[1] += Vec3(0.05e-3, 0.0, 0.0);
  skewed.linear[2] *= 1.5;
  for (const Affine& frame : {Affine::scaling(0.25e-3, Vec3(-5e-3)), skewed}) {
    DebrisSite site = make_site(frame);
    const double edge = frame.linear[2].z;
    fill(site, [&](const Vec3& p) { return std::clamp(0.5 - 0.25 * p.z / edge, 0.0, 1.0); });
    for (std::uint64_t n = 0; n < 200; ++n) {
      const Vec3 from(2e-3 * uniform11(1, n), 2e-3 * uniform11(2, n), 1e-3 + 1e-3 * uniform01(3, n));
      const Vec3 to(2e-3 * uniform11(4, n), 2e-3 * uniform11(5, n), -1e-3);
      const Vec3 hit = from + site.free_share(from, to) * (to - from);
      const double slope = std::abs(to.z - from.z) / glm::length(to - from);
      // The density is kept to half of 1/254, 2/254 voxels of this ramp; the last step, half a voxel, is halved three times.
      const double kept = 2.0 * edge / 254.0;
      CHECK(hit.z > -kept);
      CHECK(hit.z < (site.voxel() / 16.0) * slope + kept);
    }
  }
}

TEST_CASE("debris site: a sheet of one voxel stops every way through it, however long; a twin that tests the end alone does not see it") {
  DebrisSite site = make_site(Affine::scaling(0.25e-3, Vec3(-5e-3)));
  fill(site, [](const Vec3& p) { return std::abs(p.z) < 0.13e-3 ? 1.0 : 0.0; });
  for (const double length : {0.5e-3, 4e-3, 4.0}) {
    const Vec3 from(0.1e-3, 0.2e-3, 0.3e-3), to = from - Vec3(0.3 * length, 0.0, length);
    CHECK(site.free_share(from, to) < 1.0);
    CHECK_FALSE(site.is_blocked(to));
  }
}

TEST_CASE("debris site: full cells block, soft tissue stays, and a chip slides to the lowest open neighbour") {
  DebrisSite site = make_site(Affine::scaling(0.25e-3, Vec3(-5e-3)));
  fill(site, [](const Vec3& p) { return p.z < -0.9e-3 ? 1.0 : 0.0; });
  const Vec3 place(0.1e-3, 0.1e-3, 0.2e-3);
  CHECK_FALSE(site.is_blocked(place));
  const auto lower = site.slide_from(place, 1);
  REQUIRE(lower);
  CHECK(lower->z == doctest::Approx(-0.25e-3));
  site.pile(place, site.cell_volume());
  CHECK(site.is_blocked(place));
  CHECK_FALSE(site.is_solid(place));
  CHECK(site.is_carried(place + Vec3(0.0, 0.0, 0.4e-3)));  // by the full cell below it
  CHECK_FALSE(site.is_carried(place));                     // not by its own
  CHECK(site.is_carried(Vec3(0.1e-3, 0.1e-3, -0.85e-3)));  // by bone
  const VoxelBox all = site.voxels();
  site.set_floor(all, std::vector<std::uint8_t>(all.count(), 1));
  fill(site, [](const Vec3&) { return 0.0; });
  CHECK(site.is_solid(place));
  CHECK(site.bone_at(Vec3i(20)) == 0);
}

TEST_CASE("debris site: places of removed bone are drawn in proportion to what each voxel lost") {
  DebrisSite site = make_site(Affine::scaling(0.25e-3, Vec3(-5e-3)));
  fill(site, [](const Vec3&) { return 1.0; });
  // Voxel A loses all, B a half, C nothing: over many phases A has two thirds.
  const VoxelBox part{Vec3i(10, 10, 10), Vec3i(13, 11, 11)};
  const std::vector<float> now{0.0f, 0.5f, 1.0f};
  const double total = site.loss_of(part, now);
  CHECK(total == 254.0 + 127.0);
  int a = 0, b = 0;
  for (int n = 0; n < 100; ++n) {
    fill(site, [](const Vec3&) { return 1.0; });
    LossSampler sampler(total, n / 100.0);
    site.set_bone(part, now, &sampler);
    CHECK(sampler.births().size() == LossSampler::kMost);
    for (const DebrisBirth& one : sampler.births()) {
      a += one.voxel.x == 10 ? 1 : 0;
      b += one.voxel.x == 11 ? 1 : 0;
      CHECK(one.left == (one.voxel.x == 10 ? 0 : 127));
    }
  }
  CHECK(a + b == 100 * static_cast<int>(LossSampler::kMost));
  // Systematic samples: each set has the share within one sample of 16.
  CHECK(std::abs(a / 1600.0 - 2.0 / 3.0) < 1.0 / 16.0);
  CHECK_FALSE(DebrisSite::create({Vec3(0.0), Vec3(0.0)}, Affine::scaling(1e-3, Vec3(0.0)), {Vec3i(0), Vec3i(4)}, 1e-3, Vec3(0, 0, -1)));
  CHECK_FALSE(DebrisSite::create({Vec3(0.0), Vec3(1.0)}, Affine::scaling(1e-3, Vec3(0.0)), {Vec3i(0), Vec3i(4)}, 1e-4, Vec3(0, 0, -1)));
}

}  // namespace burrhole::test
