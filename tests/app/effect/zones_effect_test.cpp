// [zones] in a scene: distances against a twin on the labels of the bone, the warning and its events, the tone, the guidance, replay.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "app/stage/zone_state.h"
#include "core/measure/approach.h"
#include "core/voxel/label_table.h"
#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

/// A hand whose readings are given.
class GivenHand final : public HandSource {
 public:
  explicit GivenHand(std::function<HandState(std::uint64_t)> at) : at_(std::move(at)) {}
  const HandState& read() noexcept override {
    state_ = at_(tick_);
    state_.tick = tick_;
    return state_;
  }
  void apply(const Wrench& on_hand) noexcept override {
    work += glm::dot(on_hand.force, at_(tick_ + 1).world_from_hand.translation - at_(tick_).world_from_hand.translation);
    most = std::max(most, work);
    largest = std::max(largest, glm::length(on_hand.force));
    ++tick_;
  }
  double work = 0.0, most = 0.0, largest = 0.0;  // [J] done on the hand; [N]

 private:
  std::function<HandState(std::uint64_t)> at_;
  HandState state_;
  std::uint64_t tick_ = 0;
};

HandState place(const Vec3& at) {
  HandState out;
  out.world_from_hand.translation = at;
  return out;
}

/// A skull patch without contact and erosion: the tool is where the hand is.
SmallScene free_scene(const std::vector<std::string>& sets = {}) {
  SmallScene scene{.volume = kSkullPatchKeys, .contact = false, .erosion = false, .sets = {"duration_s=1.0"}};
  scene.sets.insert(scene.sets.end(), sets.begin(), sets.end());
  return scene;
}

LoadedScene scene_of(const SmallScene& scene, const std::string& zones) { return load_text(scene_text(scene) + zones, scene.sets); }

Issues issues_of(const std::string& zones) {
  Issues issues;
  const auto document = TomlDocument::parse(scene_text(free_scene()) + zones, "small.toml");
  REQUIRE(document);
  auto loaded = load_scene(*document, test_context(), issues);
  if (loaded && issues.empty()) {
    const auto made = Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues);
    CHECK(made == nullptr);
  }
  return issues;
}

bool has(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

/// Plain twin: distance from a point to the nearest voxel centre of dura or brain, less half an edge; above the dura.
double twin(const BoneModel& bone, const Vec3& p_bone) {
  const double edge = bone.bone_from_index().mean_edge();
  std::vector<float> labels(bone.bounds().count());
  bone.read_labels(bone.bounds(), labels);
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t n = 0;
  for_each_voxel(bone.bounds(), [&](const Vec3i& v) {
    const auto label = static_cast<VoxelLabel>(static_cast<int>(labels[n++]));
    if (label == VoxelLabel::dura || label == VoxelLabel::brain)
      nearest = std::min(nearest, glm::length(bone.bone_from_index() * Vec3(v) - p_bone));
  });
  return nearest - 0.5 * edge;
}

}  // namespace

TEST_CASE("zones: the live value is the distance of a plain twin to the dura's voxels, and that of the skull's closed form") {
  // Over voxel centres, where the field is exact: floats of millimetres, 1e-9 m.
  GivenHand* seen = nullptr;
  std::vector<Vec3> way;
  for (int n = 0; n < 300; ++n) way.push_back(Vec3(-1.0e-3 + 0.25e-3 * (n % 9), 0.5e-3 - 0.25e-3 * (n % 5), 1.0e-3 - 0.25e-3 * (n % 24)));
  LoadedScene loaded = scene_of(free_scene({"duration_s=0.3"}), "[zones]\n");
  const Affine frame = loaded.bone->bone_from_index();
  // The hand's places, moved onto the nearest voxel centre.
  for (Vec3& p : way) p = frame * Vec3(voxel_of(frame.inverse() * p));
  GivenHand hand([&](std::uint64_t tick) { return place(way[std::min<std::size_t>(tick, way.size() - 1)]); });
  seen = &hand;
  SimulationOptions options;
  options.hand = seen;
  const std::shared_ptr<const BoneModel> bone = loaded.bone;
  const TemporaryFolder folder;
  DrillRun run(std::move(loaded), options);
  run_recorded(run, folder.file("zones.bhs"));
  const std::vector<double> measured = session_column(folder.file("zones.bhs"), kZoneDistanceColumn);
  REQUIRE(measured.size() == 300);
  double largest = 0.0, from_sphere = 0.0, sabotaged = 0.0;
  for (std::size_t n = 1; n < measured.size(); ++n) {
    const Vec3& p = way[n - 1];                                            // without [contact] the tool follows a tick later
    const double truth = glm::length(p - Vec3(0.0, 0.0, -80e-3)) - 75e-3;  // radius 80 mm, 5 mm of bone
    if (truth < 0.3e-3) continue;
    largest = std::max(largest, std::abs(measured[n] - twin(*bone, p)));
    from_sphere = std::max(from_sphere, std::abs(measured[n] - truth));
    sabotaged = std::max(sabotaged, std::abs(measured[n] - twin(*bone, way[n])));  // the place of the next tick
  }
  CHECK(largest < 2e-9 + 6e-8 * 6e-3);
  CHECK(sabotaged > 0.1e-3);                      // a tick is at least a voxel, 0.25 mm
  CHECK(from_sphere < std::sqrt(3.0) * 0.25e-3);  // the bound of distance_field.h
  CHECK(from_sphere > 1e-6);
}

TEST_CASE("zones: a dive to the dura warns once on the way in, notes each change of level, and reports how near and how long") {
  // Down to 0.5 mm inside the dura and up again, at 10 mm/s. The dura is at -5 mm, within a voxel.
  const auto dive = [](std::uint64_t tick) {
    const double t = static_cast<double>(tick) * 1e-3;
    return place(Vec3(0.0, 0.0, 0.5e-3 - 10e-3 * std::min(t, std::max(0.0, 1.2 - t))));
  };
  GivenHand hand(dive);
  SimulationOptions options;
  options.hand = &hand;
  const TemporaryFolder folder;
  DrillRun run(scene_of(free_scene({"duration_s=1.2"}), "[zones]\nwarn_mm = 2.0\n"), options);
  run_recorded(run, folder.file("dive.bhs"));
  const Simulation& simulation = run.simulation();
  CHECK(std::abs(figure(simulation, "zones", "closest_dura_mm") + 0.5) < 0.25);
  CHECK(figure(simulation, "zones", "warnings") == 1.0);
  // In the zone for twice 0.5 mm, near it for twice 2.5 mm and 0.2 x 2 mm on the way out: at 10 mm/s, each end within a voxel.
  CHECK(std::abs(figure(simulation, "zones", "inside_s") - 0.10) < 2 * 0.025 + 0.002);
  CHECK(std::abs(figure(simulation, "zones", "near_s") - 0.54) < 2 * 0.025 + 0.002);
  CHECK(figure(simulation, "zones", "unknown_s") == 0.0);
  std::vector<std::string> lines;
  simulation.stage().warn(lines);
  CHECK(has(lines, "[zones] the tip was 0."));
  const auto session = SessionReader::open(folder.file("dive.bhs"));
  REQUIRE(session);
  std::vector<std::string> texts;
  for (const SessionEvent& event : session->events())
    if (event.kind == "zone") texts.push_back(event.text);
  CHECK(texts == std::vector<std::string>{"near", "inside", "near", "clear"});
}

TEST_CASE("zones: a sinus as a tube is measured without a voxel, with the bone's pose, and the nearest zone counts") {
  GivenHand hand([](std::uint64_t tick) { return place(Vec3(1e-3, 0.0, -1e-6 * static_cast<double>(tick))); });
  SimulationOptions options;
  options.hand = &hand;
  const std::string tube = "[zones]\n[[zones.zone]]\nname = \"sinus\"\nfrom_mm = [0, -20, -3]\nto_mm = [0, 20, -3]\nradius_mm = 0.5\n";
  DrillRun run(scene_of(free_scene({"duration_s=0.5"}), tube), options);
  run.run();
  // 1 mm beside and at the end 2.5015 mm above its axis; the tool follows a tick later.
  CHECK(figure(run.simulation(), "zones", "closest_sinus_mm") == doctest::Approx(std::hypot(1.0, 3.0 - 0.498) - 0.5).epsilon(1e-6));
  CHECK_FALSE(run.simulation().stage().figure("zones", "closest_dura_mm").has_value());
  DrillRun both(scene_of(free_scene({"duration_s=0.5"}), tube + "[[zones.zone]]\nname = \"below\"\nlabel = \"brain\"\n"), options);
  both.run();
  const ZoneState* zone = both.simulation().stage().graph.find(slots::kZone);
  REQUIRE(zone != nullptr);
  CHECK(zone->distance == doctest::Approx(figure(both.simulation(), "zones", "closest_sinus_mm") * 1e-3).epsilon(1e-3));
  CHECK(figure(both.simulation(), "zones", "closest_below_mm") > 3.0);
  CHECK(zone->away.x > 0.3);
}

TEST_CASE("zones: a label of the user is a zone by its name, and one that the volume lacks is refused") {
  LoadedScene loaded =
      scene_of(free_scene({"duration_s=0.1"}), "[zones]\n[[zones.zone]]\nname = \"mine\"\nuser_label = \"Sagittal sinus\"\n");
  const BoneModel& from = *loaded.bone;
  DenseBone dense{
      .dims = from.dims(), .bone_from_index = from.bone_from_index(), .occupancy = {}, .hardness = {}, .soft = {}, .labels = {}};
  std::vector<float> labels(from.bounds().count());
  for (std::vector<float>* field : {&dense.occupancy, &dense.hardness, &dense.soft}) field->resize(labels.size());
  from.read_occupancy(from.bounds(), dense.occupancy);
  from.read_hardness(from.bounds(), dense.hardness);
  from.read_soft(from.bounds(), dense.soft);
  from.read_labels(from.bounds(), labels);
  for (const float label : labels)
    dense.labels.push_back(label == static_cast<float>(VoxelLabel::brain) ? std::uint8_t{17} : static_cast<std::uint8_t>(label));
  const auto rebuilt = [&](const std::string& notes) {
    auto builder = BoneModelBuilder::create(dense.dims, dense.bone_from_index);
    REQUIRE(builder);
    REQUIRE(builder->add(from.bounds(), dense));
    return builder->finish(notes);
  };
  GivenHand hand([](std::uint64_t) { return place(Vec3(0.0, 0.0, -2e-3)); });
  SimulationOptions options;
  options.hand = &hand;
  Issues issues;
  const auto named = rebuilt(note_of({static_cast<VoxelLabel>(17), "Sagittal sinus", {}}) + "\n");
  auto made = Simulation::create(loaded.scene, named, loaded.tool, options, issues);
  REQUIRE_MESSAGE(made != nullptr, (issues.empty() ? "" : issues.front().text()));
  REQUIRE(made->run());
  // 3 mm of bone and 0.5 mm of dura below the tip.
  CHECK(std::abs(figure(*made, "zones", "closest_mine_mm") - 3.5) < std::sqrt(3.0) * 0.25);
  CHECK(Simulation::create(loaded.scene, rebuilt({}), loaded.tool, options, issues) == nullptr);
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().message.find("no label \"Sagittal sinus\"") != std::string::npos);
  CHECK(issues.front().place.find("small.toml:") == 0);
}

TEST_CASE("zones: with a bone that is moved, distance and direction move with it") {
  const std::string zones = "[zones]\n";
  const std::string motion = "[motion]\npivot_mm = [0, 0, 0]\n[[motion.key]]\ntime_s = 0\naxis = [1, 0, 0]\nangle_deg = 90\n";
  // +z of the bone is -y of the world.
  GivenHand at_rest([](std::uint64_t) { return place(Vec3(0.0, 0.0, -2e-3)); }),
      turned([](std::uint64_t) { return place(Vec3(0.0, 2e-3, 0.0)); });
  double distance[2];
  Vec3 away[2];
  for (const bool turns : {false, true})
    for (const bool contact : {false, true}) {
      SimulationOptions options;
      options.hand = turns ? &turned : &at_rest;
      SmallScene scene = free_scene({"duration_s=0.1"});
      scene.contact = contact;
      if (contact) scene.contact_keys = kPenaltyKeys;
      DrillRun run(scene_of(scene, zones + (turns ? motion : "")), options);
      run.run();
      const ZoneState* zone = run.simulation().stage().graph.find(slots::kZone);
      distance[turns] = zone->distance;
      away[turns] = zone->away;
      if (turns) CHECK(distance[1] == doctest::Approx(distance[0]).epsilon(1e-9));
    }
  CHECK(distance[0] > 2e-3);
  CHECK(away[0].z > 0.99);
  CHECK(away[1].y < -0.99);
}

TEST_CASE("zones: guidance pushes the hand away, does no work above its allowance at any rate, and without its table there is no force") {
  // From where no force acts, so that the servo's soft start has ended, to 0.2 mm inside and back, four times.
  for (const int hz : {100, 200, 1000, 5000}) {
    const auto hand_of = [hz](std::uint64_t tick) {
      return place(Vec3(0.0, 0.0, -3.4e-3 - 0.9e-3 * (1.0 - std::cos(12.0 * static_cast<double>(tick) / hz))));
    };
    GivenHand guided(hand_of), alone(hand_of);
    SimulationOptions options;
    const std::vector<std::string> sets{fmt::format("servo_hz={}", hz), "duration_s=2.0"};
    options.hand = &guided;
    DrillRun run(scene_of(free_scene(sets), "[zones]\n[zones.guidance]\nstart_mm = 1.0\n"), options);
    run.run();
    CAPTURE(hz);
    CHECK(guided.largest > (hz < 1000 ? 0.0 : 0.5));
    CHECK(guided.most <= 1e-3 + 1e-12);
    CHECK(figure(run.simulation(), "zones", "guidance_given_mJ") <= 1.0 + 1e-9);
    CHECK(figure(run.simulation(), "zones", "guidance_peak_N") == doctest::Approx(guided.largest).epsilon(0.02));
    options.hand = &alone;
    DrillRun without(scene_of(free_scene(sets), "[zones]\n"), options);
    without.run();
    CHECK(alone.largest == 0.0);
  }
}

namespace {

/// A hand that a thrust pushes down against a damper, so that the force that it gets moves it: dz/dt = (f - thrust) / damping.
class PushedHand final : public HandSource {
 public:
  explicit PushedHand(double sign) : sign_(sign) {}
  const HandState& read() noexcept override {
    state_.world_from_hand.translation = {0.0, 0.0, z};
    state_.tick = tick_++;
    return state_;
  }
  void apply(const Wrench& on_hand) noexcept override { z += 1e-3 * (sign_ * on_hand.force.z - 2.0) / 1000.0; }
  double z = -3.4e-3;  // [m]

 private:
  double sign_;
  HandState state_;
  std::uint64_t tick_ = 0;
};

}  // namespace

TEST_CASE(
    "zones: guidance holds a hand of 2 N back before the dura, which it enters without guidance; a force of the wrong sign helps it in") {
  // In 1.3 s at 2 N / (1000 N s/m) the hand alone goes 2.6 mm down, from 1.6 mm above the dura to 1.0 mm inside. Guidance of 4 N/mm begins 1 mm
  // above it, after 0.3 s; then the depth below its start is 0.5 mm (1 - exp(-t / 0.25 s)), 0.49 mm at the end: 0.51 mm above the dura.
  const auto closest = [](const std::string& keys, double sign) {
    PushedHand hand(sign);
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(scene_of(free_scene({"duration_s=1.3"}), "[zones]\n" + keys), options);
    run.run();
    return std::pair{figure(run.simulation(), "zones", "closest_dura_mm"), hand.z * 1e3};
  };
  const std::string guided =
      "[zones.guidance]\nstart_mm = 1.0\nstiffness_N_per_m = 4000\nlargest_N = 50\ndamping_N_s_per_m = 0\nallowance_mJ = 10\n";
  const auto [with, z_with] = closest(guided, 1.0);
  const auto [without, z_without] = closest("", 1.0);
  const auto [flipped, z_flipped] = closest(guided, -1.0);
  MESSAGE("closest to the dura: guided " << with << ", alone " << without << ", flipped " << flipped << " mm; hand at " << z_with << ", "
                                         << z_without << ", " << z_flipped << " mm");
  CHECK(z_without == doctest::Approx(-6.0).epsilon(1e-3));
  CHECK(std::abs(without + 1.0) < 0.25);  // a voxel
  CHECK(std::abs(with - 0.51) < 0.25);
  CHECK(std::abs(with - without - 1.51) < 0.25);
  CHECK(flipped < without - 0.25);  // the sabotage
}

TEST_CASE("zones: each key changes what it names") {
  const auto dive = [](std::uint64_t tick) {
    return place(Vec3(0.0, 0.0, -4e-3 - 1.2e-3 * std::sin(6.0 * static_cast<double>(tick) * 1e-3)));
  };
  const auto run = [&](const std::string& keys, const char* name) {
    GivenHand hand(dive);
    SimulationOptions options;
    options.hand = &hand;
    DrillRun drilled(scene_of(free_scene({"duration_s=1.0"}), "[zones]\n" + keys), options);
    drilled.run();
    return figure(drilled.simulation(), "zones", name);
  };
  CHECK(run("reach_mm = 1.3\n", "unknown_s") == 0.0);
  CHECK(run("[zones.guidance]\nstart_mm = 1.0\nlargest_N = 0.5\n", "guidance_peak_N") == doctest::Approx(0.5));
}

TEST_CASE(
    "zones: the guidance is stiffness_N_per_m times the depth below start_mm, and damping_N_s_per_m times the speed towards the zone") {
  // Down to 5.2 mm at up to 7.2 mm/s, and up again. The figures of depth and force are those of ticks next to each other: of a depth that changes by
  // 7 um a tick at most, and hardly at its turn. The servo finds the speed within a tick, too.
  struct Peak {
    double force, closest;  // [N], [mm]
  };
  const auto peak = [](const std::string& keys) {
    GivenHand hand(
        [](std::uint64_t tick) { return place(Vec3(0.0, 0.0, -4e-3 - 1.2e-3 * std::sin(6.0 * static_cast<double>(tick) * 1e-3))); });
    SimulationOptions options;
    options.hand = &hand;
    DrillRun drilled(scene_of(free_scene({"duration_s=1.0"}), "[zones]\n[zones.guidance]\nlargest_N = 50\nallowance_mJ = 1000\n" + keys),
                     options);
    drilled.run();
    REQUIRE(figure(drilled.simulation(), "zones", "guidance_limited_ticks") == 0.0);
    return Peak{figure(drilled.simulation(), "zones", "guidance_peak_N"), figure(drilled.simulation(), "zones", "closest_dura_mm")};
  };
  for (const auto& [start, stiffness] : {std::pair{1.0, 2000.0}, {0.4, 2000.0}, {1.0, 500.0}}) {
    CAPTURE(start);
    CAPTURE(stiffness);
    const Peak found = peak(fmt::format("start_mm = {}\nstiffness_N_per_m = {}\ndamping_N_s_per_m = 0\n", start, stiffness));
    CHECK(std::abs(found.force - stiffness * (start - found.closest) * 1e-3) < stiffness * 7.2e-6);
  }
  for (const double damping : {50.0, 100.0}) {
    CAPTURE(damping);
    const double force = peak(fmt::format("start_mm = 1.5\nstiffness_N_per_m = 1e-6\ndamping_N_s_per_m = {}\n", damping)).force;
    CHECK(std::abs(force / (damping * 7.2e-3) - 1.0) < 0.03);
  }
}

TEST_CASE("zones: a guidance of a hand at rest is its allowance over the way that the hand may accelerate in a tick") {
  // As for the dura: 1e-6 J / (100 m/s^2 x 1 ms^2) = 0.01 N, below 2000 N/m times the depth.
  const auto felt = [](double allowance, double acceleration) {
    GivenHand hand([](std::uint64_t) { return place(Vec3(0.0, 0.0, -4.9e-3)); });
    SimulationOptions options;
    options.hand = &hand;
    DrillRun run(scene_of(free_scene({"duration_s=0.5"}),
                          fmt::format("[zones]\n[zones.guidance]\nstart_mm = 1.0\nallowance_mJ = {}\nacceleration_m_per_s2 = {}\n",
                                      allowance, acceleration)),
                 options);
    run.run();
    return figure(run.simulation(), "zones", "guidance_peak_N");
  };
  CHECK(felt(0.001, 100.0) == doctest::Approx(0.01).epsilon(1e-9));
  CHECK(felt(0.002, 100.0) == doctest::Approx(0.02).epsilon(1e-9));
  CHECK(felt(0.001, 200.0) == doctest::Approx(0.005).epsilon(1e-9));
}

TEST_CASE("zones: the tone is heard only near a zone, with its level, and only with [sound]") {
  class Heard final : public SoundSink {
   public:
    void write(std::span<const float> samples) noexcept override { all.insert(all.end(), samples.begin(), samples.end()); }
    std::vector<float> all;
  };
  const auto loudest = [&](double z, const std::string& keys) {
    GivenHand hand([z](std::uint64_t) { return place(Vec3(0.0, 0.0, z)); });
    Heard heard;
    SimulationOptions options;
    options.hand = &hand;
    options.sound = &heard;
    DrillRun run(scene_of(free_scene({"duration_s=0.5", "tool.spin_rpm=0"}), keys), options);
    run.run();
    float out = 0.0f;
    for (const float sample : heard.all) out = std::max(out, std::abs(sample));
    return out;
  };
  CHECK(loudest(-5.2e-3, "[zones]\n") == 0.0f);
  CHECK(loudest(-2.0e-3, "[zones]\n[sound]\n") == 0.0f);
  CHECK(loudest(-5.2e-3, "[zones]\n[sound]\nvolume = 0.5\n") == doctest::Approx(0.1).epsilon(0.02));
  CHECK(loudest(-5.2e-3, "[zones]\ntone_level = 0.8\n[sound]\nvolume = 0.5\n") == doctest::Approx(0.4).epsilon(0.02));
}

TEST_CASE("zones: a replay gives the same voxels and forces, guidance included; an undo starts the guidance anew") {
  const TemporaryFolder folder;
  const std::string path = folder.file("guided.bhs");
  SmallScene scene{.volume = kSkullPatchKeys, .record = true, .sets = {"duration_s=3.0", "tool.erosion_scale=5"}};
  DrillRun run(scene_of(scene, "[zones]\n[zones.guidance]\nstart_mm = 4.5\n"), {.history = true});
  run_recorded(run, path);
  REQUIRE(figure(run.simulation(), "zones", "guidance_peak_N") > 0.5);
  ReplayRun again(path);
  CHECK(again.run().voxel_hash() == run.voxel_hash());
  CHECK(again.run().simulation().sent_hash() == run.simulation().sent_hash());
  CHECK(again.run().simulation().force_hash() == run.simulation().force_hash());
  CHECK(figure(again.run().simulation(), "zones", "closest_dura_mm") == figure(run.simulation(), "zones", "closest_dura_mm"));
  REQUIRE(run.simulation().stage().reset());
  // Without [zones] the same hand drills otherwise, since nothing pushes it.
  DrillRun other(scene);
  other.run();
  CHECK(other.simulation().sent_hash() != run.simulation().sent_hash());
}

TEST_CASE("zones: a scene that cannot be measured is refused with its place") {
  const auto first = [](const std::string& zones) {
    const Issues issues = issues_of(zones);
    REQUIRE_FALSE(issues.empty());
    CHECK(issues.front().place.find("small.toml:") == 0);
    CHECK(std::ranges::count(issues.front().place, ':') == 2);
    return issues.front().message;
  };
  CHECK(first("[zones]\n[[zones.zone]]\nname = \"no\"\nlabel = \"forbidden\"\n").find("no voxel of zone \"no\"") != std::string::npos);
  CHECK(first("[zones]\n[[zones.zone]]\nname = \"A b\"\n").find("small letters") != std::string::npos);
  CHECK(first("[zones]\n[[zones.zone]]\nname = \"a\"\nfrom_mm = [0, 0, 0]\nto_mm = [0, 0, 1]\nradius_mm = 1\nlabel = \"dura\"\n")
            .find("a tissue or a tube") != std::string::npos);
  CHECK(first("[zones]\n[[zones.zone]]\nname = \"a\"\nradius_mm = 1\n").find("needs from_mm") != std::string::npos);
  CHECK(first("[zones]\n[[zones.zone]]\nname = \"a\"\n[[zones.zone]]\nname = \"a\"\n").find("two zones") != std::string::npos);
  CHECK(first("[zones]\nreach_mm = 1.1\n").find("must be above 1.2 x warn_mm") != std::string::npos);
  CHECK(first("[zones]\n[zones.guidance]\nstart_mm = 10\n").find("guidance.start_mm") != std::string::npos);
  CHECK_FALSE(first("[zones]\nwarn = 1\n").empty());
  CHECK_FALSE(first("[zones]\nwarn_mm = -1\n").empty());
  Issues issues;
  const auto plate = TomlDocument::parse(scene_text({}) + "[zones]\n", "small.toml");
  auto loaded = load_scene(*plate, test_context(), issues);
  REQUIRE(loaded);
  CHECK(Simulation::create(loaded->scene, loaded->bone, loaded->tool, {}, issues) == nullptr);
  REQUIRE(issues.size() == 1);
  CHECK(issues.front().place.find("small.toml:") == 0);
}

TEST_CASE("zones: without the table there is no step, column or figure; with it the bits of bone and forces stay") {
  DrillRun without(SmallScene{.volume = kSkullPatchKeys, .sets = {"duration_s=1.5"}});
  DrillRun with(scene_of({.volume = kSkullPatchKeys, .sets = {"duration_s=1.5"}}, "[zones]\n"));
  for (DrillRun* run : {&without, &with}) run->run();
  CHECK(with.voxel_hash() == without.voxel_hash());
  CHECK(with.simulation().force_hash() == without.simulation().force_hash());
  CHECK(with.simulation().sent_hash() == without.simulation().sent_hash());
  const auto columns = [](DrillRun& run) {
    return std::ranges::count(run.simulation().stage().graph.columns(Clock::contact), std::string(kZoneDistanceColumn), &StepColumn::name);
  };
  CHECK(columns(without) == 0);
  CHECK(columns(with) == 1);
  CHECK_FALSE(without.simulation().stage().graph.is_written(slots::kZone.name));
}

}  // namespace burrhole::test
