/// core/sound/sound_sink.h: interface of what receives sound: a file, a sound device, a test.
///   Units  samples in -1..1, mono, at the rate that the sink was created for.   Errors  a sink keeps its own.
///   Thread  the one that runs the audio clock.
#pragma once

#include <span>

namespace burrhole {

class SoundSink {
 public:
  virtual ~SoundSink() = default;
  /// Receives the next block of samples. Must not wait for a device.
  virtual void write(std::span<const float> samples) noexcept = 0;
};

}  // namespace burrhole
