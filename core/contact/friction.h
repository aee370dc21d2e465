/// core/contact/friction.h: Coulomb friction with stiction between tool and bone, as a law of tangential loads (tangential_law.h).
///   Frame  that of the problem.   Units  SI.   Thread  that of the model; fixed memory, never allocates.
///   At each pressed point, with the normal load N and its displacement s over bone in this step, including the rim speed of the spin:
///     sticking  s = 0 and |T| <= mu_static N;      sliding  T = -mu_kinetic N s / |s|.
///   A point starts to slide when sticking would need more than mu_static N. It sticks again when less than mu_kinetic N is enough. The
///   problem is solved implicitly over the step (return mapping), so friction dissipates in every step of any length.
///   No creep  The anchor of a sticking point is the place where it stopped, not its place one step ago: a residual displacement of a step
///   (rounding, the model's tolerance) is corrected in the next.
///   Spin  The rim speed w x arm adds to the displacement. Far above the feed speed v the resistance to feed is mu N v / |w x arm|; the
///         rest is drag torque and a side force. The drive supplies their power, so T . v may be positive while T . (v + w x arm) never is.
///   Source  Coulomb's law; the implicit step is the incremental variational form of [Moreau88], from memory. friction.cpp derives the
///           solution. Held points: tangential_hold.h.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/result.h"
#include "core/contact/tangential_law.h"

namespace burrhole {

/// Defaults: steel plates on bone have 0.37 in [HayesPerren72] (from memory). No value was found for kinetic friction on wet bone; 0.30 is
/// an assumption, equal to the value that [Shacham10] measured between bone and muscle above 4 N.
struct FrictionConfig {
  double static_coefficient = 0.37;   ///< [-] in [kinetic_coefficient, 2]
  double kinetic_coefficient = 0.30;  ///< [-] in [0, 2]
};

class Friction final : public TangentialLaw {
 public:
  // Bounds of one solution of the loads; loads() makes at most 5: multiplier rounds, Newton steps per round, step halvings per Newton step.
  static constexpr int kMaxRounds = 12, kMaxSteps = 20, kMaxHalvings = 24;

  /// Errors: out_of_range when a coefficient is outside its range.
  [[nodiscard]] static Result<Friction> create(const FrictionConfig& config);

  void clear() noexcept override;
  [[nodiscard]] TangentialLoads loads(const TangentialProblem& problem) noexcept BH_REALTIME override;
  void end_step(const SmallMove& moved) noexcept BH_REALTIME override;

  /// @returns whether any point slid in the last step because of its move, not of the spin.
  [[nodiscard]] bool sliding() const noexcept { return sliding_; }

 private:
  explicit Friction(const FrictionConfig& config) noexcept : config_(config) {}
  /// One pressed point during the solution.
  struct Point {
    std::uint32_t point;
    Vec3 arm, normal;
    Vec3 start;                 // [m] displacement over bone before the tool's move: residual of earlier steps, and that of the rim
    double normal_load, limit;  // [N]
    bool slides;
    Vec3 multiplier, load;  // [N]
  };
  /// State of a point that is kept between steps, and between calls in a step.
  struct Kept {
    std::uint32_t point = 0;
    bool slides = false;
    Vec3 load{0.0};  // [N] initial guess
  };
  void set_points(const TangentialProblem& problem) noexcept;
  [[nodiscard]] Vec3 displacement(const Point& point, const SmallMove& move) const noexcept;
  /// Finds the loads and the move for the current limits.
  void settle(const TangentialProblem& problem) noexcept;
  /// Sets the loads at a move.
  void set_loads(const SmallMove& move, double stiff) noexcept;
  /// The residual of all forces at a move with its loads: zero at the minimum of the energy.
  [[nodiscard]] Wrench residual(const TangentialProblem& problem, const SmallMove& move) const noexcept;
  [[nodiscard]] SmallMove newton_direction(const TangentialProblem& problem, double stiff) const noexcept;
  /// Moves `move_` along the Newton direction with a line search on the energy. @returns the distance [m].
  double newton_step(const TangentialProblem& problem, double stiff) noexcept;
  /// Changes points that should stick but move to sliding. @returns whether there were any.
  bool let_slide() noexcept;
  void keep() noexcept;

  FrictionConfig config_;
  std::array<Point, kMaxPressedPoints> points_{};
  std::size_t count_ = 0;
  Wrench held_;                                           // of held points
  SmallMove move_;                                        // of the tool with the loads
  std::array<Kept, kMaxPressedPoints> before_{}, now_{};  // of the last completed step, and of this one
  std::size_t before_count_ = 0, now_count_ = 0;
  SmallMove owed_;  // residual: the actual move of the tool minus that of the law
  SmallMove let_;   // the move of the last call
  bool sliding_ = false;
};

}  // namespace burrhole
