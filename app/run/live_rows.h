/// app/run/live_rows.h: inputs and results of each step of a run, sent from its thread to the log, and written as rows of the session's
/// three streams. All schedules record the same columns. A replay uses them to repeat the order of steps (live_replay.h).
///   Frame  world.   Units  SI, times of computation in microseconds.   Errors  none.
#pragma once

#include <array>
#include <vector>

#include "app/session/session.h"
#include "app/stage/stage.h"
#include "core/measure/drill_monitor.h"
#include "haptics/servo/servo_step.h"

namespace burrhole {

/// Values that effects record in a tick of their clock.
struct EffectValues {
  static constexpr std::size_t kMax = StepGraph::kMaxColumns;
  std::array<double, kMax> values{};  ///< [unit of the column]
  std::uint32_t count = 0;
};
[[nodiscard]] EffectValues effect_values(const StepGraph& graph, Clock clock) noexcept;

struct ServoRow {
  HandState hand;             ///< as used by the servo: an invalid state of the source is replaced and flagged
  Vec3 force{0.0};            ///< [N] on the hand
  std::uint64_t contact = 0;  ///< number of the contact result used for the force
  std::uint32_t faults = 0;
  std::uint32_t skipped = 0;  ///< ticks missed before this one
  EffectValues effects;
  float compute_us = 0.0f, late_us = 0.0f;
};

struct ContactRow {
  std::uint64_t number = 0;  ///< of the evaluation
  std::uint64_t hand_tick = 0;
  std::uint64_t window = 0;  ///< number of the copy of bone used
  double time = 0.0;         ///< [s] of the hand motion used
  Pose world_from_tool, world_from_rest;
  std::uint32_t skipped = 0;
  EffectValues effects;
  DrillProgress progress;
  float compute_us = 0.0f, step_us = 0.0f, late_us = 0.0f;
};

struct BoneRow {
  std::uint64_t contact = 0;    ///< number of the contact result used for the cut
  std::uint64_t published = 0;  ///< number of copies of bone published, including that of this step
  std::uint32_t skipped = 0;
  EffectValues effects;
  double removed = 0.0;  ///< [m^3] BoneStep::removed_mass()
  float compute_us = 0.0f;
};

/// @returns the row of the last call of each step, without times and missed ticks.
[[nodiscard]] ServoRow servo_row(const Stage& stage, const ServoOutput& servo) noexcept;
[[nodiscard]] ContactRow contact_row(const Stage& stage, std::uint64_t window) noexcept;
/// @param contact number of the contact result used for the cut.
[[nodiscard]] BoneRow bone_row(Stage& stage, std::uint64_t contact) noexcept;

/// Layout of the session: streams "servo", "contact" and "bone", each with the columns of effects on its clock last; then "audio" in a run
/// with sound, whose row has the number of the message that a block of sound read from each other clock. Indices of the streams:
inline constexpr std::size_t kServoRows = 0, kContactRows = 1, kBoneRows = 2, kAudioRows = 3;
[[nodiscard]] SessionLayout session_layout(const Stage& stage);
/// Writes a row of a stream of that layout into `out`.
void put(const ServoRow& row, const Stage& stage, std::vector<double>& out);
void put(const ContactRow& row, const Stage& stage, std::vector<double>& out);
void put(const BoneRow& row, const Stage& stage, std::vector<double>& out);
/// @returns whether the layout has the stream "audio".
[[nodiscard]] bool records_audio(const Stage& stage) noexcept;
/// Writes the row of the last block of sound.
void put_audio(const Stage& stage, std::vector<double>& out);

}  // namespace burrhole
