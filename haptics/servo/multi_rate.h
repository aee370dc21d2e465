/// haptics/servo/multi_rate.h: computes the force at the servo's rate from contact states that arrive at a lower rate.
///   Frame  world.   Units SI.   Thread servo; one owner; cost bounded by kMaxLocalPlanes and HoldSolver's bound.
///   hold      the latest force, until the next state.
///   linear    linear interpolation from the current output to the latest force over one contact period: smooth, but one period of extra
///             latency.
///   gradient  [AcostaLiu07] eq. (3), F = f + grad f . (x - x_sample), evaluated per plane; each plane only pushes.
///   planes    the local model of all listed planes, also those without load. Penalty: the same sum over all planes. Coupled: a tool of its
///             own at the servo's rate (local_tool.h). With a tangential law it takes the place of the tool of each new result, at the
///             tick of that result (tool_trail.h).
///   Where a state lists no planes, the last two schemes use its force_gradient and remove any component opposite to the sampled force.
///   Source  the clamps, the bound and `planes` are own derivations; docs/servo.md lists the maximum stable stiffness of each scheme.
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/contact/contact_state.h"
#include "core/contact/tangential_spring.h"
#include "haptics/hand/hand_source.h"
#include "haptics/servo/local_tool.h"
#include "haptics/servo/plane_loads.h"
#include "haptics/servo/tool_trail.h"

namespace burrhole {

enum class MultiRateScheme : std::uint32_t { hold, linear, gradient, planes };
[[nodiscard]] const char* name_of(MultiRateScheme scheme) noexcept;
/// @returns whether a scheme needs the planes of a contact state.
[[nodiscard]] constexpr bool uses_planes(MultiRateScheme scheme) noexcept {
  return scheme == MultiRateScheme::gradient || scheme == MultiRateScheme::planes;
}

struct MultiRateConfig {
  MultiRateScheme scheme = MultiRateScheme::hold;
  int contact_ticks = 1;  ///< >= 1: servo ticks per contact period
  /// [m] > 0 largest distance from the sample at which the last two schemes extrapolate; beyond it they use the value at this distance. The
  /// default is half of the path of a fast hand (0.4 m/s) in 50 ms. A smaller bound makes the wall a constant force where the hand leaves
  /// the bound, which generates energy: at 20 Hz and 2 mm a body that fell on bone never came to rest.
  double max_distance = 10.0e-3;
};

class MultiRate {
 public:
  explicit MultiRate(const MultiRateConfig& config) noexcept : config_(config) {}

  /// One servo tick of dt [s]. @returns the wrench of the drill on the hand now: force [N], torque [N m] about the tool origin. Before the
  /// first evaluation (number 0) it returns the wrench of the state.
  [[nodiscard]] Wrench operator()(const ContactState& latest, const HandState& hand, double dt) noexcept BH_REALTIME;
  /// Sets a law of tangential loads, such as friction, for the last two schemes, evaluated at the servo's rate; null: none. Not owned; it
  /// must not be the instance that contact uses. The other two schemes output the tangential loads of contact. Do not call during a tick:
  /// allocates.
  void use_tangential_law(TangentialLaw* law);
  /// Clears all past states.
  void clear() noexcept BH_REALTIME;

 private:
  [[nodiscard]] Wrench between(const Wrench& latest, bool renewed) noexcept;
  [[nodiscard]] Wrench extrapolate(const ContactState& latest, const HandState& hand, bool renewed, double dt) noexcept;
  /// Extrapolates the normal loads by the planes, and adds the tangential loads of the law for them.
  [[nodiscard]] Wrench extrapolate_loads(const ContactState& latest, const Pose& hand, const Vec3& moved, double dt) noexcept;
  [[nodiscard]] Wrench pressed_on(const ContactState& latest, const Pose& near, const HandState& hand, double dt) noexcept;
  /// Moves the servo's tool by its drift from the tool of a new result, once per result and as soon as the tick of the result is there.
  void follow(const ContactState& latest) noexcept;

  MultiRateConfig config_;
  std::uint64_t number_ = 0;  // number of the last state used
  int ticks_ = 0;             // ticks since that state arrived
  Wrench from_, shown_;       // for the scheme `linear`
  PlaneLoads loads_;
  LocalTool tool_;
  ToolTrail trail_;
  bool holds_tool_ = false;     // tool_ and trail_ follow contact
  std::uint64_t followed_ = 0;  // number of the result that the tool follows
  TangentialLaw* law_ = nullptr;
  TangentialSpring spring_;  // for penalty planes, and for coupled ones in the scheme `gradient`
};

}  // namespace burrhole
