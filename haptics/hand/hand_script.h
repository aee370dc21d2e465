/// haptics/hand/hand_script.h: the goal of a surgeon's hand at each servo tick of a burrhole, computed from the felt force and the motion:
///   approach, lean, detect breakthrough, release, lean again or withdraw. A simulated hand, or the hand on a simulated device, follows the goal.
///   The force that bone carries is what the drill exerts on the hand: the felt force without what effects add to it (added_force()). The load is
///   the thrust less that addition.
///   Frame  approach frame: origin at the entry point, +z up the shaft, away from bone; depth = -z.   Units SI.   Thread servo.
///   The thrust rises along the path of least jerk, as a person's does [FlashHogan85]. A linear ramp ends in a kink, which makes a hand on
///   a soft coupling oscillate.
///   Breakthrough is detected while the hand leans on the drill, by any of three rules (docs/inputs.md):
///     Force     The hand is accelerated into bone by more than a third of the force that bone ceases to carry at the exit, exit_drop times
///               the load. While bone carries the load, the hand is hardly accelerated. The force is m dv/dt, low-pass filtered with
///               5 ms; until the thrust is full it must exceed rough_drop too. The rule acts once bone has carried the load for 0.1 s,
///               beginning at least 0.5 s after a change of the drive. With watches_drill the rule is
///               another: the face of bone that carries the drill, at the height of the drill plus force / K_cut, falls by more than half of
///               the engaged depth within about 25 ms. A softer coupling takes force off the hand, and an added force shakes it, but that face
///               stays where it is.
///     No force  Bone has carried less than a tenth of contact_force for 5 ms, and the hand is 0.15 mm deeper than bone ever carried it. The
///               rule acts at any thrust.
///     Feed      The feed over three quarters of the engaged depth, at least 0.15 mm, exceeds `softest` times the usual feed
///               (feed_memory.h). This finds an exit at a thin or oblique rim, where bone ends gradually and no force is missing. The rule
///               acts at full thrust, while the force rule acts. With watches_drill it is the feed of that face, otherwise the hand's.
///   A drill with a clutch ([clutch]) stops when its inner tip has no support. The hand feels that as a breakthrough, without any rule:
///   drill_stopped().
///   A bit that is not much wider than the pores of the diploe falls into them as it falls out of bone, and no rule can distinguish the two. So
///   the script does what a surgeon does: after the release it checks the hole. If bone has carried the falling thrust and is left ahead of the
///   tip, the script leans on the drill again, and the rules start anew. Otherwise it withdraws.
///   Source own work; times and forces are assumptions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/result.h"
#include "haptics/hand/feed_memory.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

struct HandScriptConfig {
  double feed = 0.005;         ///< [m/s] of the approach; the withdrawal is twice as fast
  double push = 28.0;          ///< [N] thrust while leaning on the drill, in world units: not scaled to the range of a device
  double ramp = 1.0;           ///< [s] from first contact to full thrust
  double reaction = 0.150;     ///< [s] from breakthrough detection to the begin of the release (assumed)
  double release = 0.3;        ///< [s] over which the thrust falls to zero after the release begins
  double contact_force = 1.0;  ///< [N] force on the hand that counts as contact
  /// The rules of force and feed follow the drill, not the hand. Needed where the stiffness of the coupling between the two changes, as with
  /// felt hardness: softer bone then takes force off the hand, and lets it advance, while the drill stays on bone; and where effects push the
  /// hand: watch_drill(). Needs cut_compliance and an exit_drop below 1.
  bool watches_drill = false;
  bool detects = true;  ///< false: breakthrough is not detected, and the thrust ends at `reach`
  bool resumes = true;  ///< false: after the release the script withdraws, whatever is left ahead of the tip
  /// [-] in (0, 1]: force rule, least share of the thrust that bone ceases to carry when the bit loses all bone in which it is engaged.
  /// K / (K + K_cut) if the next face of the bit then engages, K the stiffness of the coupling from hand to tool; 1 if this is unknown.
  double exit_drop = 1.0;
  /// [N] force rule: until the thrust is full, smaller drops of the force do not count. A point of the bit may then rest on single voxels,
  /// and the force falls where one breaks away. 0: no such limit.
  double rough_drop = 0.0;
  /// [-] feed rule: largest feed in bone over the usual feed, that in the hardest layer so far; faster means no bone. Feed is inversely
  /// proportional to hardness, so bone softer than 1 / softest of the hardest layer counts as none.
  double softest = 4.0;
  double cut_compliance = 0.0;      ///< [m/N] 1 / K_cut: engaged depth of the bit over the thrust; 0: unknown, there is no feed rule
  double reach = 0.08;              ///< [m] depth of the hand below the entry at which the thrust is released without breakthrough
  double follow_time = 0.25;        ///< [s] time constant with which the rest position of the arm follows the drill while leaning
  double standoff = 0.003;          ///< [m] height above the entry where the script starts and ends
  double tremor_amplitude = 40e-6;  ///< [m] peak amplitude of the rest position along x and along y
  double tremor_frequency = 9.0;    ///< [Hz] along x; 1.13 times this along y
  std::uint64_t seed = 1;           ///< of the phases of the tremor
};

/// The goal of the arm for one tick.
struct HandGoal {
  Vec3 rest{0.0};       ///< [m] rest point of the arm's spring
  double thrust = 0.0;  ///< [N] along -z, in addition to the force of that spring
};

class HandScript {
 public:
  /// Errors: out_of_range when a value is not finite or negative, when follow_time, exit_drop, mass or period is not above 0, when exit_drop is
  /// above 1, or when watches_drill lacks what it needs. @param mass [kg] that the thrust accelerates when no bone carries it. @param period [s]
  /// of a tick.
  [[nodiscard]] static Result<HandScript> create(const HandScriptConfig& config, double mass, double period);

  /// Advances one tick. @param felt [N] force on the hand along +z. @param height [m] z of the hand. @param climb [m/s] its z velocity.
  const HandGoal& advance(double felt, double height, double climb) noexcept BH_REALTIME;
  /// To be called when the speed of the drive changes: the bit then engages or disengages by F / K_cut, which is no breakthrough. Pauses
  /// the force rule and the feed rule for 0.5 s, and until bone has then carried the thrust for 0.1 s; the feed rule forgets its windows.
  /// The rule "no force" goes on.
  void drive_changed() noexcept {
    drive_tick_ = tick_;
    steady_ticks_ = 0;
    held_ = false;
    feed_.clear();
  }
  /// To be called when the clutch of the drill has released. While the hand leans on the drill and detects, this is a breakthrough.
  void drill_stopped() noexcept { stopped_ = phase_ == HandPhase::lean && config_.detects; }
  /// To be called when another tool is held or bone has come back: as drive_changed(), and all rules compare with what the hand feels from now
  /// on. @param softest as in HandScriptConfig, of the present tool; a value that is negative or not finite is ignored.
  void scene_changed(double softest) noexcept;
  /// As HandSource::bone_ahead(). Without a call no bone is left ahead.
  void bone_ahead(bool left) noexcept { ahead_ = left; }
  /// To be called before each advance() where watches_drill is set. @param height [m] z of the drill. Values that are not finite are ignored.
  void drill_at(double height) noexcept {
    if (std::isfinite(height)) drill_ = height;
  }
  /// As HandSource::watch_drill(): sets watches_drill where the script knows what that needs.
  void watch_drill() noexcept;
  /// As HandSource::added_force(), for the next advance() alone. @param force [N] along +z, contained in its `felt`; ignored if not finite.
  void added_force(double force) noexcept {
    if (std::isfinite(force)) added_ = force;
  }
  [[nodiscard]] HandPhase phase() const noexcept { return phase_; }
  /// Number of ticks since creation.
  [[nodiscard]] std::uint64_t tick() const noexcept { return tick_; }

 private:
  HandScript(const HandScriptConfig& config, double mass, double period);
  // In these, carried is the force that bone carries [N].
  void follow(double carried, double height, double climb) noexcept;
  void lean(double carried, double height, double climb) noexcept;
  void release(double carried, double height) noexcept;
  [[nodiscard]] bool loses_bone(double carried) noexcept;
  [[nodiscard]] bool feels_nothing(double carried, double height, double climb) noexcept;
  void watch_face(double carried) noexcept;
  /// @returns the force [N] that bone carries while the hand is at rest. What effects add may be more than the thrust: then it is at least
  /// what counts as contact, so that no rule acts on rounding.
  [[nodiscard]] double load() const noexcept {
    return added_ == 0.0 ? goal_.thrust : std::max(std::min(goal_.thrust, config_.contact_force), goal_.thrust - added_);
  }
  [[nodiscard]] bool face_falls(double rough) const noexcept;
  [[nodiscard]] bool runs_ahead(double height) noexcept;
  [[nodiscard]] Vec3 tremor() const noexcept;
  [[nodiscard]] double seconds_since(std::uint64_t since) const noexcept { return static_cast<double>(tick_ - since) * period_; }

  HandScriptConfig config_;
  double mass_;
  double period_;
  HandPhase phase_ = HandPhase::approach;
  double goal_height_ = 0.0;  // [m] rest position of the arm along the axis
  double speed_ = 0.0;        // [m/s] of the hand into bone, low-pass filtered with 5 ms
  double lacks_ = 0.0;        // [N] force that accelerates the hand into bone: mass x change of speed_
  double added_ = 0.0;        // [N] of the felt force, by effects
  bool pushed_ = false;       // effects push the hand: that it is accelerated says nothing of bone
  double smooth_ = 0.0;       // [m] height, low-pass filtered with 25 ms
  double drill_ = 0.0;        // [m] height of the drill
  double face_ = 0.0;         // [m] height of the drill less its engagement: where the bone that carries it begins
  double face_before_ = 0.0;  // [m] face_, low-pass filtered with 25 ms
  double lowest_ = 0.0;       // [m] height, the lowest at which bone was felt or the hand did not advance
  FeedMemory feed_;
  bool held_ = false;               // bone carries the thrust: the rules of force and feed act
  std::uint64_t steady_ticks_ = 0;  // number of ticks for which the hand has not been accelerated
  std::uint64_t drive_tick_ = 0;    // of the last change of the drive
  bool ahead_ = false;              // bone is left ahead of the tip
  bool gave_ = false;               // the release follows a breakthrough detection
  bool carried_ = false;            // during the release bone carries the thrust
  bool stopped_ = false;            // the clutch has released since the hand leans on the drill
  bool starts_anew_ = false;        // the depth at which bone was felt does not count any more
  std::uint64_t tick_ = 0, lean_tick_ = 0, lowest_tick_ = 0, give_tick_ = 0, release_tick_ = 0;
  double release_thrust_ = 0.0;  // [N] at the start of the release
  HandGoal goal_;
};

}  // namespace burrhole
