// The lead of the tool in a bone step, in closed form: a face that follows a tool at constant thrust, a constant feed, and the limits.
#include "app/stage/tool_lead.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace burrhole;

namespace {

constexpr double kEdge = 0.25e-3, kDt = 0.02;  // [m], [s] of a step
constexpr int kTicks = 20;                     // of contact in a step
const Vec3 kAway(0.0, 0.0, 1.0);               // of bone on the tool

/// Contact of one step. @param at position at each of its ticks.
void evaluate(ContactState& state, const std::function<Vec3(int)>& at) {
  for (int n = 0; n < kTicks; ++n) {
    state.world_from_tool.translation = at(n);
    state.position_sum += state.world_from_tool.translation;
    ++state.number;
  }
}

/// Depth of the face [m] after a hundred steps, in which the tool stands `overlap` [m] below the face. @param x r dt.
double drilled(double overlap, double x, bool leads) {
  ToolLead lead(kEdge);
  ContactState state;
  double face = 0.0;
  for (int step = 0; step < 100; ++step) {
    evaluate(state, [&](int) { return Vec3(0.0, 0.0, -face - overlap); });
    const double ahead = leads ? -lead(state, kAway).z : 0.0;
    face += (1.0 - std::exp(-x)) * (overlap + ahead);
  }
  return face;
}

}  // namespace

TEST_CASE("tool lead: at a constant thrust a bit feeds by the law up to terms of second order; without it by less, in first order") {
  const double overlap = 0.1e-3;
  for (const double x : {0.05, 0.2, 0.4}) {
    const double law = 100.0 * x * overlap;
    // An advance of a step is a (w + A / 2): A = 2 w tanh(x / 2). The first step has no lead: half an advance is lost once.
    CHECK(std::abs(drilled(overlap, x, true) / law - 1.0) < x * x / 12.0 + 0.5 * x / 100.0 + 1e-6);
    CHECK(drilled(overlap, x, false) / law == doctest::Approx((1.0 - std::exp(-x)) / x));
    CHECK(drilled(overlap, x, false) < (1.0 - 0.4 * x) * law);
  }
}

TEST_CASE("tool lead: at a constant speed there is none but half a tick's way") {
  ToolLead lead(kEdge);
  ContactState state;
  const double a_tick = 1e-3 * kDt / kTicks;  // [m] at 1 mm/s
  for (int step = 0; step < 5; ++step) {
    evaluate(state, [&](int n) { return Vec3(0.0, 0.0, -a_tick * (step * kTicks + n)); });
    const Vec3 ahead = lead(state, kAway);
    CHECK(glm::length(ahead) <= 0.5 * a_tick * (1.0 + 1e-6));
  }
}

TEST_CASE("tool lead: a tool that trembles across the force has none, and removes no bone beside the hole that it does not reach") {
  ToolLead lead(kEdge), across(kEdge);
  ContactState state;
  double most = 0.0;
  for (int step = 0; step < 50; ++step) {
    evaluate(state, [&](int n) {
      return Vec3(40e-6 * std::sin(2.0 * std::numbers::pi * 9.0 * kDt * (step + static_cast<double>(n) / kTicks)), 0.0, 0.0);
    });
    CHECK(lead(state, kAway) == Vec3(0.0));
    most = std::max(most, glm::length(across(state, Vec3(1.0, 0.0, 0.0))));
  }
  // Sabotage: a force along the tremor. Its M + (M - M') / 2 is ahead of the end of a step by a quarter of the amplitude and more.
  CHECK(most > 10e-6);
}

TEST_CASE(
    "tool lead: none in the first step, without contact and without a new evaluation; a tool that leaps leads by a tenth of a voxel") {
  ToolLead lead(kEdge);
  ContactState state;
  CHECK(lead(state, kAway) == Vec3(0.0));
  evaluate(state, [](int) { return Vec3(0.0, 0.0, 0.02); });
  CHECK(lead(state, kAway) == Vec3(0.0));
  evaluate(state, [](int) { return Vec3(0.0, 0.0, 0.01); });
  CHECK(lead(state, kAway).z == doctest::Approx(-0.1 * kEdge));
  CHECK(lead(state, kAway) == Vec3(0.0));
  evaluate(state, [](int) { return Vec3(0.0); });
  CHECK(lead(state, Vec3(0.0)) == Vec3(0.0));
}
