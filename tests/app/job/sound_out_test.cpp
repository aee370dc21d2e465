#include "app/job/sound_out.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "app/job/drill_job.h"
#include "core/sound/sample16.h"
#include "tests/support/drill_scene.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

namespace fs = std::filesystem;

std::uint32_t number_at(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint32_t out = 0;
  for (std::size_t n = 0; n < size; ++n) out |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + n])) << (8 * n);
  return out;
}

class Heard final : public SoundSink {
 public:
  explicit Heard(std::vector<float>& all) : all_(&all) {}
  void write(std::span<const float> samples) noexcept override { all_->insert(all_->end(), samples.begin(), samples.end()); }

 private:
  std::vector<float>* all_;
};

LoadedScene scene_with(const std::string& sound) {
  SmallScene scene{.record = true, .sets = {"duration_s=0.5", "hand.standoff_mm=0.5"}};
  if (!sound.empty()) scene.sets.push_back(sound);
  return load_small(scene);
}

}  // namespace

TEST_CASE("wav: a sample is rounded to 16 bits, and clamped") {
  CHECK(sample16(0.0f) == 0);
  CHECK(sample16(1.0f) == 32767);
  CHECK(sample16(-1.0f) == -32767);
  CHECK(sample16(7.0f) == 32767);
  CHECK(sample16(0.5f) == 16384);  // 16383.5, away from zero
  CHECK(sample16(-0.5f) == -16384);
}

TEST_CASE("wav: the header states format and size, and the file has its name once it is complete") {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.wav");
  std::vector<float> samples;
  for (int n = 0; n < 1500; ++n) samples.push_back(std::sin(0.01f * static_cast<float>(n)));
  {
    auto file = WavFile::create(path, 44100);
    REQUIRE(file);
    (*file)->write(samples);
    CHECK_FALSE(fs::exists(path));
    REQUIRE((*file)->finish());
  }
  const std::string bytes = bytes_of(path);
  REQUIRE(bytes.size() == 44 + 2 * samples.size());
  CHECK(bytes.substr(0, 4) == "RIFF");
  CHECK(number_at(bytes, 4, 4) == bytes.size() - 8);
  CHECK(bytes.substr(8, 8) == "WAVEfmt ");
  CHECK(number_at(bytes, 20, 2) == 1);  // linear PCM
  CHECK(number_at(bytes, 22, 2) == 1);
  CHECK(number_at(bytes, 24, 4) == 44100);
  CHECK(number_at(bytes, 28, 4) == 88200);
  CHECK(number_at(bytes, 34, 2) == 16);
  CHECK(bytes.substr(36, 4) == "data");
  CHECK(number_at(bytes, 40, 4) == 2 * samples.size());
  bool equal = true;
  for (std::size_t n = 0; n < samples.size(); ++n)
    equal = equal && static_cast<std::int16_t>(number_at(bytes, 44 + 2 * n, 2)) == sample16(samples[n]);
  CHECK(equal);
  // A run that fails leaves none.
  { REQUIRE(WavFile::create(folder.file("b.wav"), 44100)); }
  CHECK(std::distance(fs::directory_iterator(fs::path(path).parent_path()), {}) == 1);
  CHECK_FALSE(WavFile::create(path + "/below.wav", 44100).ok());
}

TEST_CASE("job: a scene with [sound] writes sound.wav, and what a device receives is the same") {
  const TemporaryFolder folder;
  std::vector<float> heard;
  DrillJob job;
  job.folder = folder.file("out");
  int rate = 0;
  job.make_speaker = [&](int sample_rate) {
    rate = sample_rate;
    return std::make_unique<Heard>(heard);
  };
  const auto summary = drill(scene_with("sound={sample_rate_hz=44100}"), job);
  REQUIRE_MESSAGE(summary.ok(), (summary ? "" : summary.error().text()));
  CHECK(rate == 44100);
  const std::string bytes = bytes_of(folder.file("out/sound.wav"));
  REQUIRE(heard.size() == 22050);
  REQUIRE(bytes.size() == 44 + 2 * heard.size());
  bool equal = true;
  for (std::size_t n = 0; n < heard.size(); ++n)
    equal = equal && static_cast<std::int16_t>(number_at(bytes, 44 + 2 * n, 2)) == sample16(heard[n]);
  CHECK(equal);

  // The same job again gives the same bytes; without wav, or without the table, there is no file, also of the run before.
  job.make_speaker = {};
  REQUIRE(drill(scene_with("sound={sample_rate_hz=44100}"), job));
  CHECK(bytes_of(folder.file("out/sound.wav")) == bytes);
  REQUIRE(drill(scene_with("sound={wav=false}"), job));
  CHECK_FALSE(fs::exists(folder.file("out/sound.wav")));
  REQUIRE(drill(scene_with("sound={}"), job));
  CHECK(fs::exists(folder.file("out/sound.wav")));
  job.make_speaker = [&](int) -> std::unique_ptr<SoundSink> {
    rate = -1;
    return nullptr;
  };
  REQUIRE(drill(scene_with(""), job));
  CHECK_FALSE(fs::exists(folder.file("out/sound.wav")));
  CHECK(rate != -1);                                     // no device is opened for a scene without [sound]
  REQUIRE(drill(scene_with("sound={wav=false}"), job));  // no device and no file: the run goes on
  CHECK(rate == -1);
}
