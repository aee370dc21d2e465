#include "app/run/lockstep.h"

#include <algorithm>

#include "haptics/servo/realtime.h"

namespace burrhole {

Lockstep::Lockstep(Stage& parts)
    : parts_(&parts),
      in_flight_(parts.latency + 1),
      audio_every_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(kAudioPeriod / parts.period + 0.5))) {}

const ServoOutput& Lockstep::tick() {
  const FlushToZero guard;
  Stage& parts = *parts_;
  parts.servo->sense();
  ran_contact_ = tick_ % parts.contact_every == 0;
  if (ran_contact_) (*parts.contact)(parts.hand_mailbox.latest());
  in_flight_[tick_ % in_flight_.size()] = parts.contact->state();
  // A result computed from the motion read in tick t reaches the servo in tick t + latency.
  if (tick_ >= parts.latency) parts.force_mailbox.publish(in_flight_[(tick_ - parts.latency) % in_flight_.size()]);
  servo_ = servo_timer_([&] { return parts.act(); });
  ++tick_;
  ran_bone_ = tick_ % parts.bone_every == 0;
  if (ran_bone_) parts.cut(parts.contact->state());
  if (tick_ % audio_every_ == 0 && !parts.graph.empty(Clock::audio)) parts.graph.run(Clock::audio, {audio_ticks_++, kAudioPeriod});
  return servo_;
}

}  // namespace burrhole
