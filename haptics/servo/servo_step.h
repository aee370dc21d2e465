/// haptics/servo/servo_step.h: one tick of the servo: latest contact force, checked and limited, to whoever holds the drill.
///   Units SI, world frame.   Thread servo: no lock, allocation, log, file or exception.
#pragma once

#include <cstdint>

#include "core/base/triple_buffer.h"
#include "core/contact/contact_state.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

enum ServoFault : std::uint32_t {
  kServoForceNotFinite = 1u << 0,  ///< latched: zero force from then on
  kServoForceCapped = 1u << 1,     ///< magnitude was limited in a tick; not latched
};

struct ServoConfig {
  double largest_force = 200.0;  ///< [N] > 0: magnitude limit of what reaches the hand
};

struct ServoOutput {
  Vec3 force{0.0};  ///< [N] on the hand this tick
  HandState hand;
  std::uint32_t faults = 0;
};

class ServoStep {
 public:
  ServoStep(const ServoConfig& config, HandSource& hand, TripleBuffer<ContactState>& contact_in, TripleBuffer<HandState>& hand_out)
      : config_(config), hand_(&hand), contact_in_(&contact_in), hand_out_(&hand_out) {}

  const ServoOutput& operator()() noexcept BH_REALTIME;
  [[nodiscard]] std::uint32_t faults() const noexcept { return faults_; }

 private:
  ServoConfig config_;
  HandSource* hand_;
  TripleBuffer<ContactState>* contact_in_;
  TripleBuffer<HandState>* hand_out_;
  std::uint32_t faults_ = 0;
  ServoOutput output_;
};

}  // namespace burrhole
