/// app/audio/speaker.h: sends samples to the sound device through OpenAL Soft.
///   Latency  three blocks are queued before the sound starts, 30 ms; the device adds its own period. A queue that ran empty is an
///            underrun: the sound starts again with three blocks. A block beyond ten is dropped: the device's clock is slower than ours.
///   Errors   unavailable: no library, no device.   Thread  one; OpenAL mixes on its own.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "core/base/result.h"
#include "core/sound/sound_sink.h"

namespace burrhole {

class Speaker final : public SoundSink {
 public:
  using Report = std::function<void(std::uint64_t underruns, std::uint64_t dropped)>;
  static constexpr int kStartBlocks = 3, kMostBlocks = 10;

  /// OpenAL and ALSA then print no messages of their own, unless the environment variable ALSOFT_LOGLEVEL is set. To be called before other
  /// threads start.
  static void silence_libraries();
  /// @param sample_rate [Hz]. @param report called at the end with the numbers of underruns and dropped blocks; may be empty. A device that
  /// plays nothing, which OpenAL opens where there is no other, counts as none, unless the environment variable ALSOFT_DRIVERS or
  /// ALSOFT_CONF chooses the driver.
  [[nodiscard]] static Result<std::unique_ptr<Speaker>> open(int sample_rate, Report report = {});
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;
  /// Waits until what is queued has been heard, at most 0.2 s.
  ~Speaker() override;

  /// Queues a block. Samples are sent as sample16() (core/sound/sample16.h). Never waits.
  void write(std::span<const float> samples) noexcept override;
  [[nodiscard]] std::uint64_t underruns() const noexcept;
  [[nodiscard]] std::uint64_t dropped() const noexcept;  ///< blocks

 private:
  struct Device;
  explicit Speaker(std::unique_ptr<Device> device);
  std::unique_ptr<Device> device_;
};

}  // namespace burrhole
