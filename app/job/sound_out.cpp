#include "app/job/sound_out.h"

#include <filesystem>

namespace burrhole {

SoundOut::SoundOut(const SoundConfig* config, const std::string& folder, const MakeSpeaker& make_speaker) {
  if (config == nullptr) return;
  sample_rate_ = config->sample_rate;
  if (config->wav && !folder.empty()) path_ = (std::filesystem::path(folder) / kSoundFile).string();
  if (make_speaker) speaker_ = make_speaker(sample_rate_);
}

Status SoundOut::open() {
  if (path_.empty()) return {};
  auto file = WavFile::create(path_, sample_rate_);
  if (!file) return file.error();
  wav_ = std::move(file).value();
  return {};
}

void SoundOut::write(std::span<const float> samples) noexcept {
  if (wav_ != nullptr) wav_->write(samples);
  if (speaker_ != nullptr) speaker_->write(samples);
}

Status SoundOut::finish() {
  speaker_.reset();
  return wav_ != nullptr ? wav_->finish() : Status();
}

}  // namespace burrhole
