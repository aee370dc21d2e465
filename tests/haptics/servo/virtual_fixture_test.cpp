// A fixture before a half-space z < 0, and before a ball. The work that it does is summed here, from its forces and the motions, and not taken
// from its own ledger.

#include "haptics/servo/virtual_fixture.h"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

namespace burrhole::test {
namespace {

VirtualFixture made(const FixtureConfig& config) {
  auto out = VirtualFixture::create(config);
  REQUIRE(out);
  return *out;
}

/// A fixture without a limit: the sampled penalty. The sabotage twin.
Vec3 plain_penalty(const FixtureConfig& c, double distance, const Vec3& away) {
  return std::min(c.largest, c.stiffness * std::max(0.0, c.start - distance)) * away;
}

struct Walk {
  double fixture = 0.0, most = 0.0, penalty = 0.0;  // [J] work on the hand over the whole motion; the largest on the way; of the twin
};

using Way = std::vector<Vec3>;

/// A random walk near the face that comes to rest and goes back the way it came. Each step differs from the one before by at most `most`.
Way there_and_back(double most, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Way way{Vec3(0.0, 0.0, 2e-3)};
  Vec3 step(0.0);
  const auto limited = [most](const Vec3& change) { return change * std::min(1.0, 0.999 * most / std::max(1e-300, glm::length(change))); };
  for (int n = 0; n < 3000; ++n) {
    // Drawn to the face by a weak spring, and pushed at random.
    step +=
        limited(Vec3(normal(random), normal(random), normal(random)) * most - (0.02 * (way.back() - Vec3(0.0, 0.0, 0.3e-3)) + 0.2 * step));
    way.push_back(way.back() + step);
  }
  while (step != Vec3(0.0)) {
    step += limited(-step);
    if (glm::length(step) < 1e-3 * most) step = Vec3(0.0);
    way.push_back(way.back() + step);
  }
  for (std::size_t n = way.size(); n-- > 0;) way.push_back(way[n]);
  return way;
}

/// A closed curve of random harmonics round a point before the face, whose steps differ by at most `most`.
Way loop(double most, std::mt19937& random) {
  constexpr int kSteps = 4000, kHarmonics = 120;
  std::normal_distribution<double> normal;
  std::vector<Vec3> sines(kHarmonics), cosines(kHarmonics);
  for (int k = 0; k < kHarmonics; ++k) {
    sines[static_cast<std::size_t>(k)] = Vec3(normal(random), normal(random), normal(random)) / (1.0 + k);
    cosines[static_cast<std::size_t>(k)] = Vec3(normal(random), normal(random), normal(random)) / (1.0 + k);
  }
  Way way;
  for (int n = 0; n <= kSteps; ++n) {
    Vec3 p(0.0);
    for (int k = 0; k < kHarmonics; ++k) {
      const double phase = 2.0 * 3.14159265358979323846 * (k + 1) * (n % kSteps) / kSteps;
      p += sines[static_cast<std::size_t>(k)] * std::sin(phase) + cosines[static_cast<std::size_t>(k)] * std::cos(phase);
    }
    way.push_back(p);
  }
  double largest = 0.0;
  for (std::size_t n = 0; n < kSteps; ++n)
    largest = std::max(largest, glm::length(way[n + 1] - 2.0 * way[n] + way[n == 0 ? kSteps - 1 : n - 1]));
  const Vec3 first = way.front();
  for (Vec3& p : way) p = (p - first) * (0.999 * most / largest) + Vec3(0.0, 0.0, 0.6e-3);  // where no force acts yet
  return way;
}

/// The depth is that of `late` ticks ago, as of a slow contact step.
Walk walked(const FixtureConfig& config, double dt, int late, const Way& way, bool ball) {
  VirtualFixture fixture = made(config);
  Walk out;
  Vec3 held(0.0), held_penalty(0.0);
  for (std::size_t n = 0; n < way.size(); ++n) {
    const Vec3& seen = way[n >= static_cast<std::size_t>(late) ? n - static_cast<std::size_t>(late) : 0];
    const Vec3 centre(0.0, 0.0, -3e-3);
    const double distance = ball ? glm::length(seen - centre) - 3e-3 : seen.z;
    const Vec3 away = ball ? glm::normalize(seen - centre) : Vec3(0.0, 0.0, 1.0);
    if (n > 0) {
      out.fixture += glm::dot(held, way[n] - way[n - 1]);
      out.penalty += glm::dot(held_penalty, way[n] - way[n - 1]);
      out.most = std::max(out.most, out.fixture);
    }
    held = fixture(way[n], distance, away, dt);
    held_penalty = plain_penalty(config, distance, away);
    REQUIRE(is_finite(held));
    REQUIRE(glm::length(held) <= config.largest * (1.0 + 1e-12));
  }
  CHECK(fixture.figures().jumps == 0);
  CHECK(std::abs(fixture.figures().most_given - out.most) < 1e-11);
  return out;
}

}  // namespace

TEST_CASE("virtual fixture: over random closed motions it does no more work on the hand than its allowance, at 1 to 100 ms") {
  // The bound is A itself: E_(k+1) >= E_k - f_k s >= -A (passive_force.h), and rounding: 8000 products of at most 8 N and a few m, each to
  // 2^-53: below 1e-11 J. It holds on the way too, so it is compared there.
  FixtureConfig config;
  double worst = -1.0, worst_penalty = 0.0;
  MESSAGE("seeds 1 to 4");
  for (const bool ball : {false, true})
    for (const double dt : {1e-3, 2e-3, 5e-3, 1e-2, 3e-2, 1e-1})
      for (const int late : {0, 1, 7})
        for (std::uint32_t seed = 1; seed <= 4; ++seed) {
          CAPTURE(dt);
          CAPTURE(late);
          CAPTURE(seed);
          std::mt19937 random(seed);
          const double most = config.limit.acceleration * dt * dt;
          for (const Way& way : {there_and_back(most, random), loop(most, random)}) {
            REQUIRE(glm::length(way.back() - way.front()) < 1e-12);
            const Walk walk = walked(config, dt, late, way, ball);
            CHECK(walk.most <= config.limit.allowance + 1e-11);
            CHECK(walk.fixture <= config.limit.allowance + 1e-11);
            worst = std::max(worst, walk.fixture);
            worst_penalty = std::max(worst_penalty, walk.penalty);
          }
        }
  // The sabotage: a penalty without the observer gives energy over the same motions.
  MESSAGE("largest work " << worst << " J; of a penalty without the observer " << worst_penalty << " J");
  CHECK(worst_penalty > 100.0 * config.limit.allowance);
}

TEST_CASE("virtual fixture: a slow press meets K p and gets at most the allowance back, and a fixture that is left takes up its damping") {
  FixtureConfig config;
  VirtualFixture fixture = made(config);
  const double dt = 1e-3, speed = 0.01;  // [m/s]
  double work = 0.0, deepest_force = 0.0;
  Vec3 before(0.0, 0.0, 1e-3), held(0.0);
  const auto go = [&](double z) {
    const Vec3 here(0.0, 0.0, z);
    work += glm::dot(held, here - before);
    held = fixture(here, z, Vec3(0.0, 0.0, 1.0), dt);
    before = here;
  };
  for (double z = 1e-3; z > -1e-3; z -= speed * dt) go(z);
  deepest_force = held.z;
  // At a depth of 1.5 mm the energy of the spring, 2.25 mJ, allows f s with s = 0.01 + 0.1 mm: no limit. K p + B v.
  CHECK(deepest_force == doctest::Approx(config.stiffness * 1.5e-3 + config.damping * speed).epsilon(0.01));
  for (double z = -1e-3; z < 1e-3; z += speed * dt) go(z);
  CHECK(held == Vec3(0.0));
  // In and out: damping on the way in, B v times the way, less the leak of a held force, K v T times the way: 2000 * 1e-5 * 1.5e-3 * 2 / 2.
  const double damped = config.damping * speed * 1.5e-3, leak = config.stiffness * speed * dt * 1.5e-3;
  CHECK(work == doctest::Approx(-damped + leak).epsilon(0.1));
  CHECK(work < 0.0);
}

TEST_CASE("virtual fixture: a jump may take more than the allowance once; then it is off until the hand has left, and works again") {
  FixtureConfig config;
  VirtualFixture fixture = made(config);
  const Vec3 up(0.0, 0.0, 1.0);
  double z = 0.4e-3;
  for (int n = 0; n < 200; ++n, z -= 1e-5) (void)fixture(Vec3(0.0, 0.0, z), z, up, 1e-3);
  REQUIRE(fixture.figures().peak > 1.0);
  REQUIRE(fixture.figures().jumps == 0);
  (void)fixture(Vec3(0.0, 0.0, 0.2), 0.2e-3, up, 1e-3);  // 0.2 m in a tick, and the depth is old
  CHECK(fixture.figures().jumps == 1);
  CHECK(fixture.figures().taken < -config.limit.allowance);
  CHECK(fixture(Vec3(0.0, 0.0, 0.2), 0.1e-3, up, 1e-3) == Vec3(0.0));
  CHECK(fixture(Vec3(0.0, 0.0, 0.2), 1e-3, up, 1e-3) == Vec3(0.0));  // it has left
  CHECK(fixture(Vec3(0.0, 0.0, 0.2), 0.1e-3, up, 1e-3).z > 0.0);
}

TEST_CASE("virtual fixture: what is not finite gives no force and no work; a restart forgets the last position") {
  VirtualFixture fixture = made({});
  const Vec3 up(0.0, 0.0, 1.0);
  const double nan = std::nan("");
  (void)fixture(Vec3(0.0), 0.0, up, 1e-3);
  CHECK(fixture(Vec3(0.0), 0.0, up, 1e-3).z > 0.0);
  CHECK(fixture(Vec3(nan), 0.0, up, 1e-3) == Vec3(0.0));
  CHECK(fixture(Vec3(0.0), nan, up, 1e-3) == Vec3(0.0));
  CHECK(fixture(Vec3(0.0), 0.0, Vec3(nan), 1e-3) == Vec3(0.0));
  CHECK(fixture(Vec3(0.0), 0.0, up, 0.0) == Vec3(0.0));
  CHECK(fixture(Vec3(0.0), 0.0, Vec3(0.0), 1e-3) == Vec3(0.0));  // no direction
  CHECK(fixture(Vec3(0.0), 0.0, up, 1e-3).z > 0.0);
  fixture.restart();
  (void)fixture(Vec3(1.0), 1.0, up, 1e-3);
  CHECK(fixture.figures().taken == 0.0);
  for (const FixtureConfig& bad :
       {FixtureConfig{.start = -1.0}, FixtureConfig{.stiffness = 0.0}, FixtureConfig{.damping = nan}, FixtureConfig{.largest = 0.0},
        FixtureConfig{.limit = {.allowance = 0.0}}, FixtureConfig{.limit = {.acceleration = nan}}})
    CHECK_FALSE(VirtualFixture::create(bad).ok());
}

}  // namespace burrhole::test
