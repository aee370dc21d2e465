#include "core/measure/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/contact/contact_flag.h"

namespace burrhole {
namespace {

/// The flags in the order of their bits.
constexpr std::array<OutcomeFlag, kOutcomeFlags> kFlags{kFlagPlunged,     kFlagShelfLeft,   kFlagCoreLeft,       kFlagTunnelled,
                                                        kFlagBroughtBack, kFlagMissedSteps, kFlagContactDegraded};

double percent(double share) { return 100.0 * share; }

/// @returns the depth of the removed bone if it were spread over the cross-section [mm].
double cut_depth_mm(const OutcomeFigures& f) { return f.section_mm2 > 0.0 ? f.removed_mass_mm3 / f.section_mm2 : 0.0; }

/// @returns the distance from the axis from which on the bit has skated [mm].
double aside_limit_mm(const OutcomeFigures& f, const OutcomeLimits& limits) { return std::max(f.section_radius_mm, limits.aside_mm); }

bool skated(const OutcomeFigures& f, const OutcomeLimits& limits) {
  return !f.by_user && !f.bone_moves && f.aside_mm > aside_limit_mm(f, limits);
}

bool uncut(const OutcomeFigures& f, const OutcomeLimits& limits) {
  if (!f.passed || f.by_user || f.bone_moves) return false;  // a user may drill beside the planned axis
  return f.uncut_share ? *f.uncut_share > limits.uncut_share : f.axis_removed < limits.uncut_share;
}

bool holds(DrillResult result, const OutcomeFigures& f, const OutcomeLimits& limits) {
  switch (result) {
    case DrillResult::faulted:
      return f.latched_faults > 0;
    case DrillResult::carved:
      return f.bone_moves && f.end != DrillEnd::stopped && cut_depth_mm(f) >= limits.cut_depth_mm;
    case DrillResult::skated_off:
      return skated(f, limits);
    case DrillResult::passed_uncut:
      return uncut(f, limits);
    case DrillResult::drilled_through:
      return !f.bone_moves && f.cleared_share.value_or(0.0) >= limits.through_share;
    case DrillResult::interrupted:
      return f.end == DrillEnd::stopped;
    case DrillResult::did_not_cut:
      return cut_depth_mm(f) < limits.cut_depth_mm;
    case DrillResult::stopped_short:
      return true;
  }
  return false;
}

const char* end_text(DrillEnd end) {
  switch (end) {
    case DrillEnd::script:
      return "the hand withdrew";
    case DrillEnd::feed:
      return "the feed reached its stop";
    case DrillEnd::user:
      return "the user ended the run";
    case DrillEnd::time:
      return "the time of the scene ended";
    case DrillEnd::stopped:
      return "the run was stopped";
  }
  return "";
}

std::string reason_of(DrillResult result, const OutcomeFigures& f) {
  const std::string depth = fmt::format("{:.2f} mm deep in {:.2f} mm of bone", f.reached_mm, f.thickness_mm);
  switch (result) {
    case DrillResult::faulted:
      return fmt::format("{} servo fault{} latched, and the force on the hand was zero from then on", f.latched_faults,
                         f.latched_faults == 1 ? " was" : "s were");
    case DrillResult::carved:
      return fmt::format("{:.1f} mm3 of bone were removed while it was moved", f.removed_mass_mm3);
    case DrillResult::skated_off:
      return fmt::format("in contact the tip was {:.1f} mm beside the axis; the radius of the bit is {:.2f} mm", f.aside_mm,
                         f.section_radius_mm);
    case DrillResult::passed_uncut:
      if (f.uncut_share)
        return fmt::format("the bit passed the bone, and {:.0f} % of the bone in its path is not clear", percent(*f.uncut_share));
      return fmt::format("the tip passed the bone when {:.0f} % of it was removed on the axis", percent(f.axis_removed));
    case DrillResult::drilled_through:
      return fmt::format("{:.0f} % of the bit's cross-section is clear of bone", percent(f.cleared_share.value_or(0.0)));
    case DrillResult::interrupted:
      return "the run was stopped " + depth;
    case DrillResult::did_not_cut:
      if (!f.spins) return "no bone is removed by this bit at this speed, or without [erosion]";
      if (f.axis_open) return fmt::format("no bone was on the axis at the start; this run removed {:.2f} mm3", f.removed_mass_mm3);
      return fmt::format("the removed bone is {:.3f} mm deep, spread over the bit's cross-section", cut_depth_mm(f));
    case DrillResult::stopped_short:
      if (f.axis_open)
        return fmt::format("no bone was on the axis at the start; this run removed {:.1f} mm3; {}", f.removed_mass_mm3, end_text(f.end));
      return fmt::format("{} {}; {:.0f} % of the bit's cross-section is clear", end_text(f.end), depth,
                         percent(f.cleared_share.value_or(0.0)));
  }
  return {};
}

bool is_set(OutcomeFlag flag, DrillResult result, const OutcomeFigures& f, const OutcomeLimits& limits) {
  const bool through = result == DrillResult::drilled_through;
  switch (flag) {
    case kFlagPlunged:
      return f.plunge_mm.value_or(0.0) > limits.plunge_mm;
    case kFlagShelfLeft:
      return through && *f.cleared_share < limits.whole_share;
    case kFlagCoreLeft:
      return through && !f.axis_clear && !f.axis_open;
    case kFlagTunnelled:
      return f.section_on_axis && !f.bone_moves && !skated(f, limits) && f.ahead_mm.value_or(0.0) > f.voxel_mm;
    case kFlagBroughtBack:
      return f.brought_back;
    case kFlagMissedSteps:
      return std::ranges::any_of(f.steps, [&](const MissedSteps& clock) { return clock.share() > limits.missed_share; });
    case kFlagContactDegraded:
      return static_cast<double>(f.contact_degraded) > limits.degraded_share * static_cast<double>(f.contact_evaluations);
  }
  return false;
}

}  // namespace

RunOutcome judge(const OutcomeFigures& figures, const OutcomeLimits& limits) {
  RunOutcome out;
  for (std::size_t n = 0; n < kDrillResults; ++n) {
    out.result = static_cast<DrillResult>(n);
    if (holds(out.result, figures, limits)) break;
  }
  out.reason = reason_of(out.result, figures);
  for (const OutcomeFlag flag : kFlags)
    if (is_set(flag, out.result, figures, limits)) out.flags |= flag;
  return out;
}

const char* name_of(DrillResult result) noexcept {
  constexpr std::array<const char*, kDrillResults> kNames{"faulted",         "carved",      "skated-off",  "passed-uncut",
                                                          "drilled-through", "interrupted", "did-not-cut", "stopped-short"};
  return kNames[static_cast<std::size_t>(result)];
}

const char* name_of(OutcomeFlag flag) noexcept {
  switch (flag) {
    case kFlagPlunged:
      return "plunged";
    case kFlagShelfLeft:
      return "shelf-left";
    case kFlagCoreLeft:
      return "core-left";
    case kFlagTunnelled:
      return "tunnelled";
    case kFlagBroughtBack:
      return "brought-back";
    case kFlagMissedSteps:
      return "missed-steps";
    case kFlagContactDegraded:
      return "contact-degraded";
  }
  return "";
}

std::optional<DrillResult> result_named(std::string_view name) noexcept {
  for (std::size_t n = 0; n < kDrillResults; ++n)
    if (name == name_of(static_cast<DrillResult>(n))) return static_cast<DrillResult>(n);
  return std::nullopt;
}

std::vector<std::string> flag_names(std::uint32_t flags) {
  std::vector<std::string> out;
  for (const OutcomeFlag flag : kFlags)
    if ((flags & flag) != 0) out.emplace_back(name_of(flag));
  return out;
}

std::vector<std::string> contact_flag_texts(std::uint32_t flags) {
  std::vector<std::string> out;
  const auto add = [&](ContactFlag flag, const char* text) {
    if ((flags & flag) != 0) out.emplace_back(text);
  };
  add(kContactOutsideWindow, "bone near the tool had not been read, and the tool was held in place or had no force there");
  add(kContactNoSurface, "a search from a point of the tool ended without a surface: that point had no force");
  add(kContactZeroGradient, "the density gradient was zero at a surface: the normal of the tool's point was used");
  add(kContactNotFinite, "a pose was not finite: the force was zero");
  add(kContactUnsettled, "the solver of the constrained tool reached its limit before it converged");
  return out;
}

std::vector<OutcomeRow> result_rows(const OutcomeLimits& limits) {
  const std::array<std::string, kDrillResults> criteria{
      "a servo fault was latched; from then on the force on the hand was zero",
      fmt::format("the bone was moved by `[motion]`, the run was not interrupted, and it did cut (did-not-cut: {:g} mm). There is no axis "
                  "of a burrhole "
                  "then: skated-off, passed-uncut, drilled-through and tunnelled are not judged, and there is no plunge",
                  limits.cut_depth_mm),
      fmt::format(
          "in contact, and before the tip passed the bone, `drilling.aside_mm` was more than the radius of the bit's cross-section and "
          "than {:g} mm; not for a hand that a user moves",
          limits.aside_mm),
      fmt::format(
          "the tip passed the bone, and `drilling.uncut_share` > {0:g}; without that figure: `drilling.axis_removed_at_passing` < {0:g}; "
          "not for a hand that a user moves",
          limits.uncut_share),
      fmt::format("`drilling.cleared_share` >= {:g}", limits.through_share),
      "a signal ended the run, or a user ended a demonstration",
      fmt::format("`drilling.removed_mass_mm3` over the area of the bit's cross-section < {:g} mm", limits.cut_depth_mm),
      "any other run"};
  std::vector<OutcomeRow> out;
  for (std::size_t n = 0; n < kDrillResults; ++n) out.push_back({name_of(static_cast<DrillResult>(n)), criteria[n]});
  return out;
}

std::vector<OutcomeRow> flag_rows(const OutcomeLimits& limits) {
  const std::array<std::string, kOutcomeFlags> criteria{
      fmt::format("`drilling.plunge_mm` > `plunge_limit_mm` of `[outcome]`, by default {:g} mm", limits.plunge_mm),
      fmt::format("drilled-through with `drilling.cleared_share` < {:g}", limits.whole_share),
      "drilled-through with bone left on the axis, as a crown leaves it",
      "`drilling.largest_ahead_of_engagement_mm` is more than a voxel; not for a crown, nor where the bit skated",
      "an undo, a reset or a restore took a breakthrough back",
      fmt::format("a live run missed more than {:g} % of the steps of servo, contact or simulation", percent(limits.missed_share)),
      fmt::format("`degraded` of the effect `contact` is more than {:g} % of its `evaluations`", percent(limits.degraded_share))};
  std::vector<OutcomeRow> out;
  for (std::size_t n = 0; n < kOutcomeFlags; ++n) out.push_back({name_of(kFlags[n]), criteria[n]});
  return out;
}

}  // namespace burrhole
