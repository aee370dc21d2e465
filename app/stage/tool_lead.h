/// app/stage/tool_lead.h: how far ahead of its pose the tool stands in a step of sub-voxel removal, which makes the error of the erosion
///   rate one of second order.
///   Frame  world.   Units  SI.   Errors  none.   Thread  simulation.
///   Source own derivation, for law `rate` and a step with one pose. T is the position of the tool along the force, S that of the face, and
///          dS/dt = r (T - S). Bone is published at the end of a step, so S is constant while contact moves T, and r (M - S), M the mean
///          position in the step, is the speed of the face in the middle of the step. By Adams and Bashforth's method of second order the
///          face then advances by r dt (w + (w - w') / 2), w and w' the mean overlaps of this step and of the last. The share 1 - exp(-r dt)
///          of the overlap at the position M + (M - M') / 2 is the same up to terms of third order. At a constant speed of the tool this is
///          its position at the end of the step: the lead is 0. At a constant thrust, where the tool follows each advance of the face at
///          once, the lead is half an advance. Without it the bit would be slower by the fraction r dt / 2.
///   Limits Across the force the tool does not follow the face, so nothing is ahead there. From an advance of 0.2 voxel edges a step on, the
///          lead is limited, and the error is of first order again. Law `energy` removes what its work permits, and the lead changes only
///          where.
#pragma once

#include <cstdint>
#include <utility>

#include "core/base/geometry.h"
#include "core/contact/contact_state.h"

namespace burrhole {

class ToolLead {
 public:
  static constexpr double kMost = 0.1;  ///< [voxel edges] a tool that stops has removed bone at most this far ahead

  /// @param edge [m] of a voxel.
  explicit ToolLead(double edge) noexcept : most_(kMost * edge) {}
  /// To be called once a step. @param reaction unit, direction of the force of bone on the tool; 0: there is none.
  /// @returns [m] from the tool's present position, along the reaction. 0 in the first step, and if contact has no new evaluation: the
  /// leads of the other steps then add up to half of the whole advance.
  [[nodiscard]] Vec3 operator()(const ContactState& now, const Vec3& reaction) noexcept {
    if (now.number <= number_) return Vec3(0.0);
    const Vec3 mean = (now.position_sum - sum_) / static_cast<double>(now.number - number_), before = std::exchange(mean_, mean);
    number_ = now.number;
    sum_ = now.position_sum;
    if (!std::exchange(known_, true)) return Vec3(0.0);
    const double along = glm::dot(mean + 0.5 * (mean - before) - now.world_from_tool.translation, reaction);
    return reaction * glm::clamp(along, -most_, most_);
  }

 private:
  double most_;                // [m]
  Vec3 mean_{0.0}, sum_{0.0};  // [m] mean position in the last step; position_sum at its end
  std::uint64_t number_ = 0;   // of the newest evaluation
  bool known_ = false;         // mean_ is known
};

}  // namespace burrhole
