/// app/engine/live_rows.h: what each step of a live run took and gave, as plain values from its thread to the log, and as rows of the
/// session. With these the same steps can be fed again in the same order (live_replay.h).
#pragma once

#include <array>
#include <vector>

#include "app/engine/drill_monitor.h"
#include "app/engine/session.h"
#include "core/contact/contact_state.h"
#include "haptics/servo/servo_step.h"

namespace burrhole {

struct ServoRow {
  HandState hand;             ///< as the servo took it: where it was told wrong, mended and flagged
  Vec3 force{0.0};            ///< [N] on the hand
  std::uint64_t contact = 0;  ///< number of the result that the force was made from
  std::uint32_t faults = 0;
  std::uint32_t skipped = 0;  ///< ticks that were slept through before this one
  float compute_us = 0.0f, late_us = 0.0f;
};

struct ContactRow {
  std::uint64_t number = 0;  ///< of the evaluation
  std::uint64_t hand_tick = 0;
  std::uint64_t window = 0;  ///< number of the copy of bone that was read
  double time = 0.0;         ///< [s] of the motion that was answered
  Pose world_from_tool;
  Wrench on_hand;
  double engagement = 0.0;
  std::uint32_t flags = 0, skipped = 0;
  DrillProgress progress;
  float compute_us = 0.0f, step_us = 0.0f, late_us = 0.0f;
};

struct BoneRow {
  std::uint64_t contact = 0;    ///< number of the result that it cut by
  std::uint64_t published = 0;  ///< copies of bone handed over, this step's included
  double removed_mass = 0.0;    ///< [m^3] so far
  double spin = 0.0;            ///< [rev/s]
  std::uint32_t skipped = 0;
  float compute_us = 0.0f;
};

inline constexpr std::size_t kHandColumns = 14;
[[nodiscard]] std::vector<SessionColumn> hand_columns();
[[nodiscard]] std::array<double, kHandColumns> hand_values(const HandState& hand) noexcept;

/// The tool as contact found it: place, wrench on the hand, engagement, flags.
[[nodiscard]] std::vector<SessionColumn> tool_columns();
/// Of a live session: the ticks' columns, and its streams "contact" and "bone".
[[nodiscard]] std::vector<SessionColumn> servo_columns();
[[nodiscard]] std::vector<SessionStream> live_streams();
inline constexpr std::size_t kContactStream = 0, kBoneStream = 1;
void put(const ServoRow& row, std::vector<double>& out);
void put(const ContactRow& row, std::vector<double>& out);
void put(const BoneRow& row, std::vector<double>& out);

}  // namespace burrhole
