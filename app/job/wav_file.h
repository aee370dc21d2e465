/// app/job/wav_file.h: a WAV file of 16 bits, mono, written while a run goes on.
///   Errors  bad_input with the path: it cannot be written, or it would exceed 4 GB.   Thread  one.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/sound/sound_sink.h"

namespace burrhole {

class WavFile final : public SoundSink {
 public:
  /// Writes to `path` + ".part" until finish(). @param sample_rate [Hz] > 0.
  [[nodiscard]] static Result<std::unique_ptr<WavFile>> create(const std::string& path, int sample_rate);
  WavFile(const WavFile&) = delete;
  WavFile& operator=(const WavFile&) = delete;
  /// Without finish() no file is left.
  ~WavFile() override;

  /// Samples become sample16() (core/sound/sample16.h). An error is kept for finish().
  void write(std::span<const float> samples) noexcept override;
  /// Completes the header and gives the file its name.
  [[nodiscard]] Status finish();

 private:
  WavFile(std::string path, std::FILE* file, int sample_rate) : path_(std::move(path)), file_(file), sample_rate_(sample_rate) {}
  [[nodiscard]] bool put_header() noexcept;

  std::string path_;
  std::FILE* file_;
  int sample_rate_;  // [Hz]
  std::uint64_t samples_ = 0;
  bool failed_ = false, too_long_ = false;
};

}  // namespace burrhole
