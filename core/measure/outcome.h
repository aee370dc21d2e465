/// core/measure/outcome.h: the result of a run, its reason and its flags, from measured figures.
///   The first result below whose criterion holds is the result of the run. Results that nothing later can take back come first; an
///   interruption comes before those that a longer run could have changed. docs/outcome.md is generated from the same table.
///     1 faulted          a servo fault was latched: from then on the force on the hand was zero
///     2 carved           the bone was moved during the run ([motion]), which was not interrupted and did cut; what follows asks for a burrhole
///     3 skated-off       in contact and before the tip passed the bone, the tip was farther from the axis than the bit's radius and than
///                        1 mm; not for a hand that a user moves
///     4 passed-uncut     the tip passed the bone, and more than half of the columns that the bit passed are not clear of bone; without
///                        columns: less than half of the bone on the axis was removed when the tip passed it; not for a hand that a user moves
///     5 drilled-through  at least half of the bit's cross-section is clear
///     6 interrupted      a signal or a user ended the run
///     7 did-not-cut      the removed bone, spread over the bit's cross-section, is less than 0.1 mm deep
///     8 stopped-short    any other run
///   Columns and cross-section: core/measure/cross_section.h. Flags are independent of each other.
///   Units  in the names of the members.   Frame  none.   Errors  none.   Thread  any; a pure function.   Source  own definition.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/measure/outcome_limits.h"

namespace burrhole {

/// In order of precedence.
enum class DrillResult : std::uint8_t {
  faulted,
  carved,
  skated_off,
  passed_uncut,
  drilled_through,
  interrupted,
  did_not_cut,
  stopped_short
};
inline constexpr std::size_t kDrillResults = 8;

/// Bits of RunOutcome::flags.
enum OutcomeFlag : std::uint32_t {
  kFlagPlunged = 1u << 0,          ///< the plunge exceeds its limit
  kFlagShelfLeft = 1u << 1,        ///< drilled through, and less than nine tenths of the cross-section is clear
  kFlagCoreLeft = 1u << 2,         ///< drilled through, and bone is left on the axis
  kFlagTunnelled = 1u << 3,        ///< the tip was more than a voxel ahead of the cutting front and the engagement
  kFlagBroughtBack = 1u << 4,      ///< an undo, a reset or a restore took a breakthrough back
  kFlagMissedSteps = 1u << 5,      ///< more than 1 % of the steps of a clock were missed
  kFlagContactDegraded = 1u << 6,  ///< more than 1 % of the evaluations of contact were degraded
};
inline constexpr std::size_t kOutcomeFlags = 7;

/// Steps of one clock of a live run.
struct MissedSteps {
  std::string clock;
  std::uint64_t missed = 0, all = 0;  ///< all includes the missed ones
  [[nodiscard]] double share() const noexcept { return all > 0 ? static_cast<double>(missed) / static_cast<double>(all) : 0.0; }  ///< [-]
};

/// How a run came to its end.
enum class DrillEnd : std::uint8_t {
  script,   ///< the hand withdrew
  feed,     ///< the feed of a bench reached its stop
  user,     ///< a user ended the run
  time,     ///< the time of the scene ended
  stopped,  ///< a signal, or a user in a demonstration
};

/// What is measured on a run. A figure that does not apply is absent.
struct OutcomeFigures {
  DrillEnd end = DrillEnd::time;
  bool by_user = false;     ///< a user moved the hand
  bool bone_moves = false;  ///< the bone was moved: there is no axis of a burrhole
  bool spins = true;        ///< the spindle turned and the scene removes bone
  std::uint64_t latched_faults = 0;
  double reached_mm = 0.0;                           ///< greatest depth of the tip
  double thickness_mm = 0.0;                         ///< of bone on the axis
  bool passed = false;                               ///< the tip was deeper than all bone on the axis
  double axis_removed = 0.0;                         ///< [-] share of the bone on the axis that was removed when the tip passed it
  bool axis_clear = false;                           ///< breakthrough: no bone is left on the axis
  bool axis_open = false;                            ///< no bone was on the axis at the start: it was drilled before
  bool brought_back = false;                         ///< a breakthrough was taken back by an undo, a reset or a restore
  std::optional<double> cleared_share, uncut_share;  ///< [-] SectionMeasure
  double section_mm2 = 0.0;                          ///< [mm^2] area of the cross-section; 0: unknown
  double section_radius_mm = 0.0;
  bool section_on_axis = true;  ///< CrossSection::on_axis
  double removed_mass_mm3 = 0.0;
  double aside_mm = 0.0;  ///< DrillProgress::largest_aside
  std::optional<double> plunge_mm;
  std::optional<double> ahead_mm;                               ///< DrillProgress::largest_ahead
  double voxel_mm = 0.0;                                        ///< edge of a voxel
  std::vector<MissedSteps> steps;                               ///< of a live run
  std::uint64_t contact_degraded = 0, contact_evaluations = 0;  ///< evaluations with a bit of ContactFlag, and all
};

struct RunOutcome {
  DrillResult result = DrillResult::stopped_short;
  std::string reason;       ///< the criterion with its numbers, one sentence without a full stop
  std::uint32_t flags = 0;  ///< bits of OutcomeFlag
};

[[nodiscard]] RunOutcome judge(const OutcomeFigures& figures, const OutcomeLimits& limits);

/// @returns the word of a result or flag, as in summary.json: "drilled-through".
[[nodiscard]] const char* name_of(DrillResult result) noexcept;
[[nodiscard]] const char* name_of(OutcomeFlag flag) noexcept;
/// @returns the result of that word; nothing if there is none.
[[nodiscard]] std::optional<DrillResult> result_named(std::string_view name) noexcept;
/// @returns the words of the flags, in the order of their bits.
[[nodiscard]] std::vector<std::string> flag_names(std::uint32_t flags);
/// @returns one sentence for each bit of ContactFlag.
[[nodiscard]] std::vector<std::string> contact_flag_texts(std::uint32_t flags);

/// A row of the reference.
struct OutcomeRow {
  std::string name, criterion;
};
/// @returns all results in order of precedence, or all flags; criteria with the values of `limits`.
[[nodiscard]] std::vector<OutcomeRow> result_rows(const OutcomeLimits& limits);
[[nodiscard]] std::vector<OutcomeRow> flag_rows(const OutcomeLimits& limits);

}  // namespace burrhole
