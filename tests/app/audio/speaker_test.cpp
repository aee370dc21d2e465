// The sound device without one: OpenAL Soft's driver "wave" writes into a file what a device would be sent.

#include "app/audio/speaker.h"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "core/sound/sample16.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;

namespace {

constexpr int kRate = 48000;

/// Samples of the 16-bit file that the driver wrote, after its header.
std::vector<std::int16_t> recorded(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t data = bytes.find("data");
  REQUIRE(data != std::string::npos);
  std::vector<std::int16_t> out;
  for (std::size_t n = data + 8; n + 1 < bytes.size(); n += 2)
    out.push_back(static_cast<std::int16_t>(static_cast<unsigned char>(bytes[n]) | static_cast<unsigned char>(bytes[n + 1]) << 8));
  return out;
}

void use_wave_driver(const TemporaryFolder& folder) {
  std::ofstream(folder.file("alsoft.conf")) << "[general]\ndrivers = wave\nchannels = mono\nsample-type = int16\nfrequency = " << kRate
                                            << "\noutput-limiter = false\ndither = false\nvolume-adjust = 0\n[wave]\nfile = "
                                            << folder.file("heard.wav") << "\n";
  ::setenv("ALSOFT_CONF", folder.file("alsoft.conf").c_str(), 1);
}

}  // namespace

TEST_CASE("speaker: the device receives the samples that were written, each once and in order") {
  const TemporaryFolder folder;
  use_wave_driver(folder);
  std::vector<float> sent;
  for (int n = 0; n < 60 * kRate / 100; ++n) {
    const double x = static_cast<double>(n) / kRate;
    sent.push_back(static_cast<float>(0.5 * std::sin(2.0 * 3.141592653589793 * (300.0 + 200.0 * x) * x)) + 0.001f);
  }
  {
    auto speaker = Speaker::open(kRate);
    REQUIRE_MESSAGE(speaker.ok(), (speaker ? "" : speaker.error().message));
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t block = 0; block < 60; ++block) {
      (*speaker)->write(std::span(sent).subspan(block * 480, 480));
      std::this_thread::sleep_until(start + std::chrono::milliseconds(10) * (block + 1));
    }
    // A busy machine may let the queue run empty or over; what is heard is then the same with silence or gaps, and this test says nothing.
    if ((*speaker)->underruns() + (*speaker)->dropped() > 0) {
      MESSAGE("underruns ", (*speaker)->underruns(), ", dropped ", (*speaker)->dropped());
      return;
    }
  }
  const std::vector<std::int16_t> heard = recorded(folder.file("heard.wav"));
  std::size_t first = 0;
  while (first < heard.size() && heard[first] == 0) ++first;
  REQUIRE(first + sent.size() <= heard.size());
  // OpenAL mixes in floats and fades a source in over its first mix, of at most a period of the device.
  constexpr std::size_t kFadeIn = kRate / 25;
  // The first samples may be lost to the fade: the place is that of the best match.
  std::size_t best = 0;
  double least = 1e30;
  for (std::size_t lag = 0; lag <= 64 && lag <= first; ++lag) {
    double sum = 0.0;
    for (std::size_t n = kFadeIn; n < kFadeIn + 4800; ++n) sum += std::abs(heard[first - lag + n] - sample16(sent[n]));
    if (sum < least) least = sum, best = first - lag;
  }
  int largest = 0;
  for (std::size_t n = kFadeIn; n < sent.size(); ++n) largest = std::max(largest, std::abs(heard[best + n] - sample16(sent[n])));
  CHECK(largest <= 1);  // a rounding of floats
}
