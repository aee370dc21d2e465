/// app/job/sound_out.h: where the sound of a run goes: sound.wav in its folder, a sound device, both, or nowhere.
///   Errors  bad_input of WavFile.   Thread  the one that runs the audio clock.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "app/job/wav_file.h"
#include "app/stage/result_files.h"
#include "core/sound/drill_sound.h"

namespace burrhole {

/// Opens a sound device. @param sample_rate [Hz]. @returns null if there is none; the reason was reported then.
using MakeSpeaker = std::function<std::unique_ptr<SoundSink>(int sample_rate)>;

class SoundOut final : public SoundSink {
 public:
  /// @param config null: the scene has no [sound]. @param folder of the outputs; empty: no file. @param make_speaker may be empty.
  SoundOut(const SoundConfig* config, const std::string& folder, const MakeSpeaker& make_speaker);
  /// @returns itself, or null if the sound goes nowhere.
  [[nodiscard]] SoundSink* sink() noexcept { return path_.empty() && speaker_ == nullptr ? nullptr : this; }
  /// Opens the file, whose folder must be there.
  [[nodiscard]] Status open();
  void write(std::span<const float> samples) noexcept override;
  /// Closes the device and completes the file.
  [[nodiscard]] Status finish();

 private:
  std::string path_;  // of the file; empty: none
  int sample_rate_ = 0;
  std::unique_ptr<WavFile> wav_;
  std::unique_ptr<SoundSink> speaker_;
};

}  // namespace burrhole
