/// core/contact/friction.h: Coulomb friction with stiction between tool and bone, as a law of tangential loads (tangential_law.h).
///   Frame  that of the problem.   Units  SI.   Thread  that of the model; fixed memory, never allocates.
///   At each pressed point, with the normal load N and its displacement s over bone in this step, including the rim speed of the spin:
///     sticking  s = 0 and |T| <= mu_static N;      sliding  T = -mu_kinetic N s / |s|.
///   A point starts to slide when sticking would need more than mu_static N. It sticks again when less than mu_kinetic N is enough. The
///   problem is solved implicitly over the step (return mapping), so friction dissipates in every step of any length.
///   Cost   A call visits the points three times as a rule, and at most kMaxPasses + kMaxSteps * kMaxHalvings times per solution.
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
  // Bounds of one solution of the loads; loads() makes at most 5: passes of Newton's method over the points, and where these do not arrive,
  // multiplier rounds of the envelope, its Newton steps in all of them, and step halvings per step.
  static constexpr int kMaxPasses = 20, kMaxRounds = 12, kMaxSteps = 40, kMaxHalvings = 24;

  /// Errors: out_of_range when a coefficient is outside its range.
  [[nodiscard]] static Result<Friction> create(const FrictionConfig& config);

  void clear() noexcept override;
  [[nodiscard]] TangentialLoads loads(const TangentialProblem& problem) noexcept BH_REALTIME override;
  void end_step(const SmallMove& moved) noexcept BH_REALTIME override;

  /// @returns whether any point slid in the last step because of its move, not of the spin.
  [[nodiscard]] bool sliding() const noexcept { return sliding_; }

 private:
  explicit Friction(const FrictionConfig& config) noexcept : config_(config) {}
  enum class State : std::uint8_t {
    rests,   // displacement 0, load without limit
    starts,  // a load at its limit that no displacement has turned yet
    slides,  // load at its limit, against the displacement
  };
  /// One pressed point during the solution.
  struct Point {
    std::uint32_t point;
    Vec3 arm, normal;
    Vec3 start;                 // [m] displacement over bone before the tool's move: residual of earlier steps, and that of the rim
    double normal_load, limit;  // [N]
    bool slides;                // its limit is the kinetic one
    State state;                // in part()
    bool released;              // it rested in this solution, and its load was above the limit
    Vec3 moved, from;           // [m] displacement over bone at the move, and at the move of the last step of part()
    Vec3 multiplier, load;      // [N]
    Vec3 wanted;                // [N] the load of the envelope without its limit
  };
  /// State of a point that is kept between steps, and between calls in a step.
  struct Kept {
    std::uint32_t point = 0;
    bool slides = false;
    Vec3 load{0.0};  // [N] initial guess
  };
  void set_points(const TangentialProblem& problem) noexcept;
  [[nodiscard]] Vec3 displacement(const Point& point, const SmallMove& move) const noexcept;
  /// Finds the loads and the move for the current limits: by part(), or where it does not arrive by settle().
  void solve(const TangentialProblem& problem) noexcept;

  // With points parted into resting and sliding ones.
  struct Slope {
    Matrix6 matrix;  // second derivative of the energy
    Wrench left;     // sum of all forces
    double nearest;  // [m] least displacement of a sliding point
  };
  /// @returns whether the loads are found, to the residual of settle().
  [[nodiscard]] bool part(const TangentialProblem& problem) noexcept;
  /// Sets the loads at the move.
  [[nodiscard]] Slope slope(const TangentialProblem& problem) noexcept;
  /// One step of Newton's method with a line search. @returns [m] bound of what is left; infinite where points or only a part of the step
  /// changed.
  double descend(const TangentialProblem& problem, Slope& here) noexcept;
  /// Lets points rest that went through their resting place in this step. @returns whether there were any.
  bool stop_turned() noexcept;
  /// Lets resting points start whose load is above the limit, and moves the multipliers of the others. @returns whether the loads have to be
  /// found again.
  bool correct_resting(double stiff) noexcept;

  // By the envelope.
  void settle(const TangentialProblem& problem) noexcept;
  /// [m] largest displacement of a point by a move.
  [[nodiscard]] double length_of(const SmallMove& move) const noexcept;
  /// Forces at the move without the points: those of the springs and of held points.
  [[nodiscard]] Wrench pull(const TangentialProblem& problem) const noexcept;
  /// Sets the loads at the move. @returns the sum of all forces: zero at the minimum of the energy.
  Wrench set_loads(const TangentialProblem& problem, double stiff) noexcept;
  [[nodiscard]] SmallMove newton_direction(const TangentialProblem& problem, const Wrench& left, double stiff) const noexcept;
  /// Moves `move_` along the Newton direction with a line search on the energy. @param left the sum of all forces, before and after.
  /// @returns the distance [m].
  double newton_step(const TangentialProblem& problem, double stiff, Wrench& left) noexcept;
  /// Changes points that should stick but move to sliding. @returns whether there were any.
  bool let_slide() noexcept;
  void keep() noexcept;

  FrictionConfig config_;
  std::array<Point, kMaxPressedPoints> points_{};
  std::size_t count_ = 0;
  int passes_ = 0;                                        // of slope() in this solution
  double lever_ = 0.0;                                    // [m] longest arm
  Wrench held_;                                           // of held points
  SmallMove move_;                                        // of the tool with the loads
  std::array<Kept, kMaxPressedPoints> before_{}, now_{};  // of the last completed step, and of this one
  std::size_t before_count_ = 0, now_count_ = 0;
  SmallMove owed_;  // residual: the actual move of the tool minus that of the law
  SmallMove let_;   // the move of the last call
  bool sliding_ = false;
};

}  // namespace burrhole
