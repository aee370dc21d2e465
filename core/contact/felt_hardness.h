/// core/contact/felt_hardness.h: a coupling that is softer on softer bone, so that a hand feels the layers of a skull.
///   A bone of hardness 0.1 yields 0.01 mm more than one of hardness 1 under 28 N, but the spring between hand and tool yields 5.6 mm. So the
///   hand feels the stiffness of that spring, on any bone. Here bone is taken to be in series with the spring: the spring itself becomes
///   softer, and the tool stays on the surface of bone.
///   Law     K = K_coupling (1 - share (1 - h)), h the relative stiffness of bone under the contacts, weighted by their forces.
///   Energy  A spring that becomes stiffer while it is stretched generates dK x^2 / 2. So K grows by no more than the work of cutting pays
///           for, F ds with ds the advance of the cutting tool along its push: dK <= 2 F ds / x^2; and freely where the spring is not loaded;
///           away from bone K is K_coupling.
///           It decreases with a time constant; that dissipates. K never exceeds K_coupling, so limits of stability that hold for it hold.
///   Units   SI.   Errors none.   Thread  contact.   Source  own derivation.
#pragma once

namespace burrhole {

class FeltHardness {
 public:
  static constexpr double kTime = 0.02;      ///< [s] time constant
  static constexpr double kUnloaded = 0.05;  ///< [N] a smaller force of the spring counts as none
  explicit FeltHardness(double share) noexcept : share_(share) {}
  struct Load {
    double hardness = 1.0;   ///< [-] relative stiffness under the contacts; below 0: none is known
    double force = 0.0;      ///< [N] of the spring
    double stiffness = 1.0;  ///< [N/m] K_coupling
    double advance =
        0.0;  ///< [m] of the cutting tool along its push in this period, without its engagement; 0 for a tool that does not cut
  };
  void update(const Load& load, double dt) noexcept;
  [[nodiscard]] double factor() const noexcept { return factor_; }  ///< [-] K / K_coupling
  [[nodiscard]] bool active() const noexcept { return share_ > 0.0; }

 private:
  double share_;  // [-]
  double factor_ = 1.0;
};

}  // namespace burrhole
