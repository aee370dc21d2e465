/// haptics/servo/multi_rate.h: the force at the servo's rate out of contact states that come more slowly.
///   Frame  world.   Units SI.   Thread servo; one owner; cost bounded by kMaxLocalPlanes and HoldSolver's bound.
///   hold      the latest force, until the next.
///   linear    a straight line from the force shown to the latest, over one contact period: smooth, and another period late.
///   gradient  [AcostaLiu07] eq. (3), F = f + grad f . (x - x_sample), as the sum of what each plane carries, clamped to pushing.
///   planes    the local model: all listed planes, also those not yet touched. Penalty: the same sum over them. Coupled: a tool of its own
///             at the servo's rate (local_tool.h).
///   Where a state lists no planes, the last two take its force_gradient and forbid a pull along the sampled force.
///   Source  the clamps, the bound and `planes` are own derivations; what each does to the largest stable stiffness is in docs/servo.md.
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/contact/contact_state.h"
#include "haptics/hand/hand_source.h"
#include "haptics/servo/local_tool.h"
#include "haptics/servo/plane_loads.h"

namespace burrhole {

enum class MultiRateScheme : std::uint32_t { hold, linear, gradient, planes };
[[nodiscard]] const char* name_of(MultiRateScheme scheme) noexcept;
/// Whether a scheme asks for the planes of a contact state.
[[nodiscard]] constexpr bool uses_planes(MultiRateScheme scheme) noexcept {
  return scheme == MultiRateScheme::gradient || scheme == MultiRateScheme::planes;
}

struct MultiRateConfig {
  MultiRateScheme scheme = MultiRateScheme::hold;
  int contact_ticks = 1;  ///< >= 1: servo ticks in a contact period
  /// [m] > 0 from the sample within which the last two schemes follow the hand; beyond, as at its edge. Wide: half of what a quick hand of
  /// 0.4 m/s goes in 50 ms. A tighter bound makes the wall a constant force where the hand outruns it, which throws it back: at 20 Hz and
  /// 2 mm a body that falls on bone never came to rest.
  double max_distance = 10.0e-3;
};

class MultiRate {
 public:
  explicit MultiRate(const MultiRateConfig& config) noexcept : config_(config) {}

  /// Once a servo tick of dt [s]. @returns what the drill exerts on the hand now: force [N], torque [N m] about the tool origin. Until the
  /// first evaluation (number 0) it is what the state says.
  [[nodiscard]] Wrench operator()(const ContactState& latest, const HandState& hand, double dt) noexcept BH_REALTIME;
  /// Forgets all states seen.
  void clear() noexcept BH_REALTIME;

 private:
  [[nodiscard]] Wrench between(const Wrench& latest, bool renewed) noexcept;
  [[nodiscard]] Wrench extrapolate(const ContactState& latest, const HandState& hand, bool renewed, double dt) noexcept;
  [[nodiscard]] Wrench pressed_on(const ContactState& latest, const Pose& hand, const Vec3& velocity, bool renewed, double dt) noexcept;

  MultiRateConfig config_;
  std::uint64_t number_ = 0;  // of the state taken last
  int ticks_ = 0;             // since it came
  Wrench from_, shown_;       // linear
  PlaneLoads loads_;
  LocalTool tool_;
};

}  // namespace burrhole
