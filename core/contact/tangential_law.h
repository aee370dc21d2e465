/// core/contact/tangential_law.h: the interface between contact models and a law of tangential loads, such as friction.
///   A model provides the pressed points, their normal loads, and the move of the tool in this step without tangential loads. The law
///   returns the tangential loads. Models and laws do not depend on each other:
///     constrained tool   massless; the springs couple hand and tool, so a tangential force T moves the tool by T / stiffness;
///     penalty models     tool pose = device pose; a spring of the model's stiffness connects the tool to a massless slider, and the law
///     moves the slider (tangential_spring.h).
///   Frame  any in which bone is at rest, the same in one problem and from step to step.   Units  SI.   Thread  that of the model.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/assert.h"
#include "core/base/geometry.h"
#include "core/base/spd.h"

namespace burrhole {

/// A small rigid move, to first order: a point at arm a moves by translation + turn x a.
struct SmallMove {
  Vec3 translation{0.0};  ///< [m] of the tool origin
  Vec3 turn{0.0};         ///< [rad]
  [[nodiscard]] Vec3 at(const Vec3& arm) const noexcept { return translation + glm::cross(turn, arm); }
};

/// A point where the tool presses on bone.
struct PressedPoint {
  std::uint32_t point = 0;     ///< identifies the place on the tool; equal in the next step for the same place
  Vec3 arm{0.0};               ///< [m] from the tool origin
  Vec3 normal{0.0, 0.0, 1.0};  ///< [-] outward unit normal of bone
  double load = 0.0;           ///< [N] > 0, along the normal
  bool held = false;           ///< cutting flanks resist lateral displacement here, so the law adds friction of the rim speed only
};

inline constexpr std::size_t kMaxPressedPoints = 64;

/// All moves are relative to the start of the step.
struct TangentialProblem {
  std::span<const PressedPoint> points;  ///< at most kMaxPressedPoints
  SmallMove free;                        ///< of the tool under all loads except the tangential ones
  double stiffness = 1.0;                ///< [N/m] > 0
  double turn_stiffness = 1.0;           ///< [N m/rad] > 0; may be infinite
  /// Stiffness of the loaded planes against a move (translation, then turn), in addition to that of the springs; null: none. Positive
  /// semidefinite; the lower triangle is read. Not with an infinite turn stiffness.
  const Matrix6* planes = nullptr;
  Vec3 spin{0.0};    ///< [rad/s] of the tool's surface, about an axis through the tool origin, in addition to its move
  double dt = 1e-3;  ///< [s] > 0
};

struct TangentialLoads {
  Wrench on_tool;  ///< force [N], torque [N m] about the tool origin
  SmallMove move;  ///< of the tool with these loads: free + what the loads add against springs and planes
};

class TangentialLaw {
 public:
  virtual ~TangentialLaw() = default;
  /// Clears the state: after a jump of the tool, or when no point is pressed.
  virtual void clear() noexcept = 0;
  /// A model may call it several times per step while it solves the normal loads; each call replaces the last.
  [[nodiscard]] virtual TangentialLoads loads(const TangentialProblem& problem) noexcept BH_REALTIME = 0;
  /// Ends the step. @param moved actual move of the tool since the start of the step.
  virtual void end_step(const SmallMove& moved) noexcept BH_REALTIME = 0;
};

}  // namespace burrhole
