/// app/job/wav_file.h: a WAV file of 16 bits, mono, written while a run goes on.
///   Errors  those of OutputFile; bad_input for a run that would exceed 4 GB.   Thread  one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/output_file.h"
#include "core/base/result.h"
#include "core/sound/sound_sink.h"

namespace burrhole {

class WavFile final : public SoundSink {
 public:
  /// Without finish() no file is left. @param sample_rate [Hz] > 0.
  [[nodiscard]] static Result<std::unique_ptr<WavFile>> create(const std::string& path, int sample_rate);

  /// Samples become sample16() (core/sound/sample16.h). An error is kept for finish().
  void write(std::span<const float> samples) noexcept override;
  /// Completes the header and gives the file its name.
  [[nodiscard]] Status finish();

 private:
  WavFile(std::string path, OutputFile file, int sample_rate) : path_(std::move(path)), file_(std::move(file)), sample_rate_(sample_rate) {}
  [[nodiscard]] Status put_header();

  std::string path_;
  OutputFile file_;
  int sample_rate_;  // [Hz]
  std::uint64_t samples_ = 0;
  bool too_long_ = false, finished_ = false;
};

}  // namespace burrhole
