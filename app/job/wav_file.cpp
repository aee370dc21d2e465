#include "app/job/wav_file.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/sound/sample16.h"

namespace burrhole {
namespace {

constexpr std::uint64_t kHeaderBytes = 44, kSampleBytes = 2;
constexpr std::uint64_t kMostSamples = (0xffffffffull - kHeaderBytes) / kSampleBytes;

}  // namespace

Result<std::unique_ptr<WavFile>> WavFile::create(const std::string& path, int sample_rate) {
  auto file = OutputFile::create(path);
  if (!file) return file.error();
  std::unique_ptr<WavFile> out(new WavFile(path, std::move(file).value(), sample_rate));
  if (Status begun = out->put_header(); !begun) return begun.error();
  return out;
}

/// RIFF header of linear PCM; numbers are little-endian.
Status WavFile::put_header() {
  std::array<unsigned char, kHeaderBytes> bytes{'R', 'I', 'F', 'F', 0, 0, 0, 0, 'W', 'A', 'V', 'E', 'f', 'm', 't', ' '};
  const auto put = [&](std::size_t at, std::size_t size, std::uint64_t value) {
    for (std::size_t n = 0; n < size; ++n) bytes[at + n] = static_cast<unsigned char>(value >> (8 * n) & 0xff);
  };
  const auto rate = static_cast<std::uint64_t>(sample_rate_);
  const std::uint64_t data = samples_ * kSampleBytes;
  put(4, 4, kHeaderBytes - 8 + data);
  put(16, 4, 16);  // bytes of this part
  put(20, 2, 1);   // linear PCM
  put(22, 2, 1);   // channels
  put(24, 4, rate);
  put(28, 4, rate * kSampleBytes);  // bytes a second
  put(32, 2, kSampleBytes);
  put(34, 2, 8 * kSampleBytes);  // bits of a sample
  std::copy_n("data", 4, bytes.begin() + 36);
  put(40, 4, data);
  return file_.write(std::as_bytes(std::span(bytes)));
}

void WavFile::write(std::span<const float> samples) noexcept {
  std::array<unsigned char, 1024> bytes{};
  while (!samples.empty() && !too_long_) {
    const auto now = samples.first(std::min(samples.size(), bytes.size() / kSampleBytes));
    samples = samples.subspan(now.size());
    too_long_ = samples_ + now.size() > kMostSamples;
    if (too_long_) return;
    for (std::size_t n = 0; n < now.size(); ++n) {
      const auto value = static_cast<std::uint16_t>(sample16(now[n]));
      bytes[2 * n] = static_cast<unsigned char>(value & 0xff);
      bytes[2 * n + 1] = static_cast<unsigned char>(value >> 8);
    }
    if (!file_.write(std::as_bytes(std::span(bytes)).first(kSampleBytes * now.size()))) return;
    samples_ += now.size();
  }
}

Status WavFile::finish() {
  if (std::exchange(finished_, true)) return {};
  if (Status moved = file_.seek(0); !moved) return moved;
  if (Status completed = put_header(); !completed) return completed;
  if (const auto done = file_.commit(); !done) return done.error();
  if (too_long_) return bad_input("the sound file holds only the first 4 GB of the run", path_);
  return {};
}

}  // namespace burrhole
