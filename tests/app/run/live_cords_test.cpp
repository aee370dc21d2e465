// The cords of a live run, each pulled while bone pushes on the hand: a device that is gone, a contact that stands still, an exception on
// another thread. Whatever it is, the force on the hand ends at zero.
//   Counted in ticks of the hand, never in time: a busy machine sleeps through some.
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <new>
#include <stdexcept>

#include "app/run/live_run.h"
#include "tests/support/drill_scene.h"

namespace {

// Memory that is refused to one thread alone: all others say that they are not it.
std::atomic<bool> refuse{false};
thread_local bool spared = false;

}  // namespace

void* operator new(std::size_t size) {
  if (!spared && refuse.load(std::memory_order_relaxed)) throw std::bad_alloc();
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace burrhole;
using namespace burrhole::test;

namespace {

constexpr double kPressed = 1.0;         // [N] at which a cord is pulled
constexpr std::uint64_t kAfter = 400;    // ticks that are looked at after it
constexpr std::uint64_t kMost = 60'000;  // ticks within which it must be pulled
constexpr std::uint64_t kStale = 10;     // ticks until contact is told to be stale, as the scene has it
constexpr std::uint64_t kFade = 50;      // ticks of soft_stop_s
// [ticks] by which a look that was under way may be told late: on a busy machine contact is held up within it.
constexpr std::uint64_t kLate = 200;

/// The scene's own hand, and what happens once bone pushes on it.
class CordHand final : public HandSource {
 public:
  explicit CordHand(const LoadedScene& loaded) : hand_(loaded, [] {}) {}

  const HandState& read() noexcept override {
    spared = true;
    told_ = hand_.read();
    if (pulled && unplugged) told_.flags |= kHandLost;
    return told_;
  }
  void apply(const Wrench& on_hand) noexcept override {
    last = glm::length(on_hand.force);
    if (pulled) {
      if (after < forces.size()) forces[after] = last;
      if (++after == kAfter && at_end) at_end();
    } else if (last > kPressed && ++pressed_ > 20) {
      before = last;
      pulled = true;
      if (pull) pull();
    }
    hand_.apply(on_hand);
  }

  bool unplugged = false;
  std::function<void()> pull, at_end;  // on the servo's thread
  std::array<double, kAfter> forces{};
  std::uint64_t after = 0;
  double before = 0.0, last = 0.0;
  bool pulled = false;

 private:
  WatchedHand hand_;
  HandState told_;
  std::uint64_t pressed_ = 0;
};

/// Pressed on the plate with 20 N, for as long as the test wants; nothing is cut.
SmallScene pressing(std::vector<std::string> sets = {}) {
  SmallScene out{.erosion = false, .sets = {"tool.spin_rpm=0", "duration_s=60", "hand.standoff_mm=0.5"}};
  out.sets.insert(out.sets.end(), sets.begin(), sets.end());
  return out;
}

struct Loose {
  explicit Loose(const SmallScene& scene) : loaded(load_small(scene)), hand(loaded) {
    auto made =
        Stage::make(loaded.scene, loaded.scene.effects, loaded.bone, loaded.tool, {.sink = nullptr, .hand = &hand, .restore_path = {}});
    REQUIRE_MESSAGE(made.ok(), (made ? "" : made.error().text()));
    parts = std::move(made).value();
    hand.at_end = [this] { stop = true; };
  }
  /// On threads, until the ticks after the cord are over.
  void run() {
    RunLog log(*parts, nullptr, [] {});
    const Status ran = run_live(*parts, log, {.require_realtime = false, .stop = &stop, .progress = {}, .warn = {}}, hand_off, report);
    REQUIRE_MESSAGE(ran.ok(), (ran ? "" : ran.error().text()));
    REQUIRE(hand.after >= kAfter);
    CHECK(hand.before > kPressed);
  }
  LoadedScene loaded;
  CordHand hand;
  std::unique_ptr<Stage> parts;
  BatchHandOff hand_off;
  LiveReport report;
  std::atomic<bool> stop{false};
};

double largest(const CordHand& hand, std::uint64_t from, std::uint64_t to) {
  double out = 0.0;
  for (std::uint64_t n = from; n < to; ++n) out = std::max(out, hand.forces[n]);
  return out;
}

}  // namespace

TEST_CASE("live failures: a device that is gone is without force from that tick on, and stays so") {
  Loose loose(pressing());
  loose.hand.unplugged = true;
  loose.run();
  CHECK(largest(loose.hand, 0, kAfter) == 0.0);
  CHECK((loose.report.faults & kServoHandLost) != 0);
  CHECK(loose.hand.last == 0.0);
  Loose sabotaged(pressing());  // the cord is pulled and nobody tells
  sabotaged.run();
  CHECK(sabotaged.hand.forces[kAfter - 1] > kPressed);
  CHECK(sabotaged.hand.last == 0.0);  // that is the run's end
}

TEST_CASE("live failures: where contact stands still the force fades to nothing within its time, while the run goes on") {
  for (const bool sabotaged : {false, true}) {
    Loose loose(pressing(sabotaged ? std::vector<std::string>{"servo.soft_stop_s=5"} : std::vector<std::string>{}));
    loose.hand.pull = [&] { loose.parts->contact->set_stalled(true); };
    loose.run();
    const double left = largest(loose.hand, kStale + kFade + kLate, kAfter);
    if (sabotaged)
      CHECK(left > kPressed);
    else
      CHECK(left == 0.0);
    CHECK((loose.report.faults & kServoContactStale) != 0);
    CHECK(loose.hand.last == 0.0);
  }
}

TEST_CASE("live failures: contact that comes back is felt softly") {
  for (const bool sabotaged : {false, true}) {
    Loose loose(pressing({sabotaged ? "servo.soft_start_s=0" : "servo.soft_start_s=0.2", "contact.coupling_N_s_per_m=0"}));
    loose.hand.pull = [&] { loose.parts->contact->set_stalled(true); };
    bool stopped_once = false;
    loose.hand.at_end = [&] {
      if (stopped_once) {
        loose.stop = true;
        return;
      }
      stopped_once = true;
      loose.hand.after = 0;
      loose.parts->contact->set_stalled(false);
    };
    loose.run();
    // Of at most 200 N, the servo's cap, each tick of the soft start adds a two hundredth: 1 N.
    double beyond = 0.0;
    for (std::size_t n = 0; n < 200; ++n) beyond = std::max(beyond, loose.hand.forces[n] - 1.0 * static_cast<double>(n + 1));
    if (sabotaged)
      CHECK(beyond > 10.0);
    else
      CHECK(beyond <= 1e-9);  // 200 roundings of the gain
    CHECK(largest(loose.hand, 0, kAfter) > kPressed);
    CHECK(loose.hand.last == 0.0);
  }
}

TEST_CASE("live failures: an exception in the simulation's thread ends the run, is reported, and leaves the hand without force") {
  spared = true;  // the main thread
  SmallScene scene{.sets = {"duration_s=60", "hand.standoff_mm=0.5"}};
  Loose loose(scene);
  loose.hand.at_end = {};
  loose.hand.pull = [] { refuse = true; };
  RunLog log(*loose.parts, nullptr, [] {});
  const Status ran = run_live(*loose.parts, log, {.require_realtime = false, .stop = &loose.stop, .progress = {}, .warn = {}},
                              loose.hand_off, loose.report);
  refuse = false;
  CHECK(!ran.ok());
  if (!ran) {
    CHECK(ran.error().code == ErrorCode::unavailable);
    CHECK(ran.error().message.find("the simulation thread ended") != std::string::npos);
  }
  CHECK(loose.hand.pulled);
  CHECK(loose.hand.before > kPressed);
  CHECK(loose.hand.last == 0.0);
}

TEST_CASE("live failures: an exception where progress is reported leaves the hand without force") {
  spared = true;
  Loose loose(pressing());
  std::atomic<bool> pulled{false};
  loose.hand.pull = [&] { pulled = true; };
  RunLog log(*loose.parts, nullptr, [] {});
  const auto tell = [&](double, const DrillProgress&) {
    if (pulled) throw std::runtime_error("nobody listens");
  };
  CHECK_THROWS_AS((void)run_live(*loose.parts, log, {.require_realtime = false, .stop = nullptr, .progress = tell, .warn = {}},
                                 loose.hand_off, loose.report),
                  std::runtime_error);
  CHECK(loose.hand.before > kPressed);
  CHECK(loose.hand.last == 0.0);
}
