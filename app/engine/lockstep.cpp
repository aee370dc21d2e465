#include "app/engine/lockstep.h"

#include "app/engine/realtime.h"

namespace burrhole {

const ServoOutput& Lockstep::tick() {
  const FlushToZero guard;
  DrillParts& parts = *parts_;
  parts.servo->sense();
  looked_ = tick_ % parts.contact_every == 0;
  if (looked_) {
    (*parts.contact)(parts.hand_mailbox.latest());
    timers_.contact.add(parts.contact->step_us());
  }
  in_flight_[tick_ % in_flight_.size()] = parts.contact->state();
  // A result computed from the motion read in tick t reaches the servo in tick t + latency.
  if (tick_ >= parts.latency) parts.force_mailbox.publish(in_flight_[(tick_ - parts.latency) % in_flight_.size()]);
  servo_ = timers_.servo([&] { return parts.servo->act(); });
  ++tick_;
  if (tick_ % parts.bone_every == 0) parts.cut(parts.contact->state());
  return servo_;
}

}  // namespace burrhole
