#include <fmt/format.h>

#include <cmath>

#include "app/job/summary.h"
#include "app/report/drill_report.h"
#include "core/base/units.h"

namespace burrhole {
namespace {

DrillEnd end_of(const RunSummary& s) {
  if (s.end == "stopped") return DrillEnd::stopped;
  if (s.end == "duration") return DrillEnd::time;
  if (s.by_user) return DrillEnd::user;
  return s.bench ? DrillEnd::feed : DrillEnd::script;
}

/// @returns whether the run is one that removes bone.
bool drills(const RunSummary& s) { return s.erosion_points > 0 && s.spin_rpm > 0.0; }

std::string how_far(const RunSummary& s) { return fmt::format("{:.2f} mm deep in {:.2f} mm of bone", s.reached_mm, s.thickness_mm); }

OutcomeFigures figures_of(const RunSummary& s) {
  OutcomeFigures out;
  out.end = end_of(s);
  out.by_user = s.by_user;
  out.bone_moves = s.bone_moves;
  out.spins = drills(s);
  out.latched_faults = s.latched_faults.size();
  out.reached_mm = s.reached_mm;
  out.thickness_mm = s.thickness_mm;
  out.passed = s.passed_s.has_value();
  out.axis_removed = s.removed_at_passing.value_or(0.0);
  out.axis_clear = s.breakthrough_s.has_value();
  out.axis_open = s.open_axis;
  out.brought_back = s.brought_back;
  out.cleared_share = s.cleared_share;
  out.uncut_share = s.uncut_share;
  out.section_mm2 = s.section_mm2;
  out.section_radius_mm = s.section_radius_mm;
  out.section_on_axis = s.section_on_axis;
  out.removed_mass_mm3 = s.removed_mass_mm3;
  out.aside_mm = s.aside_mm;
  out.plunge_mm = s.plunge_mm;
  out.ahead_mm = s.largest_ahead_mm;
  out.voxel_mm = s.spacing_mm;
  if (s.live) out.steps = s.live->steps;
  out.contact_degraded = s.contact_degraded;
  out.contact_evaluations = s.contact_evaluations;
  return out;
}

/// @returns the sentence of a run that drilled through.
std::string through_text(const RunSummary& s) {
  if (s.open_axis) return fmt::format("The hole was there before the run, which removed {:.1f} mm3 of bone round it.", s.removed_mass_mm3);
  return exit_sentence({s.breakthrough_s, s.tip_out_s, s.support_lost_s, s.plunge_mm}) + ".";
}

std::string short_text(const RunSummary& s) {
  if (s.open_axis)
    return fmt::format("No bone was on the axis at the start: it was drilled through before. This run removed {:.1f} mm3 of bone.",
                       s.removed_mass_mm3);
  const std::string open = s.breakthrough_s ? fmt::format(": the axis is clear of bone, but only {:.0f} % of the bit's cross-section",
                                                          100.0 * s.cleared_share.value_or(0.0))
                                            : std::string();
  switch (end_of(s)) {
    case DrillEnd::user:
      return "The user ended the run, " + how_far(s) + "; the bone was not drilled through" + open + ".";
    case DrillEnd::feed:
      return "The feed reached its stop, " + how_far(s) + open + ".";
    case DrillEnd::script:
      return "The hand detected a breakthrough and withdrew, " + how_far(s) + "; the bone was not drilled through" + open + ".";
    case DrillEnd::time:
    case DrillEnd::stopped:
      break;
  }
  return fmt::format("The time of the scene ended, {}{}.{}", how_far(s), open, s.spin_rpm == 0.0 ? " The bit does not spin." : "");
}

}  // namespace

RunOutcome outcome_of(const RunSummary& summary) { return judge(figures_of(summary), summary.limits); }

std::string outcome_text(const RunSummary& s) {
  const RunOutcome outcome = outcome_of(s);
  switch (outcome.result) {
    case DrillResult::faulted:
      return "A latched servo fault ended the force on the hand: " + s.latched_faults.front() + ".";
    case DrillResult::carved:
      return fmt::format("The bone was carved: {}.", outcome.reason);
    case DrillResult::skated_off:
      return fmt::format("The bit skated off: {}. This is not a burrhole at the entry.", outcome.reason);
    case DrillResult::passed_uncut:
      return fmt::format(
          "The bit passed the bone after {:.2f} s without cutting it: {}. The contact model failed to hold it; this is not a burrhole.",
          s.passed_s.value_or(0.0), outcome.reason);
    case DrillResult::drilled_through:
      return through_text(s);
    case DrillResult::interrupted:
      return "The run was interrupted, " + how_far(s) + ".";
    case DrillResult::did_not_cut:
    case DrillResult::stopped_short:
      return short_text(s);
  }
  return {};
}

std::string progress_text(double time, double depth) {
  const double mm = std::abs(depth) / kMillimetre;
  return depth < 0.0 ? fmt::format("{:5.1f} s  tip {:.2f} mm above bone", time, mm) : fmt::format("{:5.1f} s  depth {:6.2f} mm", time, mm);
}

std::string result_line(const RunSummary& summary) {
  const RunOutcome outcome = outcome_of(summary);
  const std::vector<std::string> flags = flag_names(outcome.flags);
  const std::string line = fmt::format("result: {}: {}", name_of(outcome.result), outcome.reason);
  return flags.empty() ? line : fmt::format("{}; flags: {}", line, fmt::join(flags, ", "));
}

std::optional<std::string> unfinished_warning(const RunSummary& s) {
  const bool through = s.breakthrough_s || s.passed_s, stop_reached = s.bench && s.end == "done";
  if (!drills(s) || s.end == "stopped" || through || stop_reached || s.by_user || s.bone_moves) return std::nullopt;
  const bool detected = s.end == "done";
  const char* const what = detected ? "it detected a breakthrough" : s.bench ? "its stop was not reached" : "the time ended";
  const char* const next = detected ? "hand.kind = \"feed\" drills on, to hand.stop_mm" : "raise duration_s";
  return fmt::format("hand: {} {:.2f} mm deep in {:.2f} mm of bone, which is not drilled through: {}", what, s.reached_mm, s.thickness_mm,
                     next);
}

std::vector<std::string> outcome_warnings(const RunSummary& s) {
  std::vector<std::string> out;
  const RunOutcome outcome = outcome_of(s);
  if (s.live)
    for (const MissedSteps& clock : s.live->steps)
      if (clock.share() > s.limits.missed_share)
        out.push_back(
            fmt::format("live: {} of {} steps of the {} clock were missed ({:.1f} %): times of this run are wrong by about as much",
                        clock.missed, clock.all, clock.clock, 100.0 * clock.share()));
  if (s.live && s.live->unrecorded > 0)
    out.push_back(fmt::format(
        "live: {} rows of the session were not recorded, since the log was full: this run cannot be replayed; end other programs, or lower "
        "servo_hz",
        s.live->unrecorded));
  if ((outcome.flags & kFlagContactDegraded) != 0)
    out.push_back(fmt::format("[contact] {} of {} evaluations were degraded: {}", s.contact_degraded, s.contact_evaluations,
                              fmt::join(contact_flag_texts(s.contact_flags), "; ")));
  if ((outcome.flags & kFlagPlunged) != 0)
    out.push_back(fmt::format("the tip plunged {:.2f} mm, more than [outcome] plunge_limit_mm = {:g}", *s.plunge_mm, s.limits.plunge_mm));
  if (outcome.result == DrillResult::drilled_through || s.open_axis) return out;
  if (auto unfinished = unfinished_warning(s)) {
    out.push_back(std::move(*unfinished));
    return out;
  }
  const bool failed = outcome.result == DrillResult::skated_off || outcome.result == DrillResult::passed_uncut;
  const bool is_short = outcome.result == DrillResult::stopped_short || outcome.result == DrillResult::did_not_cut;
  const bool intended = !drills(s) || s.by_user || (s.bench && s.end == "done");
  if (failed || (is_short && !intended)) out.push_back(fmt::format("{}: {}", name_of(outcome.result), outcome.reason));
  return out;
}

}  // namespace burrhole
