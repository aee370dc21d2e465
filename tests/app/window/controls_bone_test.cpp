// Keys that move the bone of a scene with [motion].
#include <doctest/doctest.h>

#include "haptics/hand/bone_drive.h"
#include "tests/app/window/controls_rig.h"

using namespace burrhole;

namespace {

/// The switches of the last input, and how many inputs there were.
struct Asked {
  int count = 0;
  std::uint32_t switches = 0;
};

Asked asked(Rig& rig) {
  Asked out;
  while (const auto input = rig.controls.take_input()) {
    CHECK(input->kind == InputKind::switches);
    out.switches = static_cast<std::uint32_t>(input->value);
    ++out.count;
  }
  return out;
}

Rig moving_rig() {
  ControlsSetup setup = Rig::setup();
  setup.bone_moves = true;
  return Rig(setup);
}

}  // namespace

TEST_CASE("controls: with Alt, keys switch the bone's motion and leave the hand where it is; each change is one input") {
  Rig rig = moving_rig();
  const Vec3 before = rig.place();
  rig.handle(key(Key::left_alt, true));
  rig.handle(key(Key::d, true));
  rig.handle(key(Key::up, true));
  rig.run(0.2);
  Asked now = asked(rig);
  CHECK(now.count == 1);
  CHECK(now.switches == (BoneSwitch::bit(0) | BoneSwitch::bit(6)));
  rig.handle(key(Key::d, false));
  rig.run(0.2);
  now = asked(rig);
  CHECK(now.count == 1);
  CHECK(now.switches == BoneSwitch::bit(6));
  rig.handle(key(Key::left_alt, false));
  rig.run(kStep);
  CHECK(asked(rig).switches == 0);
  CHECK(rig.place().z == before.z);
}

TEST_CASE("controls: a window that loses the focus stops the bone") {
  Rig rig = moving_rig();
  rig.handle(key(Key::right_alt, true));
  rig.handle(key(Key::left, true));
  rig.run(0.1);
  CHECK(asked(rig).switches == BoneSwitch::bit(10));
  rig.handle(focus(false));
  rig.run(kStep);
  const Asked now = asked(rig);
  CHECK(now.count == 1);
  CHECK(now.switches == 0);
}

TEST_CASE("controls: in a scene without [motion] Alt changes nothing: the keys move the hand") {
  Rig rig;
  const Vec3 before = rig.place();
  rig.handle(key(Key::left_alt, true));
  rig.handle(key(Key::w, true));
  rig.run(0.2);
  CHECK(asked(rig).count == 0);
  CHECK(rig.place().z < before.z);
}
