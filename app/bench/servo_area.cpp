// The live loops: the shipped scene on threads, at rest on bone, while another thread draws pictures. Runs are interleaved with an empty
// loop of the same priority, which measures the scheduling of this machine.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "app/bench/areas.h"
#include "app/bench/bench_scene.h"
#include "app/bench/contact_bones.h"
#include "app/view/texels.h"
#include "haptics/servo/realtime.h"
#ifdef BH_WITH_RENDER
#include "app/render/renderer.h"
#include "app/view/display_config.h"
#endif

namespace burrhole {
namespace {

constexpr int kWindows = 5;
constexpr double kSettle = 2.5;         // [s] from the start until the tool rests on bone; excluded
constexpr double kWindow = 10.0;        // [s] of one measurement
constexpr double kQuickWindow = 0.5;    // [s]
constexpr double kMostCompute = 100.0;  // [us] target of the p99.9

/// Draws pictures on a thread until it goes out of scope, as the load beside a live run.
class DrawingThread {
 public:
  explicit DrawingThread(const LoadedScene& loaded) {
#ifdef BH_WITH_RENDER
    thread_ = std::thread([this, &loaded] {
      auto renderer = Renderer::create({.keep_picture = false});  // a kept picture would not be drawn again
      auto voxmap = Voxmap::create(loaded.bone, {});
      auto approach = make_approach(*loaded.bone, loaded.scene.approach);
      if (!renderer || !voxmap || !approach || !renderer->set_volume(make_volume_view(*voxmap))) return;
      const Pose world_from_approach = loaded.scene.volume.world_from_bone * approach->bone_from_approach;
      const FrameView view = make_frame_view(*loaded.scene.find<DisplayConfig>(), loaded.scene.volume.world_from_bone, world_from_approach,
                                             approach->thickness, false);
      while (!stop_.load(std::memory_order_relaxed) && renderer->draw(view, 512, 512)) frames_.fetch_add(1, std::memory_order_relaxed);
    });
#else
    static_cast<void>(loaded);
#endif
  }
  ~DrawingThread() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  DrawingThread(const DrawingThread&) = delete;
  DrawingThread& operator=(const DrawingThread&) = delete;
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> frames_{0};
  std::thread thread_;
};

/// Measures the lateness of the wake-up of an empty loop with the servo's period and priority.
StepTiming empty_loop(double seconds, double period) {
  SampleTimer late;
  std::thread loop([&] {
    (void)ask_for_fifo(kServoAbove);
    TickClock clock(now_monotonic(), period, 0.0);
    for (int n = 0; n < static_cast<int>(seconds / period); ++n) late.add(clock.wait().late_us);
  });
  loop.join();
  return late.timing();
}

/// Measures the time of constant work with the contact loop's period and priority: its spread is due to the machine. The work reads random
/// places of 4 MB, as contact reads records, so it depends on the cache use of other threads too. @param work_us [us] of one tick.
StepTiming constant_loop(double seconds, double period, double work_us) {
  constexpr std::uint32_t kBits = 20;
  const std::vector<float> table(std::size_t{1} << kBits, 0.5f);
  const auto work = [&](std::int64_t rounds) {
    volatile float sum = 0.0f;
    std::uint32_t at = 1;
    for (std::int64_t n = 0; n < rounds; ++n) {
      at = at * 1664525u + 1013904223u;
      sum = sum + table[at >> (32 - kBits)];
    }
  };
  const auto took_us = [&](std::int64_t rounds) {
    const timespec start = now_monotonic();
    work(rounds);
    return microseconds(start, now_monotonic());
  };
  constexpr std::int64_t kProbe = 2000;
  float least = took_us(kProbe);
  for (int n = 0; n < 50; ++n) least = std::min(least, took_us(kProbe));
  const auto rounds = static_cast<std::int64_t>(work_us / static_cast<double>(least) * static_cast<double>(kProbe));
  SampleTimer took;
  std::thread loop([&] {
    (void)ask_for_fifo(kContactAbove);
    TickClock clock(now_monotonic(), period, 0.0);
    for (int n = 0; n < static_cast<int>(seconds / period); ++n) {
      (void)clock.wait();
      took.add(took_us(rounds));
    }
  });
  loop.join();
  return took.timing();
}

struct Window {
  StepTiming servo, contact, late, empty, constant;
  std::uint64_t missed = 0;
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

double median_of(const std::vector<Window>& windows, StepTiming Window::*step, double StepTiming::*figure) {
  std::vector<double> values;
  for (const Window& window : windows) values.push_back(window.*step.*figure);
  return median(std::move(values));
}

/// Runs the shipped live loops with the bit at rest on bone under thrust. @returns the timings without the first `settle` [s]: percentiles are those
/// of a histogram, at most 1.6 % too large.
Result<Window> live_window(const LoadedScene& loaded, double settle, std::string& refused) {
  SimulationOptions options;
  options.live = true;
  options.untimed = settle;
  options.warn = [&](const std::string& text) { refused = text; };
  Issues issues;
  auto simulation = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  if (!simulation) return issues.front();
  if (Status ran = simulation->run(); !ran) return ran.error();
  const LiveReport& live = *simulation->live();
  if (simulation->progress().peak_force < 1.0) return Error{ErrorCode::internal, "the tool does not rest on bone", {}};
  return Window{live.servo.timing(),
                live.contact.timing(),
                live.servo_late.timing(),
                {},
                {},
                live.servo_skipped + live.contact_skipped + live.bone_skipped + live.unrecorded};
}

Status measure(Bench& bench, const std::string& what, const LoadedScene& loaded, double seconds, bool spread) {
  std::vector<Window> windows;
  std::string refused;
  const int count = bench.quick() ? 1 : kWindows;
  for (int n = 0; n < count; ++n) {
    auto window = live_window(loaded, bench.quick() ? 0.0 : kSettle, refused);
    if (!window) return window.error();
    window->empty = empty_loop(seconds, 1.0 / loaded.scene.servo_hz);
    window->constant = constant_loop(seconds, 1.0 / loaded.scene.effects.needs(loaded.scene).contact_hz, window->contact.p50_us);
    windows.push_back(*window);
  }
  if (!refused.empty()) fmt::print(stderr, "bench: servo: {}; the figures below were measured without it\n", refused);
  const auto name = [&](const char* figure) { return what + ": " + figure; };
  const auto p999 = &StepTiming::p999_us;
  const auto us = [&](const char* figure, StepTiming Window::*step, double StepTiming::*of, const Bars& bars) {
    bench.add_absolute(name(figure), "us", median_of(windows, step, of), true, bars);
  };
  us("servo compute, p99.9", &Window::servo, p999, {kMostCompute, {}});
  us("contact compute, p99.9", &Window::contact, p999, {kMostCompute, {}});
  us("servo compute, longest", &Window::servo, &StepTiming::max_us, {});
  us("contact compute, longest", &Window::contact, &StepTiming::max_us, {});
  us("servo wake-up lateness, p99.9", &Window::late, p999, {});
  us("servo wake-up lateness, longest", &Window::late, &StepTiming::max_us, {});
  us("wake-up lateness of an empty loop, p99.9", &Window::empty, p999, {});
  us("constant work of the same length, p99.9", &Window::constant, p999, {});
  std::vector<double> over_empty, over_median, constant_over_median, kept;
  for (const Window& w : windows) {
    over_empty.push_back(w.late.p999_us / w.empty.p999_us);
    over_median.push_back(w.contact.p999_us / w.contact.p50_us);
    constant_over_median.push_back(w.constant.p999_us / w.constant.p50_us);
    const double due = static_cast<double>(w.servo.count + w.contact.count);
    kept.push_back(due / (due + static_cast<double>(w.missed)));
  }
  bench.add_absolute(name("servo wake-up lateness over an empty loop, p99.9"), "1", median(over_empty), true, {1.5, 1.1});
  bench.add_absolute(name("contact compute, p99.9 over p50"), "1", median(over_median), true, spread ? Bars{2.0, 1.4} : Bars{});
  bench.add_absolute(name("constant work, p99.9 over p50"), "1", median(constant_over_median), true);
  bench.add_absolute(name("share of ticks, steps and recorded rows that were not skipped"), "1", median(kept), false);
  return {};
}

/// Replays a live run and compares the forces bit for bit; a difference means that the timed loops do not compute what is recorded.
Status compare_replay(Bench& bench, const std::string& what, const LoadedScene& loaded) {
  const std::string path = (std::filesystem::temp_directory_path() / fmt::format("burrhole-bench-{}.sqlite", ::getpid())).string();
  struct Remove {
    std::string path;
    ~Remove() {
      std::error_code ignored;
      for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(path + suffix, ignored);
    }
  } const remove{path};
  SimulationOptions options;
  options.live = true;
  Issues issues;
  auto live = Simulation::create(loaded.scene, loaded.bone, loaded.tool, options, issues);
  if (!live) return issues.front();
  auto writer = SessionWriter::create(path, {}, session_layout(live->stage()));
  if (!writer) return writer.error();
  live->set_session(&*writer);
  if (Status ran = live->run(); !ran) return ran.error();
  if (Status closed = writer->close(); !closed) return closed;

  auto session = SessionReader::open(path);
  if (!session) return session.error();
  auto hand = RecordedHand::create(*session);
  if (!hand) return hand.error();
  SimulationOptions again;
  again.hand = &*hand;
  auto replayed = Simulation::create(loaded.scene, loaded.bone, loaded.tool, again, issues);
  if (!replayed) return issues.front();
  if (Status ran = replayed->run_recorded(*session, *hand); !ran) return ran.error();
  const std::array<std::uint64_t, 2> recorded{live->force_hash(), live->sent_hash()}, fed{replayed->force_hash(), replayed->sent_hash()};
  bench.agree(what + ": a live run and its record fed again", bytes_of(recorded), bytes_of(fed));
  return {};
}

/// The price of friction where it is largest: a flat bit pressed on bone and held by stiction, in lockstep, against the same without.
Status measure_friction(Bench& bench) {
  struct Times {
    StepTiming servo, contact;
    std::uint64_t force_hash = 0;
  };
  const auto times_of = [&](bool friction) -> Result<Times> {
    std::vector<std::string> sets{"tool.name=trephine_12mm", "tool.spin_rpm=0", "hand.standoff_mm=0.2", "hand.ramp_s=0.1",
                                  fmt::format("duration_s={}", bench.quick() ? 0.5 : 1.5)};
    if (friction) sets.emplace_back("friction.static_coefficient=0.4");
    auto loaded = load_parietal_scene(sets);
    if (!loaded) return loaded.error();
    Issues issues;
    auto simulation = Simulation::create((*loaded)->scene, (*loaded)->bone, (*loaded)->tool, {}, issues);
    if (!simulation) return issues.front();
    if (Status ran = simulation->run(); !ran) return ran.error();
    return Times{simulation->timing("servo"), simulation->timing("contact"), simulation->force_hash()};
  };
  const auto without = times_of(false), with = times_of(true), again = times_of(true);
  for (const auto* times : {&without, &with, &again})
    if (!*times) return times->error();
  const std::string what = "trephine held by friction";
  const std::array<std::uint64_t, 1> first{with->force_hash}, second{again->force_hash};
  bench.agree(what + ": two runs", bytes_of(first), bytes_of(second));
  bench.add_absolute(what + ": servo compute, p99", "us", with->servo.p99_us, true, {kMostCompute, {}});
  bench.add_absolute(what + ": servo compute without friction, p99", "us", without->servo.p99_us, true);
  bench.add_absolute(what + ": contact compute, p99", "us", with->contact.p99_us, true);
  bench.add_absolute(what + ": contact compute without friction, p99", "us", without->contact.p99_us, true);
  return {};
}

}  // namespace

Status bench_servo(Bench& bench) {
  const double seconds = bench.quick() ? kQuickWindow : kWindow;
  for (const BallSize& size : {BallSize{23, 50, 729}, BallSize{66, 138, 5800}}) {
    auto loaded = load_parietal_scene({"tool.spin_rpm=0", "hand.standoff_mm=0.2", "hand.ramp_s=0.1",
                                       fmt::format("duration_s={}", bench.quick() ? seconds : kSettle + seconds)});
    if (!loaded) return loaded.error();
    LoadedScene& scene = **loaded;
    auto shell = make_ball(size.stacks, size.slices, size.points);
    if (!shell) return shell.error();
    scene.tool.shell = std::move(shell).value();
    const std::string what = fmt::format("{} points at rest on bone", size.points);
    if (Status compared = compare_replay(bench, what, scene); !compared) return compared;
    const DrawingThread drawing(scene);
    if (Status done = measure(bench, what, scene, seconds, size.points > 1000); !done) return done;
    bench.add_absolute(what + ": pictures of 512 x 512 drawn meanwhile", "1", static_cast<double>(drawing.frames()), false);
  }
  return measure_friction(bench);
}

}  // namespace burrhole
