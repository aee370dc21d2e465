/// app/lab/drilling_trial.h: one drilled hole of the drilling studies: scene text -> load_scene -> Simulation in lockstep, as `burrhole
///   drill` runs it, and the figures of the run. A scene says nothing about a key that a trial does not set, so it takes the default.
///   Units  SI here; figures as their names say.   Errors  those of scene and tool; bad_input for an unknown bit.
///   Thread one per trial; trials share nothing.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/job/summary.h"
#include "app/lab/drilling_bits.h"

namespace burrhole {

enum class DrillingBone {
  plate,  ///< between two planes across the axis
  edge,   ///< a block, drilled half a radius of the bit inside one of its edges
  patch   ///< skull: two tables and diploe, curved
};
[[nodiscard]] const char* name_of(DrillingBone bone) noexcept;

enum class DrillingHand {
  script,  ///< the default hand, which detects breakthrough and withdraws
  bench    ///< the default thrust on a carriage, without tremor, until the widest part of the bit has passed the bone
};

struct DrillingTrial {
  std::string bit;                                   ///< name in drilling_bits(), or of `own`
  std::shared_ptr<const DrillingBit> own = nullptr;  ///< a bit that is not in that list; null: one that is
  DrillingBone bone = DrillingBone::plate;
  DrillingHand hand = DrillingHand::script;
  std::vector<std::string> sets{};       ///< "table.key=value" of the scene, as --set takes them
  std::vector<std::string> tool_sets{};  ///< the same for the tool file
  friend bool operator==(const DrillingTrial&, const DrillingTrial&) = default;
};

/// NaN in figures that do not apply.
struct DrillingResult {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RunSummary summary;
  double volume_mm3 = kNone;         ///< closed form of a hole that the bit has passed
  double drilled_s = kNone;          ///< from first contact to breakthrough; of a crown, which leaves its core, until its teeth have passed
  double plunge_mm = kNone;          ///< SupportLoss::plunge
  double feed_mm_s = kNone;          ///< mean between 2/5 of the bone and its inner table or last tenth
  double ripple_percent = kNone;     ///< (p95 - p5) / mean of the feed there, over windows of 0.2 s
  double roughness_um = kNone;       ///< Rq of the wall (drilling_wall.h) of a hole that the bit has passed
  double cpu_s = 0.0, wall_s = 0.0;  ///< of the run, without loading and measuring
  double median_us = 0.0;            ///< CPU time of 100 ms of simulated time
  double p99_us = 0.0;               ///< the same
};

/// @returns the bit of a trial; null if there is none of that name.
[[nodiscard]] const DrillingBit* bit_of(const DrillingTrial& trial);
/// @returns the scene's text. @pre the trial has a bit.
[[nodiscard]] std::string drilling_scene(const DrillingTrial& trial);
/// Loads a trial without running it: the defaults that its scene takes. @param tool_folder of the shipped tools.
[[nodiscard]] Result<LoadedScene> load_drilling(const DrillingTrial& trial, const std::string& tool_folder);
[[nodiscard]] Result<DrillingResult> run_drilling(const DrillingTrial& trial, const std::string& tool_folder);

struct DrillingRuns {
  std::string tool_folder;  ///< of the shipped tools
  unsigned threads = 0;     ///< trials that run in parallel; 0: one per core
  std::string partial{};    ///< file of results that are kept while trials run, and used by the next call; empty: none
  std::function<void(double, const std::string&)> progress{};  ///< share done 0..1 and the last trial; one call at a time; may be empty
  std::function<void(const std::string&)> say{};               ///< receives one line on results of an earlier call; may be empty
};
/// Runs each trial once, equal ones together. @returns the results in the order of the trials, the same for any number of threads except for
/// times; the first error otherwise.
[[nodiscard]] Result<std::vector<DrillingResult>> run_drillings(const std::vector<DrillingTrial>& trials, const DrillingRuns& runs);

}  // namespace burrhole
