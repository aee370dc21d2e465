/// haptics/servo/zero_force_on_exit.h: commands zero force to a hand (the device) when a scope ends by return or by an exception. After an
///   abort or a killed process nothing is commanded.
///   Thread  the one that calls apply().
#pragma once

#include "haptics/hand/hand_source.h"

namespace burrhole {

class ZeroForceOnExit {
 public:
  /// `hand` must outlive it.
  explicit ZeroForceOnExit(HandSource& hand) noexcept : hand_(&hand) {}
  ~ZeroForceOnExit() { hand_->apply({}); }
  ZeroForceOnExit(const ZeroForceOnExit&) = delete;
  ZeroForceOnExit& operator=(const ZeroForceOnExit&) = delete;

 private:
  HandSource* hand_;
};

}  // namespace burrhole
