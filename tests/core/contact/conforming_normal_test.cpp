// conforming_normal against plain sums over the hits, pass by pass: the same bits; and against closed forms.
#include "core/contact/conforming_normal.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/base/random.h"
#include "every_level.h"

using namespace burrhole;

namespace {

constexpr double kEdge = 0.25e-3;  ///< [m]

struct Patch {
  ProbeHits hits;
  TouchPoint touch;
  Mat3 axes{1.0};
};

void add(ProbeHits& hits, const Vec3& place, double distance, const Vec3& normal) {
  const auto put = [](LineVector<float>& to, double v) { to.push_back(static_cast<float>(v)); };
  put(hits.x, place.x), put(hits.y, place.y), put(hits.z, place.z);
  put(hits.nx, normal.x), put(hits.ny, normal.y), put(hits.nz, normal.z);
  put(hits.distance, distance);
  hits.point.push_back(static_cast<std::uint32_t>(hits.count++));
}

/// A bowl of bone (its normals lean inwards by `lean` a voxel) or a hump (less than 0), touched at one place, distances and normals noisy.
Patch patch_of(std::uint64_t seed, std::size_t count, double lean) {
  Patch out;
  const Quat turn = glm::normalize(Quat(uniform11(seed, 1), uniform11(seed, 2), uniform11(seed, 3), 1.5));
  out.axes = glm::mat3_cast(turn);
  const auto normal_at = [&](double x, double y) { return turn * glm::normalize(Vec3(-lean * x, -lean * y, 1.0)); };
  for (std::uint64_t n = 0; n < count; ++n) {
    const auto noise = [&](std::uint64_t k) { return uniform11(seed, 100 + 8 * n + k); };
    const double x = 11.0 * noise(0), y = 11.0 * noise(1);
    const Vec3 normal = normal_at(x, y) + 0.05 * Vec3(noise(2), noise(3), noise(4));
    add(out.hits, kEdge * Vec3(x, y, 0.1 * noise(5)), 0.3 + 0.35 * noise(6), noise(7) > 0.9 ? -normal : normal);
  }
  out.touch = {.place = kEdge * Vec3(0.4, -0.3, 0.0), .gap = 0.02, .normal = normal_at(0.4, -0.3), .steadied = normal_at(0.9, 0.0)};
  return out;
}

/// The definition, one hit after another. @param alike_from cosine from which a normal counts.
Vec3 plainly(const Patch& patch, const HitRange& near, double alike_from = 0.3) {
  Vec3 mean = patch.touch.normal;
  double share = 0.0;
  const ProbeHits& hits = patch.hits;
  const std::size_t every = std::max<std::size_t>(1, (near.last - near.first) / 2000);
  for (int pass = 0; pass < 3; ++pass) {
    double all = 0.0, level_sum = 0.0;
    Vec3 sum(0.0);
    for (std::size_t n = near.first; n < near.last; n += every) {
      const double beyond = std::abs(static_cast<double>(hits.distance[n]) - patch.touch.gap);
      const Vec3 place(static_cast<double>(hits.x[n]), static_cast<double>(hits.y[n]), static_cast<double>(hits.z[n]));
      const Vec3 way = patch.axes * (place - patch.touch.place) / kEdge;
      const double way2 = glm::dot(way, way);
      if (beyond >= 0.6 || way2 >= 64.0) continue;
      const Vec3 normal(static_cast<double>(hits.nx[n]), static_cast<double>(hits.ny[n]), static_cast<double>(hits.nz[n]));
      const double alike = (glm::dot(normal, mean) - alike_from) / (1.0 - alike_from);
      if (alike <= 0.0) continue;
      const double bend = -glm::dot(normal - patch.touch.normal, way) / (way2 + 0.25);
      const double weight = (1.0 - beyond / 0.6) * alike, level = weight * std::clamp(1.5 + bend / 0.03, 0.0, 1.0);
      all += weight;
      level_sum += level;
      sum += normal * level;
    }
    const double length = glm::length(sum);
    if (!(length > 0.0)) return patch.touch.steadied;
    mean = sum / length;
    share = std::clamp((level_sum / all - 0.8) / (0.95 - 0.8), 0.0, 1.0);
  }
  return glm::normalize(patch.touch.steadied * (1.0 - share) + mean * share);
}

}  // namespace

TEST_CASE("conforming normal: the bits of plain sums, at every SIMD level") {
  int means = 0;
  for (const std::size_t count : {0, 1, 3, 8, 17, 100, 731, 3999, 4000, 9001}) {
    for (const double lean : {0.0, 0.04, -0.05}) {
      const Patch patch = patch_of(count, count, lean);
      for (const HitRange near : {HitRange{0, count}, HitRange{count / 3, count - count / 4}}) {
        const Vec3 plain = plainly(patch, near);
        means += plain != patch.touch.steadied;
        at_all_levels([&] {
          CAPTURE(count);
          CAPTURE(lean);
          CHECK(conforming_normal(patch.hits, near, patch.touch, patch.axes, kEdge) == plain);
        });
        // Sabotage: another window of directions shows where many are asked and no bulge hides them.
        if (count > 700 && lean > 0.0) CHECK(plainly(patch, near, 0.5) != plain);
      }
    }
  }
  CHECK(means > 15);
}

TEST_CASE("conforming normal: a concave patch gives its mean normal, a convex one the normal at the contact") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Patch bowl = patch_of(seed, 3000, 0.04), hump = patch_of(seed, 3000, -0.1);
    const Vec3 up = bowl.axes[2];
    const Vec3 of_bowl = conforming_normal(bowl.hits, {0, bowl.hits.count}, bowl.touch, bowl.axes, kEdge);
    // The patch lies 0.5 voxel off the middle: 0.02 rad. Over it directions are spread by 0.16 rad, and some 800 count: 3 sigma are 0.017.
    CHECK(glm::dot(of_bowl, up) > std::cos(0.04 * 0.5 + 0.017));
    CHECK(conforming_normal(hump.hits, {0, hump.hits.count}, hump.touch, hump.axes, kEdge) == glm::normalize(hump.touch.steadied));
  }
}
