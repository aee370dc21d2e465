// What keys, mouse and pad mean, from recorded events: no window is needed.
#include "tests/app/window/controls_rig.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace burrhole;

TEST_CASE("controls: nothing pressed, nothing moves") {
  Rig rig;
  const Vec3 before = rig.place();
  rig.run(2.0);
  CHECK(rig.place() == before);
  CHECK_FALSE(rig.controls.goal().spins);
  CHECK_FALSE(rig.controls.take_input().has_value());
}

TEST_CASE("controls: W advances at its speed, slower in contact and with Shift; S moves back at once") {
  Rig rig;
  const double start = rig.place().z;
  rig.handle(key(Key::w, true));
  rig.run(0.5);
  CHECK(rig.place().z == doctest::Approx(start - 0.5 * rig.config.advance).epsilon(1e-9));
  rig.touch(10.0, 0.0);
  const double touched = rig.place().z;
  rig.run(0.5);
  CHECK(rig.place().z == doctest::Approx(touched - 0.5 * rig.config.press).epsilon(1e-9));
  rig.handle(key(Key::left_shift, true));
  const double fine = rig.place().z;
  rig.run(0.5);
  CHECK(rig.place().z == doctest::Approx(fine - 0.5 * rig.config.press / rig.config.fine).epsilon(1e-9));
  rig.handle(key(Key::left_shift, false));
  rig.handle(key(Key::w, false));
  rig.handle(key(Key::s, true));
  const double back = rig.place().z;
  rig.run(0.2);
  CHECK(rig.place().z == doctest::Approx(back + 0.2 * rig.config.withdraw).epsilon(1e-9));
}

TEST_CASE("controls: the goal waits where the arm is at its largest force, so that the first move back lowers the thrust") {
  Rig rig;
  rig.touch(80.0, -0.002);
  rig.handle(key(Key::w, true));
  rig.run(30.0);
  const GoalHandConfig hand;
  CHECK(rig.place().z == doctest::Approx(-0.002 - hand.push / hand.dynamics.stiffness).epsilon(1e-9));
}

TEST_CASE("controls: without bone the goal ends at its deepest, and never leaves the reach") {
  Rig rig;
  rig.handle(key(Key::w, true));
  rig.handle(key(Key::right, true));
  rig.run(60.0);
  CHECK(rig.place().z == doctest::Approx(-Rig::setup().deepest));
  CHECK(rig.place().x <= 0.05 + 1e-12);
  CHECK(rig.place().x > 0.049);
}

TEST_CASE("controls: the drill spins while Space is held, or locked by X, and stops when the window loses the focus") {
  Rig rig;
  rig.handle(key(Key::space, true));
  rig.run(0.05);
  CHECK(rig.controls.goal().spins);
  rig.handle(key(Key::space, false));
  rig.run(0.05);
  CHECK_FALSE(rig.controls.goal().spins);
  rig.press(Key::x);
  rig.run(0.05);
  CHECK(rig.controls.goal().spins);
  rig.handle(focus(false));
  rig.run(0.05);
  CHECK_FALSE(rig.controls.goal().spins);
  rig.handle(focus(true));
  rig.handle(key(Key::space, true));
  rig.handle(key(Key::w, true));
  rig.handle(focus(false));  // no release will come
  const Vec3 before = rig.place();
  rig.run(1.0);
  CHECK_FALSE(rig.controls.goal().spins);
  CHECK(rig.place() == before);
}

TEST_CASE("controls: arrows and left drag move across the bone as the picture shows it; right drag turns only the view") {
  Rig rig;
  rig.handle(key(Key::right, true));
  rig.run(0.5);
  rig.handle(key(Key::right, false));
  CHECK(rig.place().x == doctest::Approx(0.5 * rig.config.slide).epsilon(1e-9));
  CHECK(std::abs(rig.place().y) < 1e-12);
  const Vec3 before = rig.place();
  rig.handle(button(MouseButton::left, true, 300, 300));
  rig.handle(motion(300, 240));  // up by a tenth of the picture
  rig.handle(button(MouseButton::left, false, 300, 240));
  rig.handle(motion(500, 500));
  CHECK(rig.place().y - before.y == doctest::Approx(rig.controls.camera().length_of(0.1)).epsilon(1e-9));
  CHECK(rig.place().x == doctest::Approx(before.x));
  const CameraView camera = rig.controls.camera().camera();
  const Vec3 rest = rig.place();
  rig.handle(button(MouseButton::right, true, 300, 300));
  rig.handle(motion(400, 300));
  CHECK(rig.place() == rest);
  CHECK_FALSE(rig.controls.camera().camera() == camera);
}

TEST_CASE("controls: the panel's mouse moves nothing, and a drag that begins beside the picture neither") {
  Rig rig;
  const Vec3 before = rig.place();
  rig.handle(button(MouseButton::left, true, 300, 300), true);
  rig.handle(motion(400, 400), true);
  rig.handle(button(MouseButton::left, false, 400, 400), true);
  rig.handle(wheel(3.0), true);
  rig.handle(button(MouseButton::left, true, 900, 300));
  rig.handle(motion(700, 300));
  CHECK(rig.place() == before);
}

TEST_CASE("controls: the wheel advances a step away from the person, and zooms with Ctrl") {
  Rig rig;
  const double before = rig.place().z;
  rig.handle(wheel(2.0));
  CHECK(rig.place().z == doctest::Approx(before - 2.0 * rig.config.wheel).epsilon(1e-12));
  const CameraView camera = rig.controls.camera().camera();
  rig.handle(key(Key::left_control, true));
  rig.handle(wheel(1.0));
  CHECK(rig.place().z == doctest::Approx(before - 2.0 * rig.config.wheel).epsilon(1e-12));
  const auto distance = [](const CameraView& c) { return glm::length(c.eye - c.target); };
  CHECK(distance(rig.controls.camera().camera()) == doctest::Approx(distance(camera) / 1.1).epsilon(1e-9));
}

TEST_CASE("controls: leaning keys lean in the picture's directions, up to the arm's largest tilt; R straightens") {
  Rig rig;
  rig.handle(key(Key::d, true));
  rig.run(0.2);
  CHECK(rig.controls.goal().tilt_right == doctest::Approx(0.2 * rig.config.tilt).epsilon(1e-9));
  CHECK(std::abs(rig.controls.goal().tilt_away) < 1e-12);
  rig.run(30.0);
  CHECK(std::hypot(rig.controls.goal().tilt_right, rig.controls.goal().tilt_away) ==
        doctest::Approx(GoalHandConfig{}.largest_tilt).epsilon(1e-9));
  rig.handle(key(Key::d, false));
  rig.press(Key::r);
  CHECK(rig.controls.goal().tilt_right == 0.0);
}

TEST_CASE("controls: before the first tick, in a pause and after the end nothing moves the goal") {
  const auto try_all = [](Rig& rig) {
    const Vec3 before = rig.place();
    rig.handle(key(Key::w, true));
    rig.handle(wheel(5.0));
    rig.handle(button(MouseButton::left, true, 300, 300));
    rig.handle(motion(300, 240));
    rig.handle(button(MouseButton::left, false, 300, 240));
    rig.press(Key::home);
    rig.handle(key(Key::space, true));
    rig.run(0.5, {.present = true, .left_x = 1.0, .right_trigger = 1.0});
    rig.handle(key(Key::w, false));
    rig.handle(key(Key::space, false));
    return rig.place() == before && !rig.controls.goal().spins;
  };
  Rig early;
  early.live.hand.tick = 0;
  early.run(kStep);
  CHECK(try_all(early));
  Rig paused;
  paused.press(Key::x);
  paused.handle(wheel(3.0));  // so that Home would move it
  paused.press(Key::p);
  CHECK(try_all(paused));
  CHECK_FALSE(paused.controls.locked_on());
  Rig over;
  over.controls.end();
  CHECK(try_all(over));
  Rig free;
  CHECK_FALSE(try_all(free));
}

TEST_CASE("controls: bit and bone are not changed with the bit in the bone, and the person is answered") {
  Rig rig;
  rig.live.progress.depth = 1e-3;
  rig.run(kStep);
  for (const Key which : {Key::z, static_cast<Key>('2')}) {
    rig.press(which);
    CHECK_FALSE(rig.controls.take_input().has_value());
    CHECK(rig.controls.take_answer().find("out of the bone") != std::string::npos);
  }
  CHECK(rig.controls.checkpoint("a"));
  rig.live.progress.depth = -1e-3;
  rig.run(kStep);
  rig.press(Key::z);
  CHECK(rig.controls.take_answer().empty());
  CHECK(rig.controls.take_input()->kind == InputKind::checkpoint);
  CHECK(rig.controls.take_input()->kind == InputKind::undo);
}

TEST_CASE("controls: in a hole, arrows do not wind the goal up beyond the force of the arm") {
  Rig rig;
  rig.touch(20.0, -0.003);
  rig.handle(key(Key::right, true));
  rig.run(20.0);
  const GoalHandConfig hand;
  CHECK(glm::length(rig.place() - Vec3(0.0, 0.0, -0.003)) <= hand.push / hand.dynamics.stiffness * (1.0 + 1e-9));
}

TEST_CASE("controls: inputs of the run come in order, none in a pause and none after the end") {
  Rig rig;
  rig.press(static_cast<Key>('2'));
  rig.press(static_cast<Key>('9'));  // no such tool
  rig.press(Key::z);
  rig.press(Key::p);
  rig.press(Key::z);  // in the pause
  rig.handle(key(Key::w, true));
  const Vec3 before = rig.place();
  rig.run(1.0);
  CHECK(rig.place() == before);
  CHECK(rig.controls.paused());
  rig.press(Key::p);
  CHECK_FALSE(rig.controls.paused());
  std::vector<InputKind> kinds;
  std::string tool;
  while (auto input = rig.controls.take_input()) {
    kinds.push_back(input->kind);
    if (input->kind == InputKind::tool) tool = input->text + ", " + input->data;
  }
  CHECK(kinds == std::vector<InputKind>{InputKind::tool, InputKind::undo, InputKind::pause});
  CHECK(tool == "b, text b");
  rig.press(Key::escape);
  CHECK(rig.controls.requests().asks_end);
  rig.press(Key::enter);
  CHECK(rig.controls.goal().ends);
  rig.press(Key::z);
  CHECK_FALSE(rig.controls.take_input().has_value());
  rig.run(0.1);
  CHECK_FALSE(rig.controls.goal().spins);
}

TEST_CASE("controls: the bone can be exported in bone, in a pause, in a demonstration and in a watched session; nothing else in a pause") {
  Rig rig;
  rig.live.progress.depth = 1e-3;
  rig.run(kStep);
  rig.press(Key::f9);
  CHECK(rig.controls.take_answer().empty());
  const auto asked = rig.controls.take_query();
  REQUIRE(asked);
  CHECK(asked->kind == InputKind::export_bone);
  CHECK(asked->text == "stl");
  CHECK_FALSE(rig.controls.has_query());
  rig.press(Key::p);
  CHECK_FALSE(rig.controls.take_query().has_value());  // the pause itself is for the run
  CHECK(rig.controls.take_input()->kind == InputKind::pause);
  rig.press(Key::z);
  CHECK_FALSE(rig.controls.take_answer().empty());
  rig.press(Key::f9);
  CHECK(rig.controls.take_answer().empty());
  CHECK(rig.controls.take_query()->kind == InputKind::export_bone);

  ControlsSetup setup = Rig::setup();
  setup.demonstration = true;
  Rig shown(setup);
  shown.press(Key::f9);
  CHECK(shown.controls.take_query().has_value());
  setup.demonstration = false;
  setup.transport = Transport(3.0, 1e-3);
  Rig watched(setup);
  watched.press(Key::f9);
  CHECK(watched.controls.take_input()->kind == InputKind::export_bone);
  watched.press(Key::z);
  CHECK_FALSE(watched.controls.has_query());
}

TEST_CASE("controls: suction and irrigation are switched, wax is a pulse; a scene without them answers, and a pause changes none") {
  ControlsSetup setup = Rig::setup();
  setup.instruments = kSuctionSwitch | kWaxSwitch;
  Rig rig(setup);
  const auto asked = [&]() -> std::optional<std::uint32_t> {
    std::optional<std::uint32_t> last;
    while (const auto input = rig.controls.take_input())
      if (input->kind == InputKind::switches) last = static_cast<std::uint32_t>(input->value);
    return last;
  };
  rig.press(Key::u);
  rig.run(0.1);
  CHECK(asked() == std::optional<std::uint32_t>(kSuctionSwitch));
  rig.press(Key::m);
  rig.run(kStep);
  CHECK(asked() == std::optional<std::uint32_t>(kSuctionSwitch | kWaxSwitch));
  rig.run(ControlsConfig{}.wax - 2 * kStep);
  CHECK_FALSE(asked().has_value());
  rig.run(3 * kStep);
  CHECK(asked() == std::optional<std::uint32_t>(kSuctionSwitch));
  rig.press(Key::i);
  rig.run(kStep);
  CHECK(rig.controls.take_answer().find("[irrigation] by_switch") != std::string::npos);
  CHECK_FALSE(asked().has_value());
  rig.press(Key::p);
  rig.press(Key::u);
  rig.run(1.0);
  CHECK(rig.controls.take_answer().find("Paused") != std::string::npos);
  CHECK_FALSE(asked().has_value());
  rig.press(Key::p);
  rig.press(Key::u);
  rig.run(kStep);
  CHECK(asked() == std::optional<std::uint32_t>(0u));
}

TEST_CASE("controls: a switch that changes as a pause begins is no reason to go on; a query behind it is") {
  ControlsSetup setup = Rig::setup();
  setup.bone_moves = true;
  Rig rig(setup);
  rig.handle(key(Key::left_alt, true));
  rig.handle(key(Key::d, true));
  rig.run(kStep);
  CHECK(rig.controls.take_input()->kind == InputKind::switches);
  rig.press(Key::p);
  rig.run(kStep);
  CHECK(rig.controls.take_input()->kind == InputKind::pause);
  CHECK_FALSE(rig.controls.has_query());
  rig.press(Key::f9);
  CHECK(rig.controls.has_query());
  CHECK(rig.controls.take_query()->kind == InputKind::export_bone);
  CHECK(rig.controls.take_input()->kind == InputKind::switches);  // for the run when it goes on
}

TEST_CASE("controls: a game pad moves, drills and undoes; a pad that is gone stops the drill") {
  Rig rig;
  PadState pad{.present = true};
  pad.left_x = 1.0;
  pad.left_trigger = 1.0;
  pad.right_trigger = 1.0;
  rig.run(0.5, pad);
  CHECK(rig.place().x == doctest::Approx(0.5 * rig.config.slide).epsilon(1e-9));
  CHECK(rig.place().z == doctest::Approx(GoalHandConfig{}.standoff - 0.5 * rig.config.advance).epsilon(1e-9));
  CHECK(rig.controls.goal().spins);
  pad.start = true;
  rig.run(0.1, pad);
  CHECK(rig.controls.paused());
  pad.start = false;
  rig.run(0.1, pad);
  pad.start = true;
  rig.run(0.1, pad);  // and on again
  CHECK_FALSE(rig.controls.paused());
  CHECK(rig.controls.take_input()->kind == InputKind::pause);
  pad.b = true;
  rig.run(0.1, pad);
  CHECK(rig.controls.take_input()->kind == InputKind::undo);
  CHECK_FALSE(rig.controls.take_input().has_value());  // held is pressed once
  const Vec3 before = rig.place();
  rig.run(0.5, {});
  CHECK_FALSE(rig.controls.goal().spins);
  CHECK(rig.place() == before);
  PadState idle{.present = true};
  idle.left_x = 0.1;  // a worn stick
  rig.run(0.5, idle);
  CHECK(rig.place() == before);
  idle.left_x = std::numeric_limits<double>::quiet_NaN();
  rig.run(0.5, idle);
  CHECK(rig.place() == before);
}

TEST_CASE("controls: a demonstration is the script's until it is taken over, from where the hand is") {
  ControlsSetup setup = Rig::setup();
  setup.demonstration = true;
  Rig rig(setup);
  const Vec3 before = rig.place();
  rig.handle(key(Key::w, true));
  rig.run(0.5);
  rig.handle(key(Key::w, false));
  rig.press(Key::z);
  CHECK(rig.place() == before);
  CHECK_FALSE(rig.controls.take_input());
  rig.touch(28.0, -0.004);
  rig.live.hand.thrust = 28.0;
  rig.live.hand.spin = 1.0;
  rig.run(kStep);
  rig.press(Key::t);
  CHECK(rig.controls.goal().takes_over);
  CHECK(rig.place().z == doctest::Approx(-0.004 - 28.0 / setup.hand.dynamics.stiffness));
  rig.run(kStep);
  CHECK(rig.controls.goal().spins);  // as it did
  rig.handle(key(Key::s, true));
  rig.run(0.2);
  rig.handle(key(Key::s, false));
  CHECK(rig.place().z > -0.004);
  rig.press(Key::x);
  rig.run(kStep);
  CHECK_FALSE(rig.controls.goal().spins);
}

TEST_CASE("controls: the keys of a watched session move its head and the view, and no goal") {
  ControlsSetup setup = Rig::setup();
  setup.transport = Transport(20.0, 1e-3);
  Rig rig(setup);
  Transport& transport = *rig.controls.transport();
  const Vec3 before = rig.place();
  transport.arrive(5.0);
  transport.jump(5.0);
  rig.press(Key::space);
  CHECK_FALSE(transport.runs());
  rig.press(Key::right);
  CHECK(transport.head() == doctest::Approx(6.0));
  rig.handle(key(Key::left_shift, true));
  rig.press(Key::left);
  rig.handle(key(Key::left_shift, false));
  CHECK(transport.head() == doctest::Approx(5.99));
  rig.press(Key::up);
  CHECK(transport.speed() == 2.0);
  rig.press(Key::down);
  rig.press(Key::down);
  CHECK(transport.speed() == 0.5);
  const CameraView camera = rig.controls.camera().camera();
  rig.handle(key(Key::left_control, true));
  rig.handle(key(Key::left, true));
  rig.run(0.1);
  rig.handle(key(Key::left, false));
  rig.handle(key(Key::left_control, false));
  CHECK_FALSE(rig.controls.camera().camera() == camera);
  CHECK(transport.head() == doctest::Approx(5.99));
  for (const Key other : {Key::w, Key::x, Key::z, Key::r, Key::digit_0, Key::t}) rig.press(other);
  rig.run(0.1);
  CHECK(rig.place() == before);
  CHECK_FALSE(rig.controls.goal().spins);
  CHECK_FALSE(rig.controls.take_input());
  rig.press(Key::home);
  CHECK(transport.head() == 0.0);
  rig.press(Key::escape);
  CHECK(rig.controls.goal().ends);
}

TEST_CASE("controls: in contact the goal does not run away to the side, where bone holds the bit") {
  Rig rig;
  rig.touch(20.0, -0.003);
  rig.run(kStep);
  rig.handle(key(Key::right, true));
  rig.run(2.0);
  rig.handle(key(Key::right, false));
  const Vec3 aside(rig.place().x, rig.place().y, 0.0);
  CHECK(glm::length(aside) == doctest::Approx(rig.config.aside));
  rig.touch(0.0, -0.003);  // free
  rig.run(kStep);
  rig.handle(key(Key::right, true));
  rig.run(1.0);
  rig.handle(key(Key::right, false));
  CHECK(std::hypot(rig.place().x, rig.place().y) > 2.0 * rig.config.aside);
}
