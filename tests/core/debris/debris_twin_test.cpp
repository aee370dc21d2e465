// What the steps of chips skip changes no bit: twins that test every chip anew, every voxel by itself, every chip on the disc.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/random.h"
#include "core/base/trilinear.h"
#include "core/debris/debris_field.h"
#include "tests/core/debris/small_site.h"

namespace burrhole::test {
namespace {

constexpr double kMm3 = 1e-9;  // [m^3]

DebrisField noisy_field(const Vec3& down) {
  DebrisSite site = make_site(Affine::scaling(0.25e-3, Vec3(-5e-3)), down);
  fill(site, [](const Vec3& p) {
    const Vec3 q = p * 1e4;
    return std::clamp(0.5 - p.z / 0.25e-3, 0.0, 1.0) * (0.75 + 0.25 * std::sin(3.0 * q.x + 5.0 * q.y + 7.0 * q.z));
  });
  auto field = DebrisField::create({.most_particles = 200, .particle = 0.05 * kMm3, .clearing = 0.5}, std::move(site));
  REQUIRE(field);
  return std::move(*field);
}

/// Changes two voxels at opposite corners, and back: what a step knew of the whole site is no longer known.
void forget(DebrisSite& site) {
  const VoxelBox& all = site.voxels();
  for (const Vec3i& corner : {all.lo, all.hi - 1}) {
    const float before = static_cast<float>(site.bone_at(corner)) / 254.0f;
    for (const float density : {before > 0.5f ? 0.0f : 1.0f, before}) site.set_bone({corner, corner + 1}, std::array{density});
    REQUIRE(site.bone_at(corner) == static_cast<int>(std::lround(254.0f * before)));
  }
}

/// A box of bone that is cut away, or comes back, at random; the same in both.
void change_bone(DebrisField& a, DebrisField& b, std::uint64_t n) {
  const auto any = [n](std::uint64_t k, int most) { return static_cast<int>(uniform01(11, 16 * n + k) * most); };
  const Vec3i lo(12 + any(0, 14), 12 + any(1, 14), 14 + any(2, 6));
  const VoxelBox box{lo, lo + Vec3i(1 + any(3, 6), 1 + any(4, 6), 1 + any(5, 3))};
  const std::vector<float> density(box.count(), n % 9 == 4 ? 1.0f : static_cast<float>(uniform01(12, n)) - 0.3f < 0.0f ? 0.0f : 0.4f);
  for (DebrisField* field : {&a, &b}) {
    field->site().set_bone(box, density);
    if (n % 9 == 4) field->bone_came_back();
  }
}

bool same(const DebrisField& a, const DebrisField& b) {
  const auto alike = [](const DebrisParticle& p, const DebrisParticle& q) {
    return p.position == q.position && p.velocity == q.velocity && p.volume == q.volume && p.diameter == q.diameter &&
           p.number == q.number && p.settled == q.settled && p.is_mist == q.is_mist;
  };
  bool cells = true;
  for (std::size_t n = 0; n < a.site().cells(); ++n) cells = cells && a.site().is_full(n) == b.site().is_full(n);
  return cells && std::ranges::equal(a.particles(), b.particles(), alike) && a.held() == b.held() && a.merged() == b.merged() &&
         a.totals().lost == b.totals().lost && a.totals().rinsed == b.totals().rinsed && a.totals().undone == b.totals().undone;
}

/// Twin: every settled particle, every node.
double hidden_share(const DebrisField& field, const Vec3& centre, double radius) {
  int inside = 0, hidden = 0;
  const double pitch = 2.0 * radius / DebrisField::kRaster;
  for (int j = 0; j < DebrisField::kRaster; ++j)
    for (int i = 0; i < DebrisField::kRaster; ++i) {
      const double x = (i + 0.5) * pitch - radius, y = (j + 0.5) * pitch - radius;
      if (x * x + y * y > radius * radius) continue;
      ++inside;
      hidden += std::ranges::any_of(field.particles(), [&](const DebrisParticle& one) {
        const double dx = x - (one.position.x - centre.x), dy = y - (one.position.y - centre.y), r = field.radius_of(one);
        return one.settled && dx * dx + dy * dy <= r * r;
      });
    }
  return static_cast<double>(hidden) / inside;
}

}  // namespace

TEST_CASE(
    "debris: chips whose bone did not change are not tested again, with the bits of a twin that tests all, while bone goes and comes") {
  for (const Vec3& down : {Vec3(0.0, 0.0, -1.0), glm::normalize(Vec3(0.3, -0.2, -0.8))}) {
    DebrisField field = noisy_field(down), twin = noisy_field(down);
    std::size_t fallen = 0, settled = 0;
    for (std::uint64_t n = 0; n < 300; ++n) {
      if (n % 3 == 0) change_bone(field, twin, n);
      DebrisStep now{.dt = n % 50 == 7 ? 0.1 : 0.01, .removed = n % 40 < 30 ? 0.4 * kMm3 : 0.0, .thickness = 5e-6};
      now.bit = {.tip = Vec3(0.2e-3, 0.0, 0.0), .radius = 1e-3, .height = 2e-3, .spin = n % 40 < 30 ? 17.0 : 0.0};
      if (n % 7 == 3) now.rinse = {Vec3(1e-3, 0.0, 0.0), 2e-3, 0.5e-6};
      if (n % 31 == 5) now.suction = {Vec3(1e-3, 0.0, 2e-3), 2e-3, 3e-4};
      const auto count = [&] { return std::ranges::count_if(field.particles(), [](const DebrisParticle& one) { return one.settled; }); };
      const auto before = count();
      forget(twin.site());
      field.step(now);
      twin.step(now);
      REQUIRE(same(field, twin));
      fallen += count() < before ? 1 : 0;
      settled += static_cast<std::size_t>(count());
      if (n % 25 == 0)
        CHECK(field.hidden_share(Vec3(0.5e-3, 0.0, 0.0), Vec3(0.0, 0.0, 1.0), 1.5e-3) ==
              hidden_share(field, Vec3(0.5e-3, 0.0, 0.0), 1.5e-3));
    }
    CHECK(fallen > 20);
    CHECK(settled > 300 * 100);
    CHECK(field.merged() > 0);
    // Sabotage: a voxel that only one of the two loses shows.
    const auto lowest = std::ranges::find_if(field.particles(), [&](const DebrisParticle& one) {
      return one.settled && field.site().is_solid(field.site().below(one.position));
    });
    REQUIRE(lowest != field.particles().end());
    const Vec3i under = floor_int((lowest->position + 5e-3) / 0.25e-3);
    const VoxelBox hole = VoxelBox{under - 3, under + 4}.intersect(field.site().voxels());
    field.site().set_bone(hole, std::vector<float>(hole.count(), 0.0f));
    for (DebrisField* one : {&field, &twin}) one->step({.dt = 0.01, .bit = {.tip = Vec3(0.0, 0.0, 3e-3), .radius = 1e-3}});
    CHECK(!same(field, twin));
  }
}

TEST_CASE("debris site: the level between voxels, what a box would lose and what it loses, as voxel by voxel") {
  DebrisSite site = make_site(Affine::scaling(0.25e-3, Vec3(-5e-3)));
  fill(site, [](const Vec3& p) { return std::clamp(0.5 + 0.5 * std::sin(1e4 * (p.x + 2.0 * p.y - p.z)), 0.0, 1.0); });
  const VoxelBox& all = site.voxels();
  site.set_floor(all, [&] {
    std::vector<std::uint8_t> soft(all.count(), 0);
    for (std::size_t n = 0; n < soft.size(); n += 17) soft[n] = 1;
    return soft;
  }());
  const auto value_of = [&](const Vec3i& v) {
    if (!all.contains(v)) return 0.0;
    return all.offset_of(v) % 17 == 0 ? 255.0 : static_cast<double>(site.bone_at(v));
  };
  for (std::uint64_t n = 0; n < 20000; ++n) {
    const Vec3 index(42.0 * uniform01(1, n) - 0.7, 42.0 * uniform01(2, n) - 0.7, 42.0 * uniform01(3, n) - 0.7);
    const Vec3 place = Affine::scaling(0.25e-3, Vec3(-5e-3)) * index, again = Affine::scaling(0.25e-3, Vec3(-5e-3)).inverse() * place;
    const Vec3i base = floor_int(again);
    REQUIRE(site.level(place) == trilinear(again - Vec3(base), [&](unsigned k) { return value_of(base + cell_corner(k)); }) / 254.0);
  }
  for (std::uint64_t n = 0; n < 40; ++n) {
    const Vec3i lo(static_cast<int>(30.0 * uniform01(4, n)) + 4, 6, 9);
    const VoxelBox box{lo, lo + Vec3i(1 + static_cast<int>(n % 5), 7, 4)};
    std::vector<float> density;
    double loss = 0.0;
    for_each_voxel(box, [&](const Vec3i& v) {
      const double before = value_of(v);
      density.push_back(static_cast<float>(std::clamp(before / 254.0 + 0.4 * uniform11(5, n + 100 * density.size()), 0.0, 1.0)));
      const auto now = static_cast<double>(std::lround(254.0f * density.back()));
      if (before != 255.0 && now < before) loss += before - now;
    });
    CHECK(site.loss_of(box, density) == loss);
    LossSampler sampler(loss, 0.3), twin(loss, 0.3);
    std::size_t at = 0;
    for_each_voxel(box, [&](const Vec3i& v) {
      const int before = static_cast<int>(value_of(v)), now = static_cast<int>(std::lround(254.0f * density[at++]));
      if (before != 255 && now < before) twin.add(v, before - now, static_cast<std::uint8_t>(now));
    });
    site.set_bone(box, density, &sampler);
    CHECK(std::ranges::equal(sampler.births(), twin.births(),
                             [](const DebrisBirth& a, const DebrisBirth& b) { return a.voxel == b.voxel && a.left == b.left; }));
    at = 0;
    for_each_voxel(box, [&](const Vec3i& v) {
      const auto now = static_cast<double>(std::lround(254.0f * density[at++]));
      CHECK(value_of(v) == (all.offset_of(v) % 17 == 0 ? 255.0 : now));
    });
  }
}

}  // namespace burrhole::test
