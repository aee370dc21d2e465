/// haptics/servo/force_guard.h: whoever drives a hand with forces holds one of these: however that ends, the last force is zero.
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
