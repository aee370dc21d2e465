/// haptics/hand/hand_script.h: the goal of a surgeon at each tick of a burrhole, computed from the measured force and motion: approach,
///   lean, detect breakthrough, release, withdraw. A simulated hand, or the hand on a simulated device, carries the goal out.
///   Frame  approach frame: origin at the entry point, +z up the shaft, away from bone; depth = -z.   Units SI.   Thread servo.
///   Breakthrough: bone carries the thrust at any feed, so the hand is hardly accelerated. Where the bit leaves bone, the hand lacks at
///   least exit_drop of that force. The hand detects breakthrough when the force that accelerates it exceeds a third of that (docs/inputs.md).
///   Where nothing is felt deeper than bone ever was, there is none left: also right after first contact, before anything else is known.
///   While the thrust rises, a bit rests on few voxels, and a drop of the size of one is no breakthrough either.
///   The thrust rises with the least jerk, as a person's does [FlashHogan85]: a ramp with a kink at its end lets a soft coupling swing.
///   Where the bit leaves bone gradually, at a thin or oblique rim, no force is missing: there the hand detects an advance over three
///   quarters of the engaged depth at over `softest` times the feed of the densest layer so far.
///   Source own work; times and forces are assumptions.
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/feed_memory.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

struct HandScriptConfig {
  double feed = 0.005;         ///< [m/s] approach and withdrawal
  double push = 28.0;          ///< [N] thrust while leaning on the drill; a real force, not limited to a device's range
  double ramp = 1.0;           ///< [s] from first contact to full thrust
  double reaction = 0.150;     ///< [s] from breakthrough detection to release (assumed)
  double release = 0.3;        ///< [s] over which the thrust falls to zero after the release begins
  double contact_force = 1.0;  ///< [N] force on the hand that counts as contact
  bool detects = true;         ///< false: breakthrough is not detected, and the thrust ends at the reach
  /// [-] in (0, 1]: share of the thrust that bone ceases to carry, at least, when the bit loses all bone in which it is engaged:
  /// K / (K + K_cut) for a drill on a coupling K whose next face then engages, 1 if that is unknown.
  double exit_drop = 1.0;
  double rough_drop = 0.0;          ///< [N] of thrust, by which force falls where single voxels break away under a point; 0: unknown
  double softest = 4.0;             ///< [-] feed in the softest bone, over that in the densest layer so far; a faster one is no bone
  double cut_compliance = 0.0;      ///< [m/N] engaged depth of the bit over the thrust, 1 / K_cut; 0: unknown, no rule of feed
  double reach = 0.08;              ///< [m] below the entry, at which the arm ends: the thrust is released
  double follow_time = 0.25;        ///< [s] time constant with which the rest position of the arm follows the drill while leaning
  double standoff = 0.003;          ///< [m] height above the entry where the script starts and ends
  double tremor_amplitude = 40e-6;  ///< [m] lateral peak amplitude of the rest position
  double tremor_frequency = 9.0;    ///< [Hz]
  std::uint64_t seed = 1;
};

/// The goal of the arm for one tick.
struct HandGoal {
  Vec3 rest{0.0};       ///< [m] rest point of the arm's spring
  double thrust = 0.0;  ///< [N] along -z, in addition to that spring
};

class HandScript {
 public:
  /// Errors: out_of_range when a value is not finite or negative, or when follow_time, exit_drop, mass or period is not above 0, or
  /// exit_drop is above 1. @param mass [kg] that the thrust accelerates when no bone carries it.
  [[nodiscard]] static Result<HandScript> create(const HandScriptConfig& config, double mass, double period);

  /// Advances one tick. @param felt [N] force on the hand along +z. @param height, climb [m], [m/s] of the hand along z, now.
  const HandGoal& advance(double felt, double height, double climb) noexcept BH_REALTIME;
  /// The bit engages or disengages by F / K_cut: no breakthrough is detected until that is over.
  void drive_changed() noexcept {
    drive_tick_ = tick_;
    steady_ticks_ = 0;
    held_ = false;
    feed_.clear();
  }
  [[nodiscard]] HandPhase phase() const noexcept { return phase_; }
  /// Number of ticks since creation.
  [[nodiscard]] std::uint64_t tick() const noexcept { return tick_; }

 private:
  HandScript(const HandScriptConfig& config, double mass, double period);
  void follow(double felt, double height, double climb) noexcept;
  void lean(double felt, double height, double climb) noexcept;
  [[nodiscard]] bool loses_bone(double felt) noexcept;
  [[nodiscard]] bool feels_nothing(double felt, double height, double climb) noexcept;
  [[nodiscard]] bool runs_ahead(double height) noexcept;
  [[nodiscard]] Vec3 tremor() const noexcept;
  [[nodiscard]] double seconds_since(std::uint64_t since) const noexcept { return static_cast<double>(tick_ - since) * period_; }

  HandScriptConfig config_;
  double mass_;
  double period_;
  HandPhase phase_ = HandPhase::approach;
  double goal_height_ = 0.0;  // [m] rest position of the arm along the axis
  double speed_ = 0.0;        // [m/s] into bone, low-pass filtered
  double lacks_ = 0.0;        // [N] force that accelerates the hand into bone, filtered alike
  double smooth_ = 0.0;       // [m] height, low-pass filtered
  double lowest_ = 0.0;       // [m] height, the lowest at which bone was felt or the hand did not advance
  FeedMemory feed_;
  bool held_ = false;               // bone carries the thrust
  std::uint64_t steady_ticks_ = 0;  // for so long the hand has not been accelerated
  std::uint64_t drive_tick_ = 0;    // of the last change
  std::uint64_t tick_ = 0, lean_tick_ = 0, lowest_tick_ = 0, give_tick_ = 0, release_tick_ = 0;
  double release_thrust_ = 0.0;  // [N] at the start of the release
  HandGoal goal_;
};

}  // namespace burrhole
