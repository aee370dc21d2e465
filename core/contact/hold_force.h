/// core/contact/hold_force.h: the force of a tool that is held before bone that has not been read. It never points against the last push of
///   bone, so a hand that leaves bone feels no attractive force.
///   Frame  one for all arguments.   Units N.   Errors none.   Thread contact.
#pragma once

#include "core/base/geometry.h"

namespace burrhole {

class HoldForce {
 public:
  /// @param push force of bone on the tool in an evaluation that read all bone; zero is ignored.
  void note(const Vec3& push) noexcept {
    if (push != Vec3(0.0)) push_ = push;
  }
  void clear() noexcept { push_ = Vec3(0.0); }
  /// @param spring force on the hand from the place at which the tool is held. @returns that force, or zero where it is attractive.
  [[nodiscard]] Vec3 of(const Vec3& spring) const noexcept { return glm::dot(spring, push_) < 0.0 ? Vec3(0.0) : spring; }

 private:
  Vec3 push_{0.0};
};

}  // namespace burrhole
