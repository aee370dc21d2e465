// Each result and each flag on both sides of its threshold, and the order in which results are asked for.

#include "core/measure/outcome.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "core/contact/contact_flag.h"

namespace burrhole::test {
namespace {

constexpr OutcomeLimits kLimits;

/// A bit of 11 mm that is through 7 mm of bone.
OutcomeFigures through() {
  OutcomeFigures f;
  f.end = DrillEnd::script;
  f.reached_mm = 8.0, f.thickness_mm = 7.0;
  f.passed = true, f.axis_removed = 0.98, f.axis_clear = true;
  f.cleared_share = 0.97, f.uncut_share = 0.01;
  f.section_mm2 = 95.0, f.section_radius_mm = 5.5;
  f.removed_mass_mm3 = 900.0;
  f.aside_mm = 0.1, f.plunge_mm = 0.4, f.ahead_mm = 0.0, f.voxel_mm = 0.25;
  return f;
}

/// The same bit, halfway in.
OutcomeFigures halfway() {
  OutcomeFigures f = through();
  f.reached_mm = 3.5;
  f.passed = false, f.axis_removed = 0.0, f.axis_clear = false;
  f.cleared_share = 0.0, f.uncut_share.reset(), f.plunge_mm.reset();
  f.removed_mass_mm3 = 300.0;
  return f;
}

DrillResult result_of(OutcomeFigures figures, const std::function<void(OutcomeFigures&)>& change) {
  change(figures);
  return judge(figures, kLimits).result;
}

bool has(OutcomeFigures figures, OutcomeFlag flag, const std::function<void(OutcomeFigures&)>& change) {
  change(figures);
  return (judge(figures, kLimits).flags & flag) != 0;
}

double above(double value) { return std::nextafter(value, 1e9); }
double below(double value) { return std::nextafter(value, -1e9); }

TEST_CASE("outcome: a hole through the whole cross-section is drilled through, without a flag") {
  const RunOutcome outcome = judge(through(), kLimits);
  CHECK(outcome.result == DrillResult::drilled_through);
  CHECK(outcome.flags == 0);
  CHECK(outcome.reason == "97 % of the bit's cross-section is clear of bone");
}

TEST_CASE("outcome: through from half of the cross-section on, and short of it below") {
  CHECK(result_of(through(), [](auto& f) { f.cleared_share = kLimits.through_share; }) == DrillResult::drilled_through);
  CHECK(result_of(through(), [](auto& f) { f.cleared_share = below(kLimits.through_share); }) == DrillResult::stopped_short);
  CHECK(result_of(through(), [](auto& f) { f.cleared_share.reset(); }) == DrillResult::stopped_short);
}

TEST_CASE("outcome: a run that ends with the bit in bone is stopped short, with its end and depth") {
  const RunOutcome outcome = judge(halfway(), kLimits);
  CHECK(outcome.result == DrillResult::stopped_short);
  CHECK(outcome.reason == "the hand withdrew 3.50 mm deep in 7.00 mm of bone; 0 % of the bit's cross-section is clear");
}

TEST_CASE("outcome: bone less than a tenth of a millimetre deep over the cross-section was not cut") {
  const double least = kLimits.cut_depth_mm * 95.0;
  CHECK(result_of(halfway(), [&](auto& f) { f.removed_mass_mm3 = 0.999 * least; }) == DrillResult::did_not_cut);
  CHECK(result_of(halfway(), [&](auto& f) { f.removed_mass_mm3 = 1.001 * least; }) == DrillResult::stopped_short);
  CHECK(result_of(halfway(), [](auto& f) { f.section_mm2 = 0.0; }) == DrillResult::did_not_cut);
}

TEST_CASE("outcome: a tip beside the axis by more than the radius of the bit has skated, in a script's hand") {
  CHECK(result_of(through(), [](auto& f) { f.aside_mm = 5.5; }) == DrillResult::drilled_through);
  CHECK(result_of(through(), [](auto& f) { f.aside_mm = above(5.5); }) == DrillResult::skated_off);
  CHECK(result_of(through(), [](auto& f) { f.aside_mm = above(5.5), f.by_user = true; }) == DrillResult::drilled_through);
  // a thin bit: a millimetre at least
  CHECK(result_of(halfway(), [](auto& f) { f.section_radius_mm = 0.5, f.aside_mm = 1.0; }) == DrillResult::stopped_short);
  CHECK(result_of(halfway(), [](auto& f) { f.section_radius_mm = 0.5, f.aside_mm = above(1.0); }) == DrillResult::skated_off);
}

TEST_CASE("outcome: a tip beyond bone that is still there has passed uncut, by columns, or by the axis without them") {
  const auto share = [](double uncut) { return [=](OutcomeFigures& f) { f.cleared_share = 0.1, f.uncut_share = uncut; }; };
  CHECK(result_of(through(), share(kLimits.uncut_share)) == DrillResult::stopped_short);
  CHECK(result_of(through(), share(above(kLimits.uncut_share))) == DrillResult::passed_uncut);
  const auto axis = [](double removed) {
    return [=](OutcomeFigures& f) { f.cleared_share = 0.1, f.uncut_share.reset(), f.axis_removed = removed; };
  };
  CHECK(result_of(through(), axis(kLimits.uncut_share)) == DrillResult::stopped_short);
  CHECK(result_of(through(), axis(below(kLimits.uncut_share))) == DrillResult::passed_uncut);
  // A user's hole may lie beside the planned axis.
  CHECK(result_of(through(), [](auto& f) { f.cleared_share = 0.1, f.uncut_share = 1.0, f.by_user = true; }) == DrillResult::stopped_short);
  CHECK(result_of(halfway(), [](auto& f) { f.uncut_share = 1.0; }) == DrillResult::stopped_short);  // it never passed
}

TEST_CASE("outcome: the first criterion that holds is the result") {
  OutcomeFigures f = through();
  f.end = DrillEnd::stopped, f.removed_mass_mm3 = 0.0;
  CHECK(judge(f, kLimits).result == DrillResult::drilled_through);  // a stop does not take back what was drilled
  f.cleared_share = 0.0;
  CHECK(judge(f, kLimits).result == DrillResult::interrupted);  // a longer run might have cut
  f.end = DrillEnd::time;
  CHECK(judge(f, kLimits).result == DrillResult::did_not_cut);
  f.cleared_share = 1.0, f.uncut_share = 1.0;
  CHECK(judge(f, kLimits).result == DrillResult::passed_uncut);
  f.aside_mm = 200.0;
  CHECK(judge(f, kLimits).result == DrillResult::skated_off);
  f.latched_faults = 1;
  CHECK(judge(f, kLimits).result == DrillResult::faulted);
}

TEST_CASE("outcome: a bone that was moved is carved, whatever lies on the axis") {
  OutcomeFigures f = through();
  f.bone_moves = true, f.aside_mm = 200.0, f.uncut_share = 1.0, f.ahead_mm = 7.0;
  CHECK(judge(f, kLimits).result == DrillResult::carved);
  CHECK(judge(f, kLimits).flags == 0);
  f.end = DrillEnd::stopped;
  CHECK(judge(f, kLimits).result == DrillResult::interrupted);
  f.end = DrillEnd::time, f.removed_mass_mm3 = 0.0;
  CHECK(judge(f, kLimits).result == DrillResult::did_not_cut);
  f.latched_faults = 1;
  CHECK(judge(f, kLimits).result == DrillResult::faulted);
}

TEST_CASE("outcome: each flag on both sides of its threshold") {
  CHECK_FALSE(has(through(), kFlagPlunged, [](auto& f) { f.plunge_mm = kLimits.plunge_mm; }));
  CHECK(has(through(), kFlagPlunged, [](auto& f) { f.plunge_mm = above(kLimits.plunge_mm); }));
  CHECK_FALSE(has(through(), kFlagShelfLeft, [](auto& f) { f.cleared_share = kLimits.whole_share; }));
  CHECK(has(through(), kFlagShelfLeft, [](auto& f) { f.cleared_share = below(kLimits.whole_share); }));
  CHECK_FALSE(has(halfway(), kFlagShelfLeft, [](auto&) {}));
  CHECK(has(through(), kFlagCoreLeft, [](auto& f) { f.axis_clear = false; }));
  CHECK_FALSE(has(halfway(), kFlagCoreLeft, [](auto&) {}));
  CHECK_FALSE(has(through(), kFlagTunnelled, [](auto& f) { f.ahead_mm = 0.25; }));
  CHECK(has(through(), kFlagTunnelled, [](auto& f) { f.ahead_mm = above(0.25); }));
  CHECK_FALSE(has(through(), kFlagTunnelled, [](auto& f) { f.ahead_mm = 7.0, f.section_on_axis = false; }));
  CHECK_FALSE(has(through(), kFlagTunnelled, [](auto& f) { f.ahead_mm = 7.0, f.aside_mm = 200.0; }));
  CHECK(has(halfway(), kFlagBroughtBack, [](auto& f) { f.brought_back = true; }));
  // 44 of 4400 is the hundredth that still counts as none
  CHECK_FALSE(has(through(), kFlagMissedSteps, [](auto& f) { f.steps = {{"servo", 0, 44000}, {"simulation", 44, 4400}}; }));
  CHECK(has(through(), kFlagMissedSteps, [](auto& f) { f.steps = {{"servo", 0, 44000}, {"simulation", 45, 4400}}; }));
  CHECK_FALSE(has(through(), kFlagMissedSteps, [](auto& f) { f.steps = {{"servo", 0, 0}}; }));
  CHECK_FALSE(has(through(), kFlagContactDegraded, [](auto& f) { f.contact_degraded = 100, f.contact_evaluations = 10000; }));
  CHECK(has(through(), kFlagContactDegraded, [](auto& f) { f.contact_degraded = 101, f.contact_evaluations = 10000; }));
  CHECK_FALSE(has(through(), kFlagContactDegraded, [](auto&) {}));  // a scene without contact
}

TEST_CASE("outcome: words name results and flags, each its own, and come back") {
  for (std::size_t n = 0; n < kDrillResults; ++n) {
    const auto result = static_cast<DrillResult>(n);
    CHECK(result_named(name_of(result)) == result);
  }
  CHECK_FALSE(result_named("through").has_value());
  CHECK(flag_names(kFlagPlunged | kFlagMissedSteps) == std::vector<std::string>{"plunged", "missed-steps"});
  CHECK(flag_names((1u << kOutcomeFlags) - 1).size() == kOutcomeFlags);
  CHECK(result_rows(kLimits).size() == kDrillResults);
  CHECK(flag_rows(kLimits).size() == kOutcomeFlags);
  CHECK(
      contact_flag_texts(kContactUnsettled | kContactOutsideWindow | kContactNoSurface | kContactZeroGradient | kContactNotFinite).size() ==
      5);
}

}  // namespace
}  // namespace burrhole::test
