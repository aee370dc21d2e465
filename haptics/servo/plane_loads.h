/// haptics/servo/plane_loads.h: what the planes of a contact carry, each as a straight line over a small move of the hand.
///   Frame  world.   Units SI.   Thread servo.
///   Plane i carries  f_i(d) = max(0, at_rest_i + slope_i . d)  when the hand has moved by d since the sample: [AcostaLiu07] eq. (3), whose
///   gradient is sum of N_i slope_i^T, with each contact clamped to pushing. Without the clamp a hand that leaves bone is pulled back.
///   penalty   slope_i = -N_i / yield_i.
///   coupled   the planes that carry load stay the ones that do: with A the compliance among them (hold_solver.h; coupling, engagement and
///             bone's own yield) A f = -gap - N . d, so the slopes are the rows of -A^-1 N^T. Own derivation; without the coupling's
///             damping.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/assert.h"
#include "core/contact/local_contact.h"

namespace burrhole {

class PlaneLoads {
 public:
  /// Of a penalty contact: those pressed at the sample, or all that are listed, so that the next to touch is foreseen.
  void set_penalty(const LocalContact& local, bool with_untouched) noexcept BH_REALTIME;
  /// Of a coupled contact: those that carry load at the sample. One small Cholesky, at most kMaxLocalPlanes rows.
  void set_coupled(const LocalContact& local) noexcept BH_REALTIME;

  /// @param sampled what the contact itself found at the sample; exactly that at d = 0. @param d [m] move of the hand since.
  /// What it holds beyond the planes (rounding, a model's cap) goes as their load goes, so nothing is left once none pushes.
  [[nodiscard]] Wrench extrapolate(const Wrench& sampled, const Vec3& d) const noexcept BH_REALTIME;

  /// Sum of N slope^T [N/m] over the planes: the gradient before any clamp.
  [[nodiscard]] Mat3 gradient() const noexcept BH_REALTIME;

 private:
  struct Load {
    Vec3 normal, arm, slope;  // [-], [m], [N/m]
    double at_rest = 0.0;     // [N]
    bool both_ways = false;
  };
  struct Sum {
    Wrench wrench;
    double pushing = 0.0;  // [N] of the planes that push, as numbers
  };
  void add(const HoldPlane& plane, double at_rest, const Vec3& slope) noexcept;
  [[nodiscard]] Sum sum(const Vec3& d) const noexcept;

  std::array<Load, kMaxLocalPlanes> loads_{};
  std::size_t count_ = 0;
  Sum sampled_;  // at d = 0
};

}  // namespace burrhole
