/// haptics/servo/plane_loads.h: the load of each contact plane as a linear function of a small displacement of the hand.
///   Frame  world.   Units SI.   Thread servo.
///   For a displacement d of the hand since the sample, plane i carries  f_i(d) = max(0, at_rest_i + slope_i . d). This is [AcostaLiu07]
///   eq. (3) with the gradient sum of N_i slope_i^T and a clamp per contact. Without the clamp a hand that leaves bone would receive an
///   attractive force.
///   penalty   slope_i = -N_i / yield_i.
///   coupled   the set of loaded planes is assumed constant. With A the compliance among them (hold_solver.h: coupling, engagement and
///             compliance of bone), A f = -gap - N . d, so the slopes are the rows of -A^-1 N^T. Own derivation; it omits the coupling's
///             damping.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/base/assert.h"
#include "core/contact/local_contact.h"
#include "core/contact/tangential_law.h"

namespace burrhole {

class PlaneLoads {
 public:
  /// Sets the planes of a penalty contact: those in penetration at the sample, or all listed planes, which includes the next contact.
  void set_penalty(const LocalContact& local, bool with_untouched) noexcept BH_REALTIME;
  /// Sets the planes of a coupled contact that carry load at the sample. One Cholesky factorisation of at most kMaxLocalPlanes rows.
  void set_coupled(const LocalContact& local) noexcept BH_REALTIME;

  /// @param sampled wrench that contact computed at the sample; the result at d = 0, exactly. @param d [m] displacement of the hand since.
  /// The part of `sampled` that the planes do not explain (rounding, a cap of the model) scales with their total load. The result is zero
  /// once no plane carries load.
  [[nodiscard]] Wrench extrapolate(const Wrench& sampled, const Vec3& d) const noexcept BH_REALTIME;

  /// Lists the planes with load at the displacement d, for a tangential law. @returns their number.
  std::size_t pressed(const Vec3& d, std::span<PressedPoint, kMaxLocalPlanes> out) const noexcept BH_REALTIME;

  /// Wrench of the planes at the sample: force [N], torque [N m].
  [[nodiscard]] const Wrench& at_sample() const noexcept { return sampled_.wrench; }

  /// Sum of N slope^T [N/m] over the planes: the gradient without the clamp.
  [[nodiscard]] Mat3 gradient() const noexcept BH_REALTIME;

 private:
  struct Load {
    Vec3 normal, arm, slope;  // [-], [m], [N/m]
    double at_rest = 0.0;     // [N]
    bool both_ways = false;
    bool cutting = false;
    std::uint32_t point = 0;
  };
  struct Sum {
    Wrench wrench;
    double pushing = 0.0;  // [N] sum of the magnitudes of the loads of pushing planes
  };
  void add(const HoldPlane& plane, double at_rest, const Vec3& slope) noexcept;
  [[nodiscard]] Sum sum(const Vec3& d) const noexcept;

  std::array<Load, kMaxLocalPlanes> loads_{};
  std::size_t count_ = 0;
  Sum sampled_;  // at d = 0
};

}  // namespace burrhole
