#include "app/audio/speaker.h"

#include <dlfcn.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "app/audio/openal_library.h"
#include "core/sound/sample16.h"

namespace burrhole {
namespace {

constexpr int kRefreshHz = 100;  // of the device: a period of 10 ms, where it allows that
constexpr auto kPoll = std::chrono::milliseconds(5);
constexpr int kMostPolls = 40;

bool is_set(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

void ignore_message(const char*, int, const char*, int, const char*, ...) {}

Error unavailable(const char* why) { return {ErrorCode::unavailable, why, {}}; }

}  // namespace

struct Speaker::Device {
  OpenAl al;
  ALCdevice* device = nullptr;
  ALCcontext* context = nullptr;
  ALuint source = 0;
  std::array<ALuint, kMostBlocks> buffers{};
  std::vector<ALuint> free;
  std::vector<std::int16_t> samples;
  int sample_rate = 0;
  bool sounds = false;
  Report report;
  std::uint64_t underruns = 0, dropped = 0;

  ~Device() {
    if (source != 0) {
      al.SourceStop(source);
      al.DeleteSources(1, &source);
      al.DeleteBuffers(kMostBlocks, buffers.data());
    }
    if (context != nullptr) {
      al.cMakeContextCurrent(nullptr);
      al.cDestroyContext(context);
    }
    if (device != nullptr) al.cCloseDevice(device);
  }
  [[nodiscard]] ALint get(ALenum what) const {
    ALint value = 0;
    al.GetSourcei(source, what, &value);
    return value;
  }
  /// Takes back the buffers that were heard, and notes that the queue ran empty.
  void collect() {
    for (ALint done = get(AL_BUFFERS_PROCESSED); done > 0; --done) {
      ALuint buffer = 0;
      al.SourceUnqueueBuffers(source, 1, &buffer);
      free.push_back(buffer);
    }
    if (sounds && get(AL_SOURCE_STATE) != AL_PLAYING) {
      ++underruns;
      sounds = false;
    }
  }
};

Speaker::Speaker(std::unique_ptr<Device> device) : device_(std::move(device)) {}

Result<std::unique_ptr<Speaker>> Speaker::open(int sample_rate, Report report) {
  auto library = load_openal();
  if (!library) return library.error();
  auto out = std::make_unique<Device>();
  out->al = *library;
  out->sample_rate = sample_rate;
  out->report = std::move(report);
  out->device = out->al.cOpenDevice(nullptr);
  if (out->device == nullptr) return unavailable("OpenAL finds no sound device");
  const char* const name = out->al.cGetString(out->device, ALC_DEVICE_SPECIFIER);
  if (name != nullptr && std::strcmp(name, "No Output") == 0 && !is_set("ALSOFT_DRIVERS") && !is_set("ALSOFT_CONF"))
    return unavailable("there is no sound device");
  const ALCint wanted[] = {ALC_FREQUENCY, sample_rate, ALC_REFRESH, kRefreshHz, 0};
  out->context = out->al.cCreateContext(out->device, wanted);
  if (out->context == nullptr || out->al.cMakeContextCurrent(out->context) == ALC_FALSE)
    return unavailable("OpenAL cannot start the sound device");
  out->al.GenSources(1, &out->source);
  out->al.GenBuffers(kMostBlocks, out->buffers.data());
  if (out->al.GetError() != AL_NO_ERROR) return unavailable("OpenAL cannot make a source of sound");
  out->free.assign(out->buffers.begin(), out->buffers.end());
  return std::unique_ptr<Speaker>(new Speaker(std::move(out)));
}

Speaker::~Speaker() {
  for (int n = 0; n < kMostPolls && device_->sounds && device_->get(AL_SOURCE_STATE) == AL_PLAYING; ++n) std::this_thread::sleep_for(kPoll);
  if (device_->report) device_->report(device_->underruns, device_->dropped);
}

void Speaker::silence_libraries() {
  ::setenv("ALSOFT_LOGLEVEL", "0", 0);
  if (void* const alsa = dlopen("libasound.so.2", RTLD_NOW | RTLD_LOCAL); alsa != nullptr) {
    using Handler = decltype(&ignore_message);
    // int snd_lib_error_set_handler(snd_lib_error_handler_t), of ALSA.
    const auto set = reinterpret_cast<int (*)(Handler)>(dlsym(alsa, "snd_lib_error_set_handler"));
    if (set != nullptr) set(&ignore_message);
  }
}

void Speaker::write(std::span<const float> samples) noexcept {
  Device& d = *device_;
  d.collect();
  if (d.free.empty()) {
    ++d.dropped;
    return;
  }
  d.samples.resize(samples.size());
  for (std::size_t n = 0; n < samples.size(); ++n) d.samples[n] = sample16(samples[n]);
  const ALuint buffer = d.free.back();
  d.free.pop_back();
  d.al.BufferData(buffer, AL_FORMAT_MONO16, d.samples.data(), static_cast<ALsizei>(samples.size() * sizeof(std::int16_t)), d.sample_rate);
  d.al.SourceQueueBuffers(d.source, 1, &buffer);
  if (d.sounds || d.get(AL_BUFFERS_QUEUED) < kStartBlocks) return;
  d.al.SourcePlay(d.source);
  d.sounds = true;
}

std::uint64_t Speaker::underruns() const noexcept { return device_->underruns; }
std::uint64_t Speaker::dropped() const noexcept { return device_->dropped; }

}  // namespace burrhole
