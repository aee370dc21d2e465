// The push of a hand that keys, wheel and pad move, and the size of texts.
#include <doctest/doctest.h>

#include "tests/app/window/controls_rig.h"

using namespace burrhole;

TEST_CASE("controls: once nothing presses, the push falls to that of a resting hand; a lighter one stays") {
  const double stiffness = GoalHandConfig{}.dynamics.stiffness;
  const auto push_of = [&](const Rig& rig) { return stiffness * (-rig.place().z); };  // of a hand that bone holds at height 0
  const auto press = [&](Rig& rig, double newton) {
    rig.touch(newton, 0.0);
    rig.run(kStep);
    rig.handle(key(Key::w, true));
    while (push_of(rig) < newton) rig.run(kStep);
  };
  enum class By { release, focus, pad };
  for (const By by : {By::release, By::focus, By::pad}) {
    Rig rig;
    press(rig, 40.0);
    const double pressed = push_of(rig);
    if (by == By::pad) {
      rig.handle(key(Key::w, false));
      rig.run(0.2, {.present = true, .left_trigger = 1.0});
      CHECK(push_of(rig) > pressed + 1.0);
      continue;
    }
    rig.handle(by == By::release ? key(Key::w, false) : focus(false));
    rig.run(0.5);
    const double light = rig.config.light, left = std::exp(-0.5 / rig.config.relax);
    CHECK(push_of(rig) == doctest::Approx(light + (pressed - light) * left).epsilon(1e-6));
    rig.run(10.0);
    CHECK(push_of(rig) == doctest::Approx(light).epsilon(1e-6));
    CHECK(rig.controls.held_push() == 0.0);
  }
  Rig gentle;
  press(gentle, 1.5);
  gentle.handle(key(Key::w, false));
  const Vec3 before = gentle.place();
  gentle.run(5.0);
  CHECK(gentle.place() == before);
  Rig back;
  press(back, 40.0);
  back.handle(key(Key::w, false));
  back.handle(key(Key::s, true));
  const double start = back.place().z;
  back.run(0.1);
  CHECK(back.place().z == doctest::Approx(start + 0.1 * back.config.withdraw).epsilon(1e-9));  // S alone moves it
}

TEST_CASE("controls: the wheel holds a push, which W adds to, drilling uses up, and G gives up") {
  const double stiffness = GoalHandConfig{}.dynamics.stiffness;
  Rig rig;
  rig.touch(10.0, 0.0);
  rig.run(kStep);
  rig.handle(key(Key::w, true));
  while (rig.place().z > 0.0) rig.run(kStep);
  rig.handle(key(Key::w, false));
  for (int n = 0; n < 10; ++n) rig.handle(wheel(1.0));
  const double turned = stiffness * -rig.place().z;
  CHECK(turned >= 10.0 * rig.config.wheel_press * stiffness);
  rig.run(5.0);
  CHECK(stiffness * -rig.place().z == doctest::Approx(turned).epsilon(1e-9));
  CHECK(rig.controls.held_push() == doctest::Approx(turned).epsilon(1e-9));
  rig.handle(key(Key::w, true));
  rig.run(1.0);
  rig.handle(key(Key::w, false));
  CHECK(stiffness * -rig.place().z > turned + 10.0);
  rig.run(5.0);
  CHECK(stiffness * -rig.place().z == doctest::Approx(turned).epsilon(1e-6));
  rig.touch(10.0, -0.001);  // bone gives way by a millimetre
  rig.run(kStep);
  CHECK(rig.controls.held_push() == doctest::Approx(turned - 1e-3 * stiffness).epsilon(1e-6));
  rig.touch(10.0, 0.0);  // it is not given back
  rig.run(5.0);
  CHECK(rig.controls.held_push() == doctest::Approx(turned - 1e-3 * stiffness).epsilon(1e-6));
  rig.press(Key::g);
  rig.run(5.0);
  CHECK(rig.controls.held_push() == 0.0);
  CHECK(stiffness * -rig.place().z == doctest::Approx(rig.config.light).epsilon(1e-6));
}

TEST_CASE("controls: Ctrl with +, - and 0 changes the size of texts, and nothing else") {
  for (const bool watches : {false, true}) {
    ControlsSetup setup = Rig::setup();
    setup.text_scale = 1.5;
    if (watches) setup.transport = Transport(10.0, 0.001);
    Rig rig(setup);
    const CameraView camera = rig.controls.camera().camera();
    rig.handle(key(Key::left_control, true));
    rig.press(Key::equal);
    rig.press(Key::pad_plus);
    CHECK(rig.controls.requests().text_scale > 1.5 * 1.1);
    rig.press(Key::minus);
    rig.press(Key::minus);
    rig.press(Key::minus);
    CHECK(rig.controls.requests().text_scale < 1.5);
    rig.press(Key::digit_0);
    CHECK(rig.controls.requests().text_scale == 1.5);
    CHECK(rig.controls.camera().camera() == camera);
    CHECK_FALSE(rig.controls.take_input().has_value());
    rig.handle(key(Key::left_control, false));
    rig.press(Key::equal);
    CHECK(rig.controls.requests().text_scale == 1.5);
    CHECK_FALSE(rig.controls.camera().camera() == camera);
  }
}
