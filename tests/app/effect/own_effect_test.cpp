// A reader's own effect: one that uses every access and every clock, written in this file alone and known by one more registry line. What
// the program says and records of it comes from here; a scene without its table has none of it.

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "app/job/plan.h"
#include "app/job/summary.h"
#include "app/scene/scene.h"
#include "app/session/recorded_hand.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

struct ProbeConfig {
  double weight = 0.2;  // [N] that hangs on the drill
};

// Slots of its own, one per clock that writes.
const SlotKey<std::uint64_t> kServoTicks{"probe_servo_ticks"};
const SlotKey<double> kPressed{"probe_pressed"};  // [N] of the last contact
const SlotKey<double> kSum{"probe_sum"};          // added to twice
const SlotKey<std::uint64_t> kBoneSteps{"probe_bone_steps"};

struct Counts {
  std::uint64_t servo = 0, contact = 0, simulation = 0, frame = 0, audio = 0;
  double last_seen = -1.0;  // the sum of the tick before, read before it is made again
  double now_seen = -1.0;   // the sum of this tick
  std::uint64_t servo_seen_by_bone = 0, bone_seen_by_contact = 0;
  std::uint64_t bone_seen_by_servo = 0;
  std::vector<std::uint64_t> shown;            // bone steps, of each picture
  double pressed_seen_by_servo = 0.0;          // [N] sum over the ticks
  const std::uint64_t* servo_there = nullptr;  // the servo's ticks as the simulation clock received them last
  // What `now` and `last` promise, and the order of clocks in lockstep. Not checked live, where each clock has a thread.
  bool in_order = true, lockstep = true;
  void expect(bool holds) { in_order = in_order && holds; }
};

std::atomic<std::uint64_t> bone_seen_live{0};  // by the servo
std::atomic<int> evaluations_to_hold{0};       // that feel bone: each is held until the servo has heard of two more steps of bone

class Probe final : public Effect {
 public:
  Probe(const ProbeConfig& config, Counts& counts) : config_(config), counts_(&counts) {}

  Status bind(StepGraph& graph) override {
    auto servo = graph.step(
        Clock::servo, "probe", "probe servo", [](void* self, const Tick&) { static_cast<Probe*>(self)->servo(); }, this);
    hand_ = servo.now(slots::kHand);
    force_ = servo.add(slots::kAddedForce);
    servo_ticks_ = servo.own(kServoTicks);
    pressed_there_ = servo.latest(kPressed);
    bone_there_ = servo.latest(kBoneSteps);
    auto contact = graph.step(
        Clock::contact, "probe", "probe contact", [](void* self, const Tick&) { static_cast<Probe*>(self)->contact(); }, this);
    state_ = contact.now(slots::kContact);
    bone_steps_there_ = contact.latest(kBoneSteps);
    pressed_ = contact.own(kPressed);
    contact.column("probe_pressed", "N", pressed_);
    static constexpr const char* kHalves[] = {"first half", "second half"};
    contact.column("probe_half", {"probe", kHalves}, &half_);
    // Bound in the wrong order on purpose: the reader of `now` first, then the two that add.
    auto reader = graph.step(
        Clock::simulation, "probe", "probe now", [](void* self, const Tick&) { static_cast<Probe*>(self)->read_now(); }, this);
    sum_now_ = reader.now(kSum);
    total_ = reader.own(kTotal);
    auto first = graph.step(
        Clock::simulation, "probe", "probe one", [](void* self, const Tick&) { *static_cast<Probe*>(self)->sum_a_ += 1.0; }, this);
    sum_a_ = first.add(kSum);
    auto second = graph.step(
        Clock::simulation, "probe", "probe two", [](void* self, const Tick&) { *static_cast<Probe*>(self)->sum_b_ += 2.0; }, this);
    sum_b_ = second.add(kSum);
    auto before = graph.step(
        Clock::simulation, "probe", "probe last", [](void* self, const Tick&) { static_cast<Probe*>(self)->read_last(); }, this);
    total_last_ = before.last(kTotal);
    counts_->servo_there = servo_there_ = before.latest(kServoTicks);
    bone_steps_ = before.own(kBoneSteps);
    auto frame = graph.step(
        Clock::frame, "probe", "probe frame", [](void* self, const Tick&) { static_cast<Probe*>(self)->frame(); }, this);
    (void)frame.now(slots::kPicture);
    bone_shown_ = frame.latest(kBoneSteps);
    (void)graph.step(
        Clock::audio, "probe", "probe audio",
        [](void* self, const Tick& tick) {
          auto& probe = *static_cast<Probe*>(self);
          if (probe.counts_->lockstep) probe.counts_->expect(tick.number == probe.counts_->audio && tick.dt == kAudioPeriod);
          ++probe.counts_->audio;
        },
        this);
    return {};
  }
  void report(Figures& out) const override { out.add("ticks", counts_->servo); }

 private:
  static inline const SlotKey<double> kTotal{"probe_total"};

  void servo() {
    *force_ += Vec3(0.0, 0.0, -config_.weight);
    *servo_ticks_ = ++counts_->servo;
    counts_->bone_seen_by_servo = *bone_there_;
    bone_seen_live.store(*bone_there_);
    counts_->pressed_seen_by_servo += *pressed_there_;
    if (counts_->lockstep) counts_->expect(hand_->tick + 1 == counts_->servo);
  }
  void contact() {
    half_ = ++counts_->contact > 400 ? 1.0 : 0.0;
    *pressed_ = glm::length(state_->on_hand.force);
    counts_->bone_seen_by_contact = *bone_steps_there_;
    if (*pressed_ > 0.0 && evaluations_to_hold > 0) hold();
    if (counts_->lockstep) counts_->expect(*bone_steps_there_ == counts_->simulation);  // lockstep: bone is cut after contact
  }
  static void hold() {
    const std::uint64_t until = bone_seen_live + 2;
    const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (bone_seen_live < until && std::chrono::steady_clock::now() < latest) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    CHECK(bone_seen_live >= until);
    --evaluations_to_hold;
  }
  void frame() {
    ++counts_->frame;
    counts_->shown.push_back(*bone_shown_);
  }
  void read_now() {
    counts_->now_seen = *sum_now_;
    *total_ += *sum_now_;
  }
  void read_last() {
    counts_->last_seen = *total_last_;
    // The total of the ticks before: this tick's is not in it yet.
    if (counts_->lockstep) counts_->expect(*total_last_ == 3.0 * static_cast<double>(counts_->simulation));
    counts_->servo_seen_by_bone = *servo_there_;
    *bone_steps_ = ++counts_->simulation;
  }

  ProbeConfig config_;
  Counts* counts_;
  const HandState* hand_ = nullptr;
  Vec3* force_ = nullptr;
  std::uint64_t* servo_ticks_ = nullptr;
  const double* pressed_there_ = nullptr;
  const std::uint64_t* bone_there_ = nullptr;
  const ContactState* state_ = nullptr;
  const std::uint64_t *bone_steps_there_ = nullptr, *bone_shown_ = nullptr;
  double* pressed_ = nullptr;
  double half_ = 0.0;
  const double* sum_now_ = nullptr;
  double *total_ = nullptr, *sum_a_ = nullptr, *sum_b_ = nullptr;
  const double* total_last_ = nullptr;
  const std::uint64_t* servo_there_ = nullptr;
  std::uint64_t* bone_steps_ = nullptr;
};

Counts counts;

class ProbePlan final : public ConfigPlan<ProbePlan, ProbeConfig> {
 public:
  explicit ProbePlan(TableReader& table) {
    config_.weight = table.number("weight_N", {.fallback = config_.weight, .min = 0.0, .max = 10.0}, "hangs on the drill");
  }
  PlanRow row(const PlanContext& context) const override {
    return {.table = "probe",
            .clock = Clock::servo,
            .step = "a weight",
            .needs = "",
            .gives = "",
            .detail = "of a test",
            .rate_hz = static_cast<double>(context.config.servo_hz),
            .bytes = sizeof(Probe)};
  }
  void warn(const PlanContext&, std::vector<std::string>& out) const override {
    if (config_.weight > 5.0) out.emplace_back("[probe] heavy");
  }
  Result<std::unique_ptr<Effect>> make(Stage&) const override { return std::unique_ptr<Effect>(std::make_unique<Probe>(config_, counts)); }
};

EffectRegistry with_probe() {
  EffectRegistry registry = shipped_effects();
  registry.push_back({"probe", "a weight, for a test", [](TableReader& table, const StageConfig&, Issues&) -> std::unique_ptr<EffectPlan> {
                        return std::make_unique<ProbePlan>(table);
                      }});
  return registry;
}

std::optional<LoadedScene> load_with(const EffectRegistry& registry, const std::string& tables, Issues& issues) {
  std::string text = scene_text({.record = true, .display = true});
  const std::string erosion = "[erosion]\n";
  text.insert(text.find(erosion) + erosion.size(), "rate_hz = 100\n");
  const auto document = TomlDocument::parse(text + tables, "probe.toml");
  REQUIRE(document);
  SceneContext context = test_context();
  context.registry = &registry;
  return load_scene(*document, context, issues);
}

/// Counts pictures; draws none.
class CountingSink final : public FrameSink {
 public:
  Status start(const VolumeView&, const TriangleMesh&) override { return {}; }
  void update(const TexelBox&) override {}
  Status draw(const std::string&, const FrameView&, int, int, Hash64&) override { return {}; }
};

TEST_CASE("own effect: its file and one registry line are all that the program needs") {
  const EffectRegistry registry = with_probe();
  Issues issues;
  auto loaded = load_with(registry, "[probe]\nweight_N = 0.5\n", issues);
  REQUIRE(loaded);
  loaded->scene.duration = 0.8;

  const Plan plan = make_plan(*loaded, registry);
  CHECK(plan.rows.back().table == "probe");
  CHECK(plan.rows.back().detail == "of a test");

  counts = {};
  CountingSink sink;
  const TemporaryFolder folder;
  SimulationOptions options;
  options.sink = &sink;
  DrillRun run(std::move(*loaded), options);
  run_recorded(run, folder.file("run.sqlite"));
  CHECK(counts.servo == 800);
  CHECK(counts.contact == 800);
  CHECK(counts.simulation == 80);
  CHECK(counts.audio == 80);
  CHECK(counts.frame == 3);  // before, after, cutaway: the run ends above half way
  CHECK(counts.now_seen == 3.0);
  CHECK(counts.last_seen == 3.0 * 79.0);
  CHECK(counts.servo_seen_by_bone == 800);
  CHECK(counts.bone_seen_by_contact == 79);
  CHECK(counts.in_order);
  CHECK(figure(run.simulation(), "probe", "ticks") == 800.0);
  CHECK(run.simulation().timing("probe servo").count == 800);
  // The weight is in the force on the hand: no contact in the first tick, so it is all there is.
  CHECK(run.simulation().servo_output().wanted.z < run.simulation().contact_state().on_hand.force.z);

  const auto session = SessionReader::open(folder.file("run.sqlite"));
  REQUIRE(session);
  // The change of its state is an event, in the evaluation in which it changes, and not a second time.
  std::vector<SessionEvent> events(session->events().begin(), session->events().end());
  std::erase_if(events, [](const SessionEvent& event) { return event.kind != "probe"; });
  REQUIRE(events.size() == 1);
  CHECK(events.front().text == "second half");
  CHECK(events.front().time_s == doctest::Approx(0.4).epsilon(0.004));
  CHECK(session->column("contact", "probe_pressed").ok());
  CHECK(session->column("contact", "from_simulation").ok());
  CHECK(session->column("bone", "from_servo").ok());
}

TEST_CASE("own effect: its session replays: each clock reads the messages that it read, each picture the bone that it showed") {
  const EffectRegistry registry = with_probe();
  Issues issues;
  const TemporaryFolder folder;
  CountingSink sink;
  const auto load = [&] {
    auto loaded = load_with(registry, "[probe]\nweight_N = 0.5\n", issues);
    REQUIRE(loaded);
    loaded->scene.duration = 0.8;
    return std::move(*loaded);
  };
  struct Case {
    bool live;
    int held;
  };
  for (const auto& [live, held] : {Case{false, 0}, Case{true, 0}, Case{true, 5}}) {
    CAPTURE(live);
    CAPTURE(held);
    counts = {};
    counts.lockstep = !live;
    SimulationOptions options;
    options.sink = &sink;
    options.live = live;
    DrillRun run(load(), options);
    evaluations_to_hold = held;
    run_recorded(run, folder.file("run.sqlite"));
    CHECK(evaluations_to_hold == 0);
    const Counts recorded = counts;
    CHECK(recorded.pressed_seen_by_servo > 0.0);
    CHECK(recorded.shown.back() > (live ? 0 : 70));  // a live run on a slow machine misses steps

    const auto session = SessionReader::open(folder.file("run.sqlite"));
    REQUIRE(session);
    auto hand = RecordedHand::create(*session);
    REQUIRE(hand);
    SimulationOptions again;
    again.sink = &sink;
    again.hand = &*hand;
    counts = {};
    counts.lockstep = false;  // the order is the session's
    DrillRun replayed(load(), again);
    const Status done = replayed.simulation().run_recorded(*session, *hand);
    REQUIRE_MESSAGE(done.ok(), (done.ok() ? "" : done.error().text()));
    CHECK(replayed.simulation().sent_hash() == run.simulation().sent_hash());
    CHECK(replayed.voxel_hash() == run.voxel_hash());
    CHECK(counts.pressed_seen_by_servo == recorded.pressed_seen_by_servo);
    CHECK(counts.bone_seen_by_servo == recorded.bone_seen_by_servo);
    CHECK(counts.servo_seen_by_bone == recorded.servo_seen_by_bone);
    CHECK(counts.shown == recorded.shown);
  }
}

/// A hand that does not move. In apply(), so after the servo took the result of contact, it looks for this tick's message.
class LookingHand final : public HandSource {
 public:
  const HandState& read() noexcept override { return state_; }
  void apply(const Wrench&) noexcept override {
    graph->receive(Clock::simulation);
    sent_early += *counts.servo_there > state_.tick;
    ++state_.tick;
  }
  StepGraph* graph = nullptr;
  int sent_early = 0;

 private:
  HandState state_;
};

TEST_CASE("own effect: the servo takes the result of contact before it sends its message: no result can depend on the tick that uses it") {
  Issues issues;
  auto loaded = load_with(with_probe(), "[probe]\nweight_N = 0.5\n", issues);
  REQUIRE(loaded);
  loaded->scene.duration = 0.05;
  counts = {};
  CountingSink sink;
  LookingHand hand;
  SimulationOptions options;
  options.sink = &sink;
  options.hand = &hand;
  DrillRun run(std::move(*loaded), options);
  hand.graph = &run.simulation().stage().graph;
  run.run();
  CHECK(*counts.servo_there == 50);
  CHECK(hand.sent_early == 0);
}

TEST_CASE("own effect: a scene without its table has none of it, to the bit") {
  const EffectRegistry registry = with_probe();
  Issues issues;
  auto loaded = load_with(registry, "", issues);
  REQUIRE(loaded);
  loaded->scene.duration = 0.5;
  counts = {};
  DrillRun with(std::move(*loaded));
  auto plain = load_with(shipped_effects(), "", issues);
  REQUIRE(plain);
  plain->scene.duration = 0.5;
  DrillRun without(std::move(*plain));
  CHECK(with.run().voxel_hash() == without.run().voxel_hash());
  CHECK(with.simulation().force_hash() == without.simulation().force_hash());
  CHECK(with.simulation().sent_hash() == without.simulation().sent_hash());
  CHECK(counts.servo == 0);
  CHECK(with.simulation().stage().graph.steps().size() == without.simulation().stage().graph.steps().size());
  CHECK(with.simulation().stage().graph.bytes() == without.simulation().stage().graph.bytes());
}

TEST_CASE("own effect: its keys, its range and its warnings are the program's") {
  const EffectRegistry registry = with_probe();
  Issues issues;
  CHECK_FALSE(load_with(registry, "[probe]\nweight_N = 20\n", issues));
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].text().find("probe.weight_N = 20 must be") != std::string::npos);
  issues.clear();
  CHECK_FALSE(load_with(registry, "[probe]\nwieght_N = 1\n", issues));
  REQUIRE(issues.size() == 1);
  CHECK(issues[0].text().find("weight_N") != std::string::npos);
  issues.clear();
  const auto heavy = load_with(registry, "[probe]\nweight_N = 6\n", issues);
  REQUIRE(heavy);
  CHECK(make_plan(*heavy, registry).warnings.back() == "[probe] heavy");
  issues.clear();
  CHECK_FALSE(load_with(shipped_effects(), "[probe]\n", issues));  // without the line there is no such table
}

// Effects whose uses cannot be satisfied.
struct Uses {
  std::string table;
  void (*bind)(StepGraph::Binder& step);
  Clock clock = Clock::simulation;
};

class UsingEffect final : public Effect {
 public:
  explicit UsingEffect(const Uses& uses) : uses_(uses) {}
  Status bind(StepGraph& graph) override {
    auto step = graph.step(
        uses_.clock, uses_.table, uses_.table, [](void*, const Tick&) {}, this);
    uses_.bind(step);
    return {};
  }

 private:
  Uses uses_;
};

std::string refusal_of(const std::vector<Uses>& all) {
  StepGraph graph;
  std::vector<std::unique_ptr<UsingEffect>> effects;
  for (const Uses& uses : all) {
    effects.push_back(std::make_unique<UsingEffect>(uses));
    REQUIRE(effects.back()->bind(graph));
  }
  (void)graph.provide(Clock::servo, slots::kHand);
  graph.reads(Clock::servo, slots::kAddedForce);
  const Status resolved = graph.resolve();
  return resolved ? std::string() : resolved.error().message;
}

const SlotKey<double> kA{"a"}, kB{"b"};
const SlotKey<float> kOtherA{"a"};

TEST_CASE("step graph: what cannot be satisfied is one line that names slot and effects") {
  const Uses writes_a{"one", [](StepGraph::Binder& s) { (void)s.own(kA); }};
  CHECK(refusal_of({writes_a}).empty());
  CHECK(refusal_of({{"one", [](StepGraph::Binder& s) { (void)s.now(kA); }}}) == "[one] needs \"a\", which nothing in this scene provides");
  CHECK(refusal_of({{"one", [](StepGraph::Binder& s) { (void)s.now_if_written(kA); }}}).empty());
  CHECK(refusal_of({writes_a, {"two", [](StepGraph::Binder& s) { (void)s.own(kA); }}}) == "\"a\" has two owners: [two] and [one]");
  CHECK(refusal_of({writes_a, {"two", [](StepGraph::Binder& s) { (void)s.add(kA); }}}) == "[two] adds to \"a\", which has an owner");
  CHECK(refusal_of({writes_a, {"two", [](StepGraph::Binder& s) { (void)s.now(kOtherA); }}}) == "the slot \"a\" is used with two types");
  CHECK(refusal_of({{"one", [](StepGraph::Binder& s) { (void)s.now(slots::kHand); }}}) ==
        "[one] reads \"hand\" of the servo clock on the simulation clock by the wrong access");
  // What a replay could not repeat.
  const Uses adds_a{"one", [](StepGraph::Binder& s) { (void)s.add(kA); }};
  CHECK(refusal_of({adds_a, {"two", [](StepGraph::Binder& s) { (void)s.last(kA); }}}) ==
        "[two] reads the last \"a\", which steps add to: it is reset before each tick");
  CHECK(refusal_of({{"one", [](StepGraph::Binder& s) { (void)s.own(kA); }, Clock::audio},
                    {"two", [](StepGraph::Binder& s) { (void)s.latest(kA); }}}) ==
        "[two] reads \"a\" of the audio clock, which a replay does not run");
  static const double value = 0.0;
  CHECK(refusal_of({{"one", [](StepGraph::Binder& s) { s.column("heat", "J", &value); }, Clock::frame}}) ==
        "the column \"heat\" is on the frame clock, which has no stream in a session");
  const std::string crowded = refusal_of({{"one", [](StepGraph::Binder& s) {
                                             for (int n = 0; n < 25; ++n) s.column("c" + std::to_string(n), "", &value);
                                           }}});
  static const char* const texts[] = {"off", "on"};
  const auto with_states = [](StepGraph::Binder& s) { s.column("lamp", {"lamp", texts}, &value); };
  CHECK(refusal_of({{"one", with_states}}) == "the states \"lamp\" are on the simulation clock: only those of contact are events");
  CHECK(refusal_of({{"one", with_states, Clock::contact}}).empty());
  CHECK(crowded == "the steps of the simulation clock record 25 columns, at most 24");
  CHECK(refusal_of({{"one", [](StepGraph::Binder& s) { (void)s.add(slots::kAddedForce); }}}) ==
        "\"added_force\" of [one] must be written on the servo clock, where the stage reads it");
  // Two effects that need each other: by `now` a cycle, by `last` on one side an order.
  const Uses a_from_b{"one", [](StepGraph::Binder& s) {
                        (void)s.own(kA);
                        (void)s.now(kB);
                      }};
  const Uses b_from_a{"two", [](StepGraph::Binder& s) {
                        (void)s.own(kB);
                        (void)s.now(kA);
                      }};
  const Uses b_from_last_a{"two", [](StepGraph::Binder& s) {
                             (void)s.own(kB);
                             (void)s.last(kA);
                           }};
  CHECK(refusal_of({a_from_b, b_from_a}) == "on the simulation clock each of these needs another's result of the same tick: [one], [two]");
  CHECK(refusal_of({a_from_b, b_from_last_a}).empty());
}

}  // namespace
}  // namespace burrhole::test
