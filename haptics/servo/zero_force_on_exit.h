/// haptics/servo/force_guard.h: commands zero force when the scope that drives a hand ends, in whichever way it ends.
#pragma once

#include "haptics/hand/hand_source.h"

namespace burrhole {

class ForceGuard {
 public:
  /// `hand` must outlive it.
  explicit ForceGuard(HandSource& hand) noexcept : hand_(&hand) {}
  ~ForceGuard() { hand_->apply({}); }
  ForceGuard(const ForceGuard&) = delete;
  ForceGuard& operator=(const ForceGuard&) = delete;

 private:
  HandSource* hand_;
};

}  // namespace burrhole
