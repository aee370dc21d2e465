// Runs a scene in lockstep and lets callgrind count the instructions of a tenth of a simulated second, deep enough in for the bit to cut. Prints what
// else an effect may cost: bytes that are allocated and not given back, allocations, threads, columns of a session, what a display receives.
//   steady_ticks SCENE TOOL_FOLDER [--picture] [--thread] [KEY=VALUE...]       see absent_effect_test.py

#include <valgrind/callgrind.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <string>
#include <thread>

#include "app/effect/registry.h"
#include "app/run/simulation.h"
#include "app/scene/load.h"
#include "app/view/frame_step.h"
#include "core/base/simd.h"

namespace {

/// Sum of the sizes asked for and not given back, and how often one was asked for. The size stands before each block.
std::atomic<std::size_t> live_bytes{0}, allocations{0};

[[gnu::noinline]] void* allocate(std::size_t size, std::size_t alignment) {
  const std::size_t whole = (size + 2 * alignment - 1) / alignment * alignment;
  auto* block = static_cast<std::byte*>(std::aligned_alloc(alignment, whole));
  if (block == nullptr) throw std::bad_alloc();
  std::byte* at = block + alignment;
  std::memcpy(at - sizeof size, &size, sizeof size);
  live_bytes += size;
  ++allocations;
  return at;
}
[[gnu::noinline]] void release(void* at, std::size_t alignment) noexcept {
  if (at == nullptr) return;
  std::size_t size = 0;
  std::memcpy(&size, static_cast<std::byte*>(at) - sizeof size, sizeof size);
  live_bytes -= size;
  std::free(static_cast<std::byte*>(at) - alignment);
}
constexpr std::size_t kUsual = __STDCPP_DEFAULT_NEW_ALIGNMENT__;
constexpr std::size_t of(std::align_val_t alignment) { return static_cast<std::size_t>(alignment); }

}  // namespace

void* operator new(std::size_t size) { return allocate(size, kUsual); }
void* operator new[](std::size_t size) { return allocate(size, kUsual); }
void* operator new(std::size_t size, std::align_val_t a) { return allocate(size, of(a)); }
void* operator new[](std::size_t size, std::align_val_t a) { return allocate(size, of(a)); }
void operator delete(void* at) noexcept { release(at, kUsual); }
void operator delete[](void* at) noexcept { release(at, kUsual); }
void operator delete(void* at, std::size_t) noexcept { release(at, kUsual); }
void operator delete[](void* at, std::size_t) noexcept { release(at, kUsual); }
void operator delete(void* at, std::align_val_t a) noexcept { release(at, of(a)); }
void operator delete[](void* at, std::align_val_t a) noexcept { release(at, of(a)); }
void operator delete(void* at, std::size_t, std::align_val_t a) noexcept { release(at, of(a)); }
void operator delete[](void* at, std::size_t, std::align_val_t a) noexcept { release(at, of(a)); }

namespace burrhole {
namespace {

/// A display that counts what it receives. A renderer links programs for that alone: those of what effects add when set_added() brings some, those of
/// soft tissue when texels are soft (app/render/renderer_passes.cpp).
class CountingSink final : public FrameSink {
 public:
  Status start(const VolumeView& volume, const TriangleMesh&) override {
    texels += volume.normal_opacity.size();
    tissue += volume.tissue.size();
    for (const Rgba8& color : volume.color) soft += color.a > 0 ? 1 : 0;
    return {};
  }
  void update(const TexelBox& box) override { texels += box.normal_opacity.size(); }
  Status set_added(const std::shared_ptr<const AddedMesh>& mesh) override {
    added += mesh != nullptr ? 1 : 0;
    return {};
  }
  Status draw(const std::string&, const FrameView&, int, int, Hash64&) override {
    ++pictures;
    return {};
  }
  std::size_t texels = 0, tissue = 0, soft = 0, added = 0, pictures = 0;
};

/// @returns the threads of this process.
long threads_now() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("Threads:")) return std::atol(line.c_str() + std::strlen("Threads:"));
  return 0;
}

struct Arguments {
  bool picture = false, thread = false;
};

/// Prints what is in use. @param before bytes and allocations that do not count.
void print_use(const char* when, std::size_t bytes_before, std::size_t allocations_before) {
  const std::size_t bytes = live_bytes - bytes_before, count = allocations - allocations_before;
  std::printf("%s_bytes=%zu %s_allocations=%zu %s_threads=%ld\n", when, bytes, when, count, when, threads_now());
}

SimulationOptions options_of(std::atomic<bool>& stop) {
  constexpr double kFrom = 1.95, kUntil = 2.05;  // [s] progress comes ten times a second, at 2.0 and 2.1
  SimulationOptions options;
  options.stop = &stop;
  options.progress = [&stop](double time, const DrillProgress&) {
    if (time > kUntil) {
      CALLGRIND_STOP_INSTRUMENTATION;
      stop = true;
    } else if (time > kFrom) {
      CALLGRIND_START_INSTRUMENTATION;
    }
  };
  return options;
}

int run(const TomlDocument& document, const char* tools, const Arguments& arguments) {
  Issues issues;
  const auto loaded = load_scene(document, {.tool_folders = {tools}}, issues);
  if (!loaded) return std::puts(issues.front().text().c_str()), 2;
  std::atomic<bool> stop{false};
  SimulationOptions options = options_of(stop);
  CountingSink sink;
  if (arguments.picture) options.sink = &sink;
  const std::size_t bytes = live_bytes, count = allocations;
  auto simulation = Simulation::create(loaded->scene, loaded->bone, loaded->tool, options, issues);
  if (!simulation) return std::puts(issues.front().text().c_str()), 2;
  std::thread idle;
  if (arguments.thread) idle = std::thread([&stop] { stop.wait(false); });
  print_use("ready", bytes, count);
  if (const Status ran = simulation->run(); !ran) return std::puts(ran.error().text().c_str()), 1;
  print_use("ran", bytes, count);
  stop = true;
  stop.notify_all();
  if (idle.joinable()) idle.join();
  std::size_t columns = 0;
  for (const Clock clock : {Clock::servo, Clock::contact, Clock::simulation}) columns += simulation->stage().graph.columns(clock).size();
  std::printf("columns=%zu\ntexels=%zu tissue=%zu soft=%zu added=%zu pictures=%zu\n", columns, sink.texels, sink.tissue, sink.soft,
              sink.added, sink.pictures);
  std::printf("hash %016llx after %llu ticks\n", static_cast<unsigned long long>(simulation->voxmap().hash()),
              static_cast<unsigned long long>(simulation->ticks()));
  return 0;
}

}  // namespace
}  // namespace burrhole

int main(int argc, char** argv) {
  using namespace burrhole;
  if (argc < 3) return std::fputs("usage: steady_ticks SCENE TOOL_FOLDER [--picture] [--thread] [KEY=VALUE...]\n", stderr), 2;
  auto document = TomlDocument::load(argv[1]);
  if (!document) return std::puts(document.error().text().c_str()), 2;
  Arguments arguments;
  for (int n = 3; n < argc; ++n) {
    const std::string one = argv[n];
    arguments.picture |= one == "--picture";
    arguments.thread |= one == "--thread";
    if (one.starts_with("--")) continue;
    if (const Status set = document->set(one); !set) return std::puts(set.error().text().c_str()), 2;
  }
  if (const Status level = choose_simd("avx2"); !level) return std::puts(level.error().text().c_str()), 4;
  (void)shipped_effects();  // the registry itself is no cost of a scene
  return run(*document, argv[2], arguments);
}
