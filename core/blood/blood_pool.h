/// core/blood/blood_pool.h: blood from the opened pores of a hole: how much flows, where it is, and where it goes.
///   Flow   Q = conductance x sum over the sources of pore area x exp(-age / coagulation) x max(0, pressure - weight x (level - height)).
///          The decay is integrated in closed form; the level is that at the end of the step (backward Euler), so any step is stable.
///   Film   blood on the bone drains into the hole with a time constant, faster where saline washes it: a linear reservoir, in closed form.
///   Hole   well mixed. Below its rim it fills; at the rim it takes in as much as it loses: dB/dt = b - (b + s) B / V, in closed form, with B blood
///          in the hole, V its volume, b and s the inflows of blood and saline. Blood that leaves so counts as rinsed while saline flows,
///          otherwise as overflowed. Suction takes of the mixture, after that. A hole that shrinks (bone that was brought back) overflows.
///   Balance  bled = in the hole + on bone + rinsed + sucked + overflowed, to rounding, after each step.
///   Frame  none.   Units  SI.   Errors  none.   Thread  one; steps do not allocate.   Source  own derivation.
#pragma once

#include "core/blood/blood_site.h"

namespace burrhole {

struct BloodConfig {
  double pressure = 1300.0;       ///< [Pa] in the diploe, over that outside; 10 mmHg (an assumption)
  double conductance = 7e-7;      ///< [m/(s Pa)] speed in an opened pore per pressure (an assumption)
  double coagulation = 300.0;     ///< [s] time constant with which an opened pore closes (an assumption)
  double film_time = 1.0;         ///< [s] in which blood on bone runs into the hole (an assumption)
  double wash_time = 0.5;         ///< [s] in which saline washes it there (an assumption)
  double weight = 1060.0 * 9.81;  ///< [Pa/m] density of blood x gravity
  double suction = 0.0;           ///< [m^3/s]
};

struct BloodVolumes {
  double bled = 0.0;        ///< [m^3] since the start
  double hole = 0.0;        ///< [m^3] blood in the hole now
  double saline = 0.0;      ///< [m^3] saline in the hole now
  double film = 0.0;        ///< [m^3] on bone now
  double rinsed = 0.0;      ///< [m^3] since the start
  double sucked = 0.0;      ///< [m^3] since the start
  double overflowed = 0.0;  ///< [m^3] since the start
  [[nodiscard]] double in_hole() const noexcept { return hole + saline; }
  /// @returns what the balance lacks [m^3].
  [[nodiscard]] double missing() const noexcept { return bled - hole - film - rinsed - sucked - overflowed; }
};

class BloodPool {
 public:
  /// @pre all values finite; coagulation, film_time and wash_time above 0, others at least 0.
  explicit BloodPool(const BloodConfig& config) : config_(config) {}

  /// @param saline [m^3/s] that flows into the hole. Lets the sources of `site` coagulate.
  void step(BloodSite& site, double saline, double dt) noexcept;
  /// @param flow [m^3/s] of suction from the next step on.
  void set_suction(double flow) noexcept { config_.suction = flow; }
  [[nodiscard]] const BloodVolumes& volumes() const noexcept { return volumes_; }
  [[nodiscard]] double flow() const noexcept { return flow_; }    ///< [m^3/s] mean of the last step
  [[nodiscard]] double level() const noexcept { return level_; }  ///< [m] height of the surface, as BloodSite
  /// @returns the depth [m] of blood alone over the area of the surface.
  [[nodiscard]] double blood_depth(const BloodSite& site) const noexcept;

 private:
  [[nodiscard]] double bleed(BloodSite& site, double drains, double kept, double dt) noexcept;
  void fill(double capacity, double blood, double saline) noexcept;
  void suck(double dt) noexcept;

  BloodConfig config_;
  BloodVolumes volumes_;
  double flow_ = 0.0, level_ = 0.0;
};

}  // namespace burrhole
