// What a person changes while drilling is recorded and replayed: the same voxels, forces and pictures, in lockstep and live.

#include "app/run/inputs.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <ostream>

#include "app/session/recorded_hand.h"
#include "core/measure/hole_measure.h"
#include "core/mesh/mesh_patch.h"
#include "core/voxel/box_parts.h"
#include "tests/support/drill_scene.h"
#include "tests/support/scene_hand.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

Input spin(std::uint64_t tick, double command) { return {tick, InputKind::spin, command, {}, {}}; }
Input plain(std::uint64_t tick, InputKind kind, const std::string& text = {}) { return {tick, kind, 0.0, text, {}}; }
Input tool(std::uint64_t tick, const std::string& name) {
  auto text = read_tool_text(name, "small.toml", test_context());
  REQUIRE(text);
  return {tick, InputKind::tool, 0.0, name, *text};
}

/// A renderer's texture without a renderer: the hash of a picture follows the texels that a display would have, the tool and its pose, and
/// not the batches in which the texels came.
class HashingSink final : public FrameSink {
 public:
  Status start(const VolumeView& volume, const TriangleMesh& look) override {
    box_ = VoxelBox{Vec3i(0), volume.dims};
    texels_ = volume.normal_opacity;
    return change_tool(look);
  }
  void update(const TexelBox& texels) override { copy_part(texels.box, texels.box, texels.normal_opacity.data(), box_, texels_.data()); }
  Status change_tool(const TriangleMesh& look) override {
    triangles_ = look.positions.size();
    return {};
  }
  Status draw(const std::string&, const FrameView& view, int, int, Hash64& hash) override {
    for (const Rgba8& texel : texels_)
      hash.add(std::uint64_t{texel.r} | std::uint64_t{texel.g} << 8 | std::uint64_t{texel.b} << 16 | std::uint64_t{texel.a} << 24);
    hash.add(std::uint64_t{triangles_});
    hash.add(view.world_from_tool ? view.world_from_tool->translation : Vec3(0.0));
    return {};
  }

 private:
  VoxelBox box_;
  std::vector<Rgba8> texels_;
  std::size_t triangles_ = 0;
};

struct Outcome {
  std::uint64_t voxels = 0, forces = 0, sent = 0;
  std::vector<std::string> stills;
  friend bool operator==(const Outcome&, const Outcome&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Outcome& o) {
    out << std::hex << "voxels " << o.voxels << " forces " << o.forces << " sent " << o.sent;
    for (const std::string& still : o.stills) out << ", " << still;
    return out;
  }
};

Outcome outcome_of(DrillRun& run) { return {run.voxel_hash(), run.simulation().force_hash(), run.simulation().sent_hash(), {}}; }

/// A scene that drills for `seconds` with inputs.
struct Session {
  std::string duration = "2.6";
  std::vector<Input> inputs = {};
  bool live = false;
};

Outcome record(const Session& session, const std::string& path) {
  HashingSink sink;
  SimulationOptions options;
  options.sink = &sink;
  options.inputs = session.inputs;
  options.history = true;
  options.live = session.live;
  const std::vector<std::string> sets{"duration_s=" + session.duration, "hand.feels=false", "friction.static_coefficient=0.4"};
  DrillRun run(SmallScene{.spindle = true, .record = true, .display = true, .sets = sets}, options);
  run_recorded(run, path);
  return outcome_of(run);
}

Outcome replay(const std::string& path) {
  const auto session = SessionReader::open(path);
  REQUIRE(session);
  auto hand = RecordedHand::create(*session);
  REQUIRE(hand);
  HashingSink sink;
  SimulationOptions options;
  options.sink = &sink;
  options.hand = &*hand;
  options.history = true;
  DrillRun run(load_text(session->meta().scene, {}), options);
  const Status replayed = run.simulation().run_recorded(*session, *hand);
  REQUIRE_MESSAGE(replayed.ok(), (replayed.ok() ? "" : replayed.error().text()));
  Outcome out = outcome_of(run);
  for (const SessionStill& still : run.simulation().redrawn()) out.stills.push_back(still.name + " " + still.hash);
  return out;
}

std::vector<std::string> stills_of(const std::string& path) {
  const auto session = SessionReader::open(path);
  REQUIRE(session);
  std::vector<std::string> out;
  for (const SessionStill& still : session->stills()) out.push_back(still.name + " " + still.hash);
  return out;
}

/// Spin changes, a tool change, two undos and a checkpoint.
std::vector<Input> a_session() {
  return {spin(900, 0.0),
          spin(1000, 0.5),
          spin(1300, 0.0),
          plain(1350, InputKind::undo),
          plain(1400, InputKind::checkpoint, "a"),
          spin(1500, 1.0),
          spin(1750, 0.0),
          plain(1800, InputKind::undo),
          tool(1850, "pin"),
          spin(1900, 1.0),
          plain(2200, InputKind::mark, "here"),
          spin(2400, 0.0),
          plain(2450, InputKind::restore, "a")};
}

TEST_CASE("inputs: undo gives the bone before the last spin-on, to the bit; so do a checkpoint and a reset") {
  const TemporaryFolder folder;
  const auto voxels = [&](std::vector<Input> inputs, const std::string& duration) {
    return record({.duration = duration, .inputs = std::move(inputs)}, folder.file("run.sqlite")).voxels;
  };
  const std::uint64_t first = voxels({spin(900, 0.0)}, "0.95");
  const std::uint64_t untouched = voxels({spin(0, 0.0)}, "0.95");
  REQUIRE(first != untouched);
  const std::vector<Input> twice{spin(900, 0.0), spin(1000, 1.0), spin(1300, 0.0)};
  const auto with = [&](const std::vector<Input>& more) {
    std::vector<Input> all = twice;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const std::uint64_t second = voxels(twice, "1.5");
  REQUIRE(second != first);
  CHECK(voxels(with({plain(1350, InputKind::undo)}), "1.5") == first);
  CHECK(voxels(with({plain(1350, InputKind::undo), plain(1360, InputKind::undo)}), "1.5") == untouched);
  CHECK(voxels(with({plain(1350, InputKind::reset)}), "1.5") == untouched);
  CHECK(voxels({spin(900, 0.0), plain(950, InputKind::checkpoint, "a"), spin(1000, 1.0), spin(1300, 0.0),
                plain(1350, InputKind::restore, "a")},
               "1.5") == first);
}

TEST_CASE(
    "inputs: after tool changes, undo and restore the triangles of the mesh model are those of the bone, and a second run is the same") {
  // The last input is followed by 50 ms of drilling.
  const std::vector<Input> endings[] = {{}, {plain(1250, InputKind::undo)}, {plain(1250, InputKind::restore, "a")}};
  std::vector<Outcome> outcomes;
  for (const std::vector<Input>& ending : endings) {
    SimulationOptions options;
    options.inputs = {tool(300, "pin"), plain(500, InputKind::checkpoint, "a"), tool(700, "ball")};
    options.inputs.insert(options.inputs.end(), ending.begin(), ending.end());
    options.history = true;
    const SmallScene scene{.contact_keys = "model = \"mesh\"\ntool = \"hand\"\nstiffness_N_per_m = 20e3\n",
                           .sets = {"duration_s=1.3", "hand.push_N=5"}};
    DrillRun run(scene, options), again(scene, options);
    Simulation& simulation = run.run().simulation();
    BoneStep& bone = simulation.bone_step();
    CHECK(bone.removed_mass() > 0.01e-9);
    CHECK((simulation.contact_flags() & kContactOutsideWindow) == 0);
    MeshPatch anew(simulation.voxmap().bone().bone_from_index());
    anew.rebuild(simulation.voxmap().window());
    const TrianglePatch& published = bone.publisher()->exchange().latest().triangles;
    CHECK(published.box == anew.patch().box);
    CHECK(published.blocks == anew.patch().blocks);
    outcomes.push_back(outcome_of(run));
    CHECK(outcome_of(again.run()) == outcomes.back());
  }
  CHECK_FALSE(outcomes[0].voxels == outcomes[1].voxels);
  CHECK_FALSE(outcomes[0].voxels == outcomes[2].voxels);
}

TEST_CASE("inputs: the removed mass is that of the bone at the end, not of what was undone") {
  const auto mass = [](std::vector<Input> inputs) {
    SimulationOptions options;
    options.inputs = std::move(inputs);
    options.history = true;
    DrillRun run(SmallScene{.sets = {"duration_s=0.9", "hand.feels=false"}}, options);
    run.run();
    Simulation& s = run.simulation();
    return std::pair{measure_hole(s.voxmap(), s.approach()).removed_mass, s.bone_step().removed_mass()};
  };
  const auto [kept, eroded] = mass({});
  CHECK(kept > 0.1e-9);
  CHECK(std::abs(kept / eroded - 1.0) < 1e-6);  // densities are floats
  const auto [undone, all] = mass({spin(800, 0.0), plain(850, InputKind::reset)});
  CHECK(undone == 0.0);
  CHECK(all > 0.1e-9);
}

TEST_CASE("inputs: a tool that was changed for another takes no more memory") {
  std::vector<std::weak_ptr<const CuttingField>> seen;
  Simulation* simulation = nullptr;
  SimulationOptions options;
  options.inputs = {tool(300, "pin"), tool(500, "pin"), tool(700, "pin"), tool(900, "pin")};
  options.history = true;
  options.progress = [&](double, const DrillProgress&) {
    const std::shared_ptr<const CuttingField> now = simulation->stage().tool->cutting;
    REQUIRE((now != nullptr));
    if (seen.empty() || seen.back().lock() != now) seen.emplace_back(now);
  };
  DrillRun run(SmallScene{.sets = {"duration_s=1.1"}}, options);
  simulation = &run.simulation();
  run.run();
  REQUIRE(seen.size() == 5);
  CHECK_FALSE(seen.front().expired());  // the scene's own, which is not the simulation's
  for (std::size_t n = 1; n + 1 < seen.size(); ++n) CHECK(seen[n].expired());
  CHECK_FALSE(seen.back().expired());
}

TEST_CASE("inputs: a lockstep session with all of them replays to the same voxels, forces and pictures") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  Outcome recorded = record({.inputs = a_session()}, path);
  recorded.stills = stills_of(path);
  CHECK(recorded.stills.size() >= 3);
  CHECK(replay(path) == recorded);
  const auto session = SessionReader::open(path);
  REQUIRE(session);
  CHECK(session->inputs().size() == a_session().size());
}

// Bone is stepped every ten ticks, so no step lies between this undo and the last pictures, nor between the undo and those before it.
TEST_CASE("inputs: a picture after the last bone step and an undo replays with the undo") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite"), other = folder.file("without.sqlite");
  Outcome recorded = record({.duration = "0.999", .inputs = {plain(998, InputKind::undo)}}, path);
  recorded.stills = stills_of(path);
  CHECK(replay(path) == recorded);
  Outcome without = record({.duration = "0.999"}, other);
  without.stills = stills_of(other);
  CHECK(recorded.stills.back() != without.stills.back());
}

TEST_CASE("inputs: a live session with all of them replays in lockstep to the same voxels, forces and pictures") {
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  Outcome recorded = record({.inputs = a_session(), .live = true}, path);
  recorded.stills = stills_of(path);
  CHECK(replay(path) == recorded);
}

TEST_CASE("inputs: what cannot be done is a warning and an event, and the run goes on") {
  const TemporaryFolder folder;
  std::vector<std::string> warnings;
  SimulationOptions options;
  options.inputs = {plain(10, InputKind::undo), plain(20, InputKind::restore, "nowhere")};
  options.history = true;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  DrillRun run(SmallScene{.sets = {"duration_s=0.1"}}, options);
  run.run();
  CHECK(run.simulation().ticks() == 100);
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0] == "there is nothing to undo");
  CHECK(warnings[1].find("nowhere") != std::string::npos);
}

TEST_CASE("inputs: those that the run ends before are known") {
  SimulationOptions options;
  options.inputs = {plain(10, InputKind::undo), plain(100, InputKind::undo), plain(200, InputKind::undo)};
  options.history = true;
  DrillRun run(SmallScene{.sets = {"duration_s=0.1"}}, options);
  run.run();
  const auto left = run.simulation().inputs_left();  // ticks 0 to 99
  REQUIRE(left.size() == 2);
  CHECK(left.front().tick == 100);
}

/// The scene's own hand, which knows of inputs, with an eye on every servo tick.
class InformedHand final : public HandSource {
 public:
  InformedHand(const SimulatedHand& hand, std::function<void()> watch) : hand_(hand), watch_(std::move(watch)) {}
  [[nodiscard]] const HandState& read() noexcept override { return hand_.read(); }
  void apply(const Wrench& on_hand) noexcept override {
    watch_();
    hand_.apply(on_hand);
  }
  void drive_changed() noexcept override { hand_.drive_changed(); }
  void scene_changed(double softest) noexcept override { hand_.scene_changed(softest); }

 private:
  SimulatedHand hand_;
  std::function<void()> watch_;
};

/// Where a flat pin of 2 mm goes after an input 2 mm deep in a plate of 3 mm.
struct AfterInput {
  double before = 0.0;      ///< [m] depth of the tip at the input
  double at_once = 0.0;     ///< [m] depth with the first contact result after it
  double aside = 0.0;       ///< [m] greatest distance of the tip from the axis in the 0.3 s after it
  double force = 0.0;       ///< [N] largest of contact in the 0.3 s after it, in which the soft start ends
  double step = 0.0;        ///< [N] largest change of the force on the hand in a tick, in the same time
  double usual_step = 0.0;  ///< [N] the same, in the 0.3 s before
  double depth = 0.0;       ///< [m] at the end
};

AfterInput after(const Input& input, double tick_s, std::vector<Input> more = {}) {
  Input timed = input;
  Simulation* simulation = nullptr;
  AfterInput out;
  timed.tick = static_cast<std::uint64_t>(tick_s * 1000.0);
  more.push_back(timed);
  const SmallScene scene{.sets = {"tool.name=\"pin\"", "tool.erosion_scale=4", "duration_s=2.5", "hand.tremor_mm=0.04", "hand.ramp_s=0.2"}};
  LoadedScene loaded = load_small(scene);
  std::uint64_t ticks = 0;
  Vec3 last{0.0};
  InformedHand hand(scene_hand(loaded), [&] {
    const ContactState& now = simulation->stage().contact->state();
    const Vec3 at = simulation->stage().world_from_approach().inverse() * now.world_from_tool.translation;
    ++ticks;
    if (ticks < timed.tick) out.before = -at.z;
    if (ticks == timed.tick + 3) out.at_once = -at.z;
    const Vec3 shown = simulation->stage().servo->output().force;
    if (ticks > timed.tick && ticks < timed.tick + 300) {
      out.force = std::max(out.force, glm::length(now.on_hand.force));
      out.step = std::max(out.step, glm::length(shown - last));
    }
    if (ticks > timed.tick - 300 && ticks < timed.tick) out.usual_step = std::max(out.usual_step, glm::length(shown - last));
    last = shown;
    if (ticks > timed.tick && ticks < timed.tick + 300) out.aside = std::max(out.aside, std::hypot(at.x, at.y));
    out.depth = -at.z;
  });
  SimulationOptions options;
  options.hand = &hand;
  options.history = true;
  options.inputs = std::move(more);
  DrillRun run(std::move(loaded), options);
  simulation = &run.simulation();
  run.run();
  CHECK(run.simulation().inputs_left().empty());
  return out;
}

TEST_CASE("inputs: bone that comes back round the bit puts it back along its shaft, and it drills down again where it was") {
  for (const Input& input :
       {plain(0, InputKind::undo), plain(0, InputKind::reset), plain(0, InputKind::restore, "whole"), tool(0, "punch")}) {
    const std::string kind = name_of(input.kind);
    CAPTURE(kind);
    const AfterInput found = after(input, 0.9, {plain(5, InputKind::checkpoint, "whole")});
    MESSAGE(found.before * 1e3 << " mm, then " << found.at_once * 1e3 << " mm, aside " << found.aside * 1e3 << " mm, " << found.force
                               << " N, at the end " << found.depth * 1e3 << " mm");
    CHECK(found.before > 0.5e-3);
    // The spring of the coupling from the hand, where it was, to the bone: 20 N, and 5 N a millimetre. Its damper and the arm add less than 5 N.
    const double spring = 20.0 + 5e3 * found.before + 5.0;
    CHECK(found.force < spring);
    // The old force fades as the new one rises, over 200 ticks, so a tick adds at most a 200th of both to what a step of drilling changes,
    // which grows as the force does. Without the fade the first tick would take the whole push.
    CHECK(found.step < found.usual_step * spring / 20.0 + 2.0 * spring / 200.0);
    CHECK(found.at_once < spring / 40e3);  // engaged in the bone as it is now (kHeldKeys)
    CHECK(found.at_once > -0.5e-3);        // two voxels above it
    // The bit's clearance and the tremor. Half of the bit's radius would be a bit beside its hole.
    CHECK(found.aside < 0.3e-3);
    CHECK(found.depth > 0.5e-3);
  }
}

std::vector<std::string> faults_of(const std::string& text) {
  const auto document = TomlDocument::parse(text, "inputs.toml");
  REQUIRE(document);
  Issues issues;
  CHECK_FALSE(read_inputs(*document, 1000, issues).has_value());
  std::vector<std::string> out;
  for (const Error& issue : issues) out.push_back(issue.text());
  return out;
}

TEST_CASE("inputs: a file of timed inputs is read in order; each error has its place") {
  const auto document = TomlDocument::parse(
      "[[input]]\ntime_s = 0.5\nkind = \"spin\"\nvalue = 0.25\n[[input]]\ntime_s = 0.5\nkind = \"undo\"\n[[input]]\ntime_s = 2\n"
      "kind = \"checkpoint\"\nname = \"before the dura\"\n",
      "inputs.toml");
  REQUIRE(document);
  Issues issues;
  const auto inputs = read_inputs(*document, 2000, issues);
  REQUIRE(inputs);
  REQUIRE(inputs->size() == 3);
  CHECK((*inputs)[0].tick == 1000);
  CHECK((*inputs)[0].value == 0.25);
  CHECK((*inputs)[1].kind == InputKind::undo);
  CHECK((*inputs)[2].text == "before the dura");

  const auto first = [](const std::string& text) {
    const std::vector<std::string> faults = faults_of(text);
    REQUIRE_FALSE(faults.empty());
    return faults.front();
  };
  CHECK(first("") == "inputs.toml: holds no [[input]]");
  CHECK(first("[[input]]\ntime_s = 1\nkind = \"spin\"\nvalue = 2\n").starts_with("inputs.toml:4:1: input[0].value = 2 must be in [0, 1]"));
  CHECK(first("[[input]]\ntime_s = 1\nkind = \"undoo\"\n").find("undo") != std::string::npos);
  CHECK(first("[[input]]\ntime_s = 2\nkind = \"undo\"\n[[input]]\ntime_s = 1\nkind = \"undo\"\n").find("is earlier than") !=
        std::string::npos);
  CHECK(first("[[input]]\ntime_s = 1\nkind = \"tool\"\n").find("name") != std::string::npos);
}

}  // namespace
}  // namespace burrhole::test
