// Measures of hard cases: traces in closed form, and the same traces broken, which must read otherwise.
#include "app/lab/stability_trace.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>

using namespace burrhole;

namespace {

constexpr double kPeriod = 1e-3;

StabilityTrace make_trace(int ticks, const std::function<void(int, StabilitySample&)>& fill) {
  StabilityTrace trace{.period = kPeriod, .samples = {}};
  for (int n = 0; n < ticks; ++n) {
    StabilitySample sample;
    sample.time = n * kPeriod;
    sample.normal = Vec3(0.0, 0.0, 1.0);
    fill(n, sample);
    trace.samples.push_back(sample);
  }
  return trace;
}

/// Into a spring and out of it at a steady speed: K = 1000 N/m, 100 ticks of 10 um each way. `late` ticks pass until the force comes.
StabilityTrace in_and_out(int late) {
  const auto depth = [](int n) { return 1e-5 * (n <= 100 ? n : 200 - n); };
  return make_trace(201, [&](int n, StabilitySample& s) {
    s.grip = {0.0, 0.0, -depth(n)};
    s.grip_velocity = {0.0, 0.0, n <= 100 ? -0.01 : 0.01};
    s.shown = {0.0, 0.0, 1000.0 * depth(std::max(0, n - late))};
    s.force = s.shown;
  });
}

}  // namespace

TEST_CASE("stability: a sampled spring leaks half a step of its force each way and a tick of delay three times that") {
  // Work of the held force over a stroke of N steps d: sum of K d^2 n. In: K d^2 N(N-1)/2 with the force of the tick before; out: N(N+1)/2.
  // What is owed at the end is K d^2 N; each tick of delay adds twice as much.
  const double leak = 1000.0 * 1e-10 * 100.0;
  CHECK(std::abs(passivity_deficit(in_and_out(0), {}) - leak) <= 1e-12);
  // One step less at the turn, where both ticks hold the same force.
  CHECK(passivity_deficit(in_and_out(1), {}) == doctest::Approx(3.0 * leak).epsilon(0.02));
  // Damping of K T / 2 = 0.5 N s/m pays for a tick's hold and not for a tick of delay.
  // At the turn the velocity jumps within a tick; as a straight line it is swallowed there by a third, 2/3 b v^2 T too little.
  CHECK(passivity_deficit(in_and_out(0), {.damping = 0.5}) <= 2.0 / 3.0 * 0.5 * 1e-4 * kPeriod * (1.0 + 1e-9));
  CHECK(passivity_deficit(in_and_out(1), {.damping = 0.5}) > leak);
  // Friction of 0.02 N over 2 mm pays 40 uJ: all of both.
  CHECK(passivity_deficit(in_and_out(1), {.friction = 0.02}) <= 1e-12);
}

TEST_CASE("stability: a flipped force counts all its work as passivity deficit") {
  StabilityTrace trace = in_and_out(0);
  for (StabilitySample& s : trace.samples) s.shown = -s.shown;
  // It pulls the grip in: K d^2 N (N - 1) / 2 at the turn.
  CHECK(passivity_deficit(trace, {}) == doctest::Approx(1000.0 * 1e-10 * 100.0 * 99.0 / 2.0).epsilon(1e-9));
}

TEST_CASE("stability: work by whoever moves bone is not the wall's") {
  // Bone comes up under a resting grip and pushes it along: the grip gains energy from who moves bone, the wall keeps still.
  const auto carried = [](bool told) {
    return make_trace(100, [told](int n, StabilitySample& s) {
      s.grip = {0.0, 0.0, 1e-5 * n};
      if (told) s.carried = s.grip;
      s.shown = {0.0, 0.0, 1.0};
    });
  };
  CHECK(passivity_deficit(carried(true), {}) <= 1e-15);
  CHECK(passivity_deficit(carried(false), {}) == doctest::Approx(99e-5).epsilon(1e-9));
}

TEST_CASE("stability: what is not finite is counted, and no bound holds it") {
  const StabilityTrace trace = make_trace(10, [](int n, StabilitySample& s) {
    if (n == 4) s.force.x = std::nan("");
    if (n == 7) s.tool.z = std::numeric_limits<double>::infinity();
  });
  CHECK(ticks_not_finite(trace) == 2.0);
  CHECK(std::isnan(largest_force(trace, {})));
}

TEST_CASE("stability: the attractive force is the largest of the span, and one that is no number stays") {
  const auto pulling = [](double newton) {
    return make_trace(5, [newton](int n, StabilitySample& s) { s.attractive_force = n == 2 ? newton : 0.0; });
  };
  CHECK(largest_attractive_force(pulling(2.0), {}) == 2.0);
  CHECK(largest_attractive_force(pulling(2.0), {3e-3, 1.0}) == 0.0);
  CHECK(std::isnan(largest_attractive_force(pulling(std::nan("")), {})));
}

TEST_CASE("stability: force that outlives its bone is timed by its longest stretch") {
  const auto outliving = [](int from, int to) {
    return make_trace(20, [from, to](int n, StabilitySample& s) {
      s.force = {0.0, 0.0, n >= from && n < to ? 1.0 : 0.0};
      s.bone_between = n < 10;
    });
  };
  CHECK(longest_force_without_bone(outliving(0, 10), 0.05) == 0.0);
  CHECK(longest_force_without_bone(outliving(0, 11), 0.05) == doctest::Approx(1e-3));  // one tick more
  CHECK(longest_force_without_bone(outliving(12, 17), 0.05) == doctest::Approx(5e-3));
  CHECK(longest_force_without_bone(outliving(12, 17), 2.0) == 0.0);
}

TEST_CASE("stability: a limit cycle has the size and the ripple of its sine") {
  const auto cycling = [](double size) {
    return make_trace(1000, [size](int n, StabilitySample& s) {
      const double phase = 0.1 * n;
      s.grip = {0.0, 0.5 * size * std::sin(phase), 1.0};
      s.force = {0.0, 0.0, 4.0 + 1000.0 * 0.5 * size * std::sin(phase)};
      s.grip_velocity = {0.0, 50.0 * size * std::cos(phase), 0.0};
    });
  };
  // 100 samples a turn: the peak is met within 1 - cos(0.05).
  CHECK(cycle_size(cycling(1e-4), {}) == doctest::Approx(1e-4).epsilon(2e-3));
  CHECK(force_ripple(cycling(1e-4), {}) == doctest::Approx(0.1 / 4.0).epsilon(5e-3));
  CHECK(largest_speed(cycling(1e-4), {}) == doctest::Approx(5e-3).epsilon(2e-3));
  CHECK(cycle_size(cycling(0.0), {}) == 0.0);
  CHECK(force_ripple(cycling(0.0), {}) == 0.0);
}

TEST_CASE("stability: drag is the work along the surface over the way, and the same there and back") {
  const auto sliding = [](double friction) {
    return make_trace(201, [friction](int n, StabilitySample& s) {
      const double way = n <= 100 ? 1.0 : -1.0;
      s.tool = {1e-5 * (n <= 100 ? n : 200 - n), 0.0, 0.0};
      s.force = {-friction * way, 0.0, 3.0};
    });
  };
  CHECK(drag_along(sliding(0.0), {}) == 0.0);
  CHECK(drag_along(sliding(0.6), {0.0, 0.1}) == doctest::Approx(0.6));
  CHECK(drag_along(sliding(0.6), {0.102, 0.2}) == doctest::Approx(0.6));
  CHECK(largest_lateral_force(sliding(0.6), {}) == doctest::Approx(0.6));
  CHECK(largest_lateral_force(sliding(0.0), {}) == 0.0);
}

TEST_CASE("stability: depth, far side and steps of force are the largest of the span") {
  const StabilityTrace trace = make_trace(10, [](int n, StabilitySample& s) {
    s.depth = n == 3 ? 2e-5 : -1e-3;
    s.beyond = n == 8 ? 1e-3 : -1e-3;
    s.force = {0.0, 0.0, n < 5 ? 1.0 : 3.5};
  });
  CHECK(deepest(trace, {}) == 2e-5);
  CHECK(deepest(trace, {4e-3, 1.0}) == 0.0);
  CHECK(furthest_beyond(trace, {}) == 1e-3);
  CHECK(furthest_beyond(trace, {0.0, 5e-3}) == 0.0);
  CHECK(largest_force_step(trace, {}) == 2.5);
  CHECK(largest_force_step(trace, {5e-3, 1.0}) == 0.0);
}

TEST_CASE("stability: force during a latched fault is seen, and a latched fault that was not reported is counted") {
  const auto faulty = [](double force, int told) {
    return make_trace(100, [force, told](int n, StabilitySample& s) {
      if (n >= 50 && n < 50 + told) s.faults = 4u;
      s.force = {0.0, 0.0, n >= 50 ? force : 2.0};
    });
  };
  CHECK(largest_force_with(faulty(0.0, 50), 4u) == 0.0);
  CHECK(largest_force_with(faulty(1.5, 50), 4u) == 1.5);
  CHECK(largest_force_with(faulty(1.5, 50), 8u) == 0.0);
  CHECK(share_with(faulty(0.0, 50), {0.05, 1.0}, 4u) == 1.0);
  CHECK(share_with(faulty(0.0, 40), {0.05, 1.0}, 4u) == doctest::Approx(0.8));
}
