#include "app/run/lockstep.h"

#include "haptics/servo/realtime.h"

namespace burrhole {

Lockstep::Lockstep(Stage& parts) : parts_(&parts), in_flight_(parts.latency + 1), has_audio_(!parts.graph.empty(Clock::audio)) {}

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
  if (has_audio_) run_audio();
  return servo_;
}

void Lockstep::run_audio() {
  for (ran_audio_ = 0; audio_ticks_ < parts_->audio_blocks(tick_); ++ran_audio_)
    parts_->graph.run(Clock::audio, {audio_ticks_++, kAudioPeriod});
}

}  // namespace burrhole
