// Every function marked BH_REALTIME takes no memory and no lock. Each case lists the functions that it runs on the trap, as
// "header: function"; scripts/check_realtime.py fails when a marked function is in no list, or a listed one is not marked.
#include <doctest/doctest.h>

#include "app/session/recorded_hand.h"
#include "app/stage/stage.h"
#include "core/base/spsc_queue.h"
#include "haptics/device/device_config.h"
#include "haptics/device/device_hand.h"
#include "haptics/hand/taken_hand.h"
#include "haptics/servo/realtime.h"
#include "tests/support/drill_scene.h"
#include "tests/support/memory_trap.h"
#include "tests/support/temporary_folder.h"

using namespace burrhole;
using namespace burrhole::test;

namespace {

template <class... T>
void covers(const T*...) {}  // the names are for the script

constexpr std::uint64_t kTicks = 2500;

SmallScene pressed(const std::string& contact_keys, std::vector<std::string> sets = {}) {
  SmallScene out{.contact_keys = contact_keys, .sets = {"duration_s=60", "hand.standoff_mm=0.3", "tool.erosion_scale=0.1"}};
  out.sets.insert(out.sets.end(), sets.begin(), sets.end());
  return out;
}

struct Outcome {
  TrapCounts taken;
  double largest_force = 0.0;  // [N]
  double removed = 0.0;        // [m^3]
};

/// The steps of a run as lockstep calls them: servo and contact on the trap, bone not.
Outcome drive(const LoadedScene& loaded, HandSource* hand = nullptr) {
  auto made =
      Stage::make(loaded.scene, loaded.scene.effects, loaded.bone, loaded.tool, {.sink = nullptr, .hand = hand, .restore_path = {}});
  REQUIRE_MESSAGE(made.ok(), (made ? "" : made.error().text()));
  Stage& parts = **made;
  Outcome out;
  clear_trap();
  for (std::uint64_t tick = 1; tick <= kTicks; ++tick) {
    on_trap([&] { parts.servo->sense(); });
    if (tick % parts.contact_every == 0)
      on_trap([&] {
        const ContactState& state = (*parts.contact)(parts.hand_mailbox.latest());
        parts.force_mailbox.publish(state);
        parts.tool_mailbox.publish(state);
      });
    on_trap([&] { out.largest_force = std::max(out.largest_force, glm::length(parts.act().force)); });
    if (tick % parts.bone_every == 0) parts.cut(parts.tool_mailbox.latest());
  }
  on_trap([&] {
    (*parts.servo)();
    static_cast<void>(parts.servo->reset());
  });
  out.taken = trapped();
  out.removed = parts.bone->removed_mass();
  return out;
}

void check_clean(const Outcome& outcome) {
  CHECK(outcome.taken.allocations == 0);
  CHECK(outcome.taken.locks == 0);
  CHECK(outcome.largest_force > 0.1);
  CHECK(outcome.removed > 0.0);
}

}  // namespace

TEST_CASE("real time: the constrained tool, its planes at the servo's rate, by every scheme") {
  covers("core/contact/constrained_tool.h: step", "core/contact/constrained_tool.h: describe",
         "core/contact/local_contact.h: force_gradient", "app/stage/stage.h: act", "app/stage/step_graph.h: run",
         "app/stage/step_graph.h: receive", "app/stage/step_graph.h: run_steps", "app/stage/step_graph.h: send",
         "app/stage/contact_tick.h: operator()", "core/base/triple_buffer.h: publish", "core/base/triple_buffer.h: latest",
         "core/base/snapshot_buffer.h: publish", "core/base/snapshot_buffer.h: latest", "haptics/servo/servo_step.h: sense",
         "haptics/servo/servo_step.h: act", "haptics/servo/servo_step.h: operator()", "haptics/servo/servo_step.h: reset",
         "haptics/servo/multi_rate.h: operator()", "haptics/servo/multi_rate.h: clear", "haptics/servo/local_tool.h: clear",
         "haptics/servo/local_tool.h: renew", "haptics/servo/local_tool.h: step", "haptics/servo/plane_loads.h: set_coupled",
         "haptics/servo/plane_loads.h: gradient", "haptics/hand/hand_source.h: read", "haptics/hand/hand_source.h: apply",
         "haptics/hand/hand_script.h: advance", "haptics/hand/simulated_hand.h: read", "haptics/hand/simulated_hand.h: apply",
         "haptics/hand/mass_spring_damper.h: step");
  for (const char* scheme : {"planes", "gradient", "hold", "linear"}) {
    CAPTURE(scheme);
    check_clean(drive(load_small(pressed(kHeldKeys, {std::string("servo.multirate=\"") + scheme + "\"", "contact.rate_hz=200"}))));
  }
  check_clean(drive(load_small(pressed(kHeldKeys))));
}

TEST_CASE("real time: contact at spin 0, between the points of the shell") {
  covers("core/tool/tool_surface.h: nearest");
  const Outcome outcome = drive(load_small(pressed(kHeldKeys, {"tool.spin_rpm=0"})));
  CHECK(outcome.taken.allocations == 0);
  CHECK(outcome.taken.locks == 0);
  CHECK(outcome.largest_force > 0.1);
}

/// A hand that leaps from far away to a place under the outer face, faster than any window follows.
class LeapingHand final : public HandSource {
 public:
  const HandState& read() noexcept override {
    state_.world_from_hand.translation = Vec3(0.0, 0.0, state_.tick < 15 ? 60e-3 : -0.5e-3);
    return state_;
  }
  void apply(const Wrench&) noexcept override { ++state_.tick; }

 private:
  HandState state_;
};

TEST_CASE("real time: free motion outside the window, and the hold before bone that has not been read, by every model") {
  covers("core/voxel/coarse_distance.h: at", "core/contact/shell_cover.h: clearance", "core/contact/shell_cover.h: reaches_unread",
         "core/contact/virtual_coupling.h: hold");
  for (const std::string& keys :
       {std::string(kHeldKeys), std::string(kPenaltyKeys), std::string(kPenaltyKeys) + "coupling = \"virtual\"\n"}) {
    CAPTURE(keys);
    LeapingHand hand;
    check_clean(drive(load_small(pressed(keys)), &hand));
  }
}

TEST_CASE("real time: the penalty models, in their own form and coupled, with their planes at the servo's rate") {
  covers("core/contact/contact_model.h: step", "core/contact/penalty_model.h: evaluate", "core/contact/gradient_plane.h: evaluate",
         "core/contact/packed_plane.h: evaluate", "core/contact/voxmap_contact.h: evaluate", "core/mesh/mesh_contact.h: evaluate",
         "core/contact/nearest_triangle.h: distance2_to", "core/contact/nearest_triangle.h: find_nearest",
         "core/contact/virtual_coupling.h: step", "core/contact/virtual_coupling.h: describe", "core/contact/local_contact.h: list_penalty",
         "haptics/servo/plane_loads.h: set_penalty", "haptics/servo/plane_loads.h: extrapolate");
  for (const char* model : {"gradient-plane", "voxmap", "mesh"})
    for (const char* coupling : {"none", "virtual"})
      for (const char* scheme : {"planes", "gradient"}) {
        CAPTURE(model);
        CAPTURE(coupling);
        CAPTURE(scheme);
        const std::string form = std::string(model) == "mesh" ? "\"\ntool = \"hand" : "";
        const std::string keys =
            std::string("model = \"") + model + form + "\"\nstiffness_N_per_m = 20e3\ncoupling = \"" + coupling + "\"\n";
        check_clean(drive(load_small(pressed(keys, {std::string("servo.multirate=\"") + scheme + "\"", "contact.rate_hz=500"}))));
      }
}

TEST_CASE("real time: the tool that triangles constrain, with its planes at the servo's rate, and with friction") {
  covers("core/mesh/mesh_gaps.h: probe");
  const std::string keys = "model = \"mesh\"\n" + std::string(kHeldKeys);
  check_clean(drive(load_small(pressed(keys, {"contact.rate_hz=500"}))));
  check_clean(drive(load_small(pressed(keys, {"friction.static_coefficient=0.4", "contact.rate_hz=200"}))));
}

TEST_CASE("real time: friction in every form of contact, at contact's rate and at the servo's") {
  covers("core/contact/tangential_law.h: loads", "core/contact/tangential_law.h: end_step", "haptics/servo/tool_trail.h: clear",
         "haptics/servo/tool_trail.h: add", "haptics/servo/tool_trail.h: drift", "haptics/servo/tool_trail.h: shift",
         "core/contact/friction.h: loads", "core/contact/friction.h: end_step", "core/contact/tangential_hold.h: solve",
         "core/contact/tangential_spring.h: list_pressed", "core/contact/tangential_spring.h: step",
         "haptics/servo/plane_loads.h: pressed");
  const std::vector<std::string> rubs{"friction.static_coefficient=0.4", "contact.rate_hz=200"};
  check_clean(drive(load_small(pressed(kHeldKeys, rubs))));
  for (const char* coupling : {"none", "virtual"}) {
    CAPTURE(coupling);
    check_clean(drive(load_small(pressed(std::string(kPenaltyKeys) + "coupling = \"" + coupling + "\"\n", rubs))));
  }
}

TEST_CASE("real time: a bone that moves, by keyframes and by the hand, under a bit that vibrates") {
  covers("haptics/hand/bone_drive.h: move", "app/stage/contact_tick.h: move", "haptics/servo/tip_vibration.h: operator()");
  const SmallScene scene = pressed(kHeldKeys);
  const std::string moves =
      "\n[vibration]\n[motion]\n[[motion.key]]\ntime_s = 0\n[[motion.key]]\ntime_s = 2\naxis = [0, 1, 1]\nangle_deg = 8\n";
  LoadedScene loaded = load_text(scene_text(scene) + moves, scene.sets);
  check_clean(drive(loaded));
}

TEST_CASE("real time: a bit that vibrates by its chips, and the drilling force") {
  covers("haptics/servo/chip_vibration.h: operator()", "haptics/servo/drilling_force.h: operator()");
  check_clean(drive(load_small(pressed(kHeldKeys, {"vibration.source=\"chips\"", "vibration.drilling_force={}"}))));
}

TEST_CASE("real time: zones with guidance, the dura, and blood") {
  covers("core/zone/distance_field.h: at", "haptics/servo/passive_force.h: operator()", "haptics/servo/virtual_fixture.h: operator()");
  SmallScene scene = pressed(kHeldKeys);
  scene.volume = kSkullPatchKeys;
  check_clean(drive(load_text(
      scene_text(scene) + "\n[zones]\n[zones.guidance]\nstart_mm = 6\n[dura]\nradius_mm = 3\nspacing_mm = 0.5\n[bleeding]\n", scene.sets)));
}

TEST_CASE("real time: heat and saline, which pictures show") {
  check_clean(drive(load_text(scene_text(pressed(kHeldKeys)) + "\n[heat]\n[heat.picture]\n[irrigation]\ndrawn = true\nalways = true\n",
                              pressed(kHeldKeys).sets)));
}

TEST_CASE("real time: a perforator whose clutch engages") {
  check_clean(
      drive(load_small(pressed(kHeldKeys, {"tool.name=\"perforator_14_11\"", "clutch.engage_N=5", "friction.static_coefficient=0.4"}))));
}

TEST_CASE("real time: every limit of the servo") {
  covers("haptics/servo/energy_observer.h: operator()", "haptics/servo/energy_observer.h: damping_force",
         "haptics/servo/swing_detector.h: operator()", "haptics/servo/force_limits.h: shortened",
         "haptics/servo/force_limits.h: operator()");
  check_clean(drive(load_small(pressed(kHeldKeys, {"servo.slew_N_per_s=1000", "servo.soft_start_s=0.2", "servo.energy_mJ=1000",
                                                   "servo.passivity_N_s_per_m=5", "servo.relied_on_N_s_per_m=5"}))));
}

TEST_CASE("real time: a simulated device, moved by the script and as a person's") {
  covers("haptics/device/plant.h: step", "haptics/device/haptic_device.h: read", "haptics/device/haptic_device.h: write",
         "haptics/device/simulated_device.h: read", "haptics/device/simulated_device.h: write",
         "haptics/device/simulated_device.h: set_goal", "haptics/device/simulated_device.h: shown", "haptics/device/device_hand.h: read",
         "haptics/device/device_hand.h: apply", "haptics/device/device_hand.h: drive_changed", "haptics/hand/hand_source.h: drive_changed",
         "haptics/hand/simulated_hand.h: drive_changed", "haptics/hand/feed_hand.h: read", "haptics/hand/feed_hand.h: apply",
         "haptics/hand/goal_hand.h: read", "haptics/hand/goal_hand.h: apply", "haptics/hand/goal_hand.h: start_from",
         "haptics/hand/taken_hand.h: read", "haptics/hand/taken_hand.h: apply", "haptics/hand/taken_hand.h: drive_changed",
         "haptics/device/device_hand.h: bone_ahead", "haptics/hand/hand_source.h: bone_ahead", "haptics/hand/simulated_hand.h: bone_ahead",
         "haptics/hand/taken_hand.h: bone_ahead", "haptics/device/device_hand.h: drill_stopped",
         "haptics/hand/hand_source.h: drill_stopped", "haptics/hand/simulated_hand.h: drill_stopped",
         "haptics/hand/taken_hand.h: drill_stopped", "haptics/device/device_hand.h: drill_at", "haptics/hand/hand_source.h: drill_at",
         "haptics/hand/simulated_hand.h: drill_at", "haptics/hand/taken_hand.h: drill_at", "haptics/device/device_hand.h: added_force",
         "haptics/hand/hand_source.h: added_force", "haptics/hand/simulated_hand.h: added_force", "haptics/hand/taken_hand.h: added_force");
  check_clean(drive(load_small(pressed(kHeldKeys, {"device.name=\"falcon\""}))));

  const LoadedScene loaded = load_small(pressed(kHeldKeys, {"device.name=\"falcon\""}));
  auto device = SimulatedDevice::create(loaded.scene.find<DeviceConfig>()->config, 1e-3);
  REQUIRE(device);
  auto hand = DeviceHand::create(*device, {});
  REQUIRE(hand);
  auto script = ScriptedDeviceHand::create(*device, {}, {}, {}, 1e-3);
  REQUIRE(script);
  auto alone = SimulatedHand::create({}, {}, 1e-3);
  REQUIRE(alone);
  auto bench = FeedHand::create({.feed = 0.1, .push = 2.0}, {}, 1e-3);  // in contact after 30 ticks, at the stop before 100
  REQUIRE(bench);
  GoalMailbox goals;
  auto user = GoalHand::create({}, {}, 1e-3, goals);
  REQUIRE(user);
  goals.publish({.place = {0.001, 0.0, -0.002}, .tilt_right = 0.1, .spins = true});
  GoalMailbox takers;
  auto taken = TakenHand::create(*alone, {}, {}, 1e-3, takers);
  REQUIRE(taken);
  clear_trap();
  on_trap([&] {
    for (int n = 0; n < 100; ++n) {
      static_cast<void>(user->read());
      user->apply({Vec3(0.0, 0.0, 2.0), Vec3(0.0)});
      if (n == 50) takers.publish({.spins = true, .takes_over = true});
      static_cast<void>(taken->read());
      taken->drive_changed();
      taken->drill_stopped();
      taken->bone_ahead(n % 2 == 0);
      taken->drill_at(Vec3(0.0, 0.0, -1e-5 * n));
      taken->added_force(Vec3(0.0, 0.0, 0.1));
      taken->apply({Vec3(0.0, 0.0, 2.0), Vec3(0.0)});
      device->set_goal({.rest = Vec3(0.0, 0.0, -1e-5 * n), .thrust = Vec3(0.0, 0.0, -1.0)});
      static_cast<void>(hand->read());
      static_cast<void>(device->shown(Vec3(0.0, 0.0, 100.0)));
      hand->apply({Vec3(0.0, 0.0, 2.0), Vec3(0.0)});
      static_cast<void>(bench->read());
      bench->apply({Vec3(0.0, 0.0, n > 20 && n < 40 ? 1.5 : 0.0), Vec3(0.0)});
      for (HandSource* source : {static_cast<HandSource*>(&*hand), static_cast<HandSource*>(&*script), static_cast<HandSource*>(&*alone)}) {
        source->drive_changed();
        source->drill_stopped();
        source->bone_ahead(n % 2 == 0);
        source->drill_at(Vec3(0.0, 0.0, -1e-5 * n));
        source->added_force(Vec3(0.0, 0.0, 0.1));
      }
    }
  });
  CHECK(trapped().allocations == 0);
  CHECK(trapped().locks == 0);
}

TEST_CASE("real time: a recorded hand") {
  covers("app/session/recorded_hand.h: read", "app/session/recorded_hand.h: apply");
  const TemporaryFolder folder;
  const std::string path = folder.file("run.sqlite");
  SmallScene scene = pressed(kHeldKeys);
  scene.sets[0] = "duration_s=2.5";
  DrillRun run(scene);
  run_recorded(run, path);
  const auto session = SessionReader::open(path);
  REQUIRE(session);
  auto hand = RecordedHand::create(*session);
  REQUIRE(hand);
  check_clean(drive(load_small(scene), &*hand));
}

TEST_CASE("real time: queues and the clock of ticks") {
  covers("core/base/spsc_queue.h: push", "core/base/spsc_queue.h: pop", "haptics/servo/realtime.h: next", "haptics/servo/realtime.h: wait");
  SpscQueue<int, 8> queue;
  TickPlan plan(1000, 1000);
  TickClock clock(now_monotonic(), 1e-4, 0.0);
  clear_trap();
  int taken = 0;
  std::uint64_t ticks = 0;
  on_trap([&] {
    for (int n = 0; n < 20; ++n) {
      static_cast<void>(queue.push(n));
      if (n % 2 == 1) static_cast<void>(queue.pop(taken));
      ticks += plan.next(1500 * n).ticks;
      ticks += clock.wait().ticks;
    }
  });
  CHECK(trapped().allocations == 0);
  CHECK(trapped().locks == 0);
  CHECK(ticks >= 40);
}

TEST_CASE("real time: sabotage: a hand that takes memory and a lock once is seen") {
  struct Careless final : HandSource {
    explicit Careless(const LoadedScene& loaded) : hand(loaded, [] {}) {}
    const HandState& read() noexcept override { return hand.read(); }
    void apply(const Wrench& on_hand) noexcept override {
      if (++ticks == 100) break_the_rules();
      hand.apply(on_hand);
    }
    WatchedHand hand;
    int ticks = 0;
  };
  const LoadedScene loaded = load_small(pressed(kHeldKeys));
  Careless careless(loaded);
  const Outcome outcome = drive(loaded, &careless);
  CHECK(outcome.taken.allocations == 2);
  CHECK(outcome.taken.locks == 1);
}
