#include "app/window/panel_text.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "app/stage/zone_state.h"
#include "core/base/rotation.h"
#include "core/base/units.h"

using namespace burrhole;

namespace {

Approach skull() {
  Approach out;
  out.thickness = 6e-3;
  out.layers = {{VoxelLabel::outer_table, 0.0, 2e-3}, {VoxelLabel::diploe, 2e-3, 4e-3}, {VoxelLabel::inner_table, 4e-3, 6e-3}};
  return out;
}

WindowPlan plan() {
  WindowPlan out;
  out.approach = skull();
  out.largest_push = 80.0;
  return out;
}

LiveState at(double cut, double depth, double newton = 10.0) {
  LiveState out;
  out.force = Vec3(0.0, 0.0, newton);
  out.progress.front = cut;
  out.progress.depth = out.progress.deepest = depth;
  return out;
}

bool has(const std::vector<std::string>& lines, const std::string& part) {
  return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("panel: the layer under the tip is that of the cutting front") {
  CHECK(layer_under_tip(plan(), at(0.0, -1.5e-3, 0.0)) == "air, 1.5 mm above the bone");
  CHECK(layer_under_tip(plan(), at(0.0, -0.1e-3)) == "outer table");
  CHECK(layer_under_tip(plan(), at(1.9e-3, 1.5e-3)) == "outer table");
  CHECK(layer_under_tip(plan(), at(3e-3, 3e-3)) == "diploe");
  CHECK(layer_under_tip(plan(), at(5e-3, 5e-3)) == "inner table");
  LiveState through = at(6e-3, 7e-3);
  through.progress.breakthrough_time = 12.0;
  CHECK(layer_under_tip(plan(), through) == "through the bone");
  through = at(6e-3, -5e-2, 0.0);
  through.progress.breakthrough_time = 12.0;
  CHECK(layer_under_tip(plan(), through) == "air, 50.0 mm above the bone");
}

TEST_CASE("panel: the drive shows its speed, or that the clutch has released the drill") {
  WindowPlan with_speed = plan();
  with_speed.spin_rpm = 1000.0;
  LiveState live = at(1e-3, 1e-3);
  live.hand.spin = 0.0;
  CHECK(drive_text(with_speed, live) == "off");
  live.hand.spin = 1.0;
  CHECK(drive_text(with_speed, live) == "1000 rpm");
  live.driven = true;
  CHECK(drive_text(with_speed, live) == "1000 rpm");
  live.driven = false;
  CHECK(drive_text(with_speed, live) == "clutch open");
  live.hand.spin = 0.0;
  CHECK(drive_text(with_speed, live) == "off");
}

TEST_CASE("panel: bone left falls with the cutting front, never below nothing") {
  CHECK(bone_left(skull(), at(0.0, -1e-3).progress) == doctest::Approx(6e-3));
  CHECK(bone_left(skull(), at(4.5e-3, 4e-3).progress) == doctest::Approx(1.5e-3));
  CHECK(bone_left(skull(), at(9e-3, 9e-3).progress) == 0.0);
}

TEST_CASE("panel: a person is warned of little bone, of the arm's limit, of leaning and of servo faults, and of nothing else") {
  WindowView view;
  view.live = at(3e-3, 3e-3);
  CHECK(warnings_of(plan(), view).empty());
  view.live = at(5.2e-3, 5e-3);
  CHECK(has(warnings_of(plan(), view), "0.8 mm of bone left"));
  view.live.progress.breakthrough_time = 10.0;
  view.live.hand.spin = 1.0;
  CHECK(has(warnings_of(plan(), view), "Through the bone"));
  view.live.hand.spin = 0.0;
  CHECK_FALSE(has(warnings_of(plan(), view), "Through the bone"));
  view.live = at(6e-3, 26e-3);
  view.live.progress.breakthrough_time = 10.0;  // the drill is off
  CHECK(has(warnings_of(plan(), view), "20 mm beyond the bone"));
  CHECK(beyond_bone(plan(), view.live) == doctest::Approx(20e-3));
  CHECK(beyond_bone(plan(), at(6e-3, 26e-3)) == 0.0);
  view.live = at(1e-3, 1e-3);
  view.live.hand.thrust = 79.0;
  CHECK(has(warnings_of(plan(), view), "largest force"));
  view.live.world_from_tool.rotation = glm::angleAxis(20.0 * kDegree, Vec3(0.6, 0.8, 0.0));
  CHECK(has(warnings_of(plan(), view), "20 degrees"));
  view.live.faults = kServoContactStale;
  CHECK(has(warnings_of(plan(), view), name_of(kServoContactStale)));
}

TEST_CASE("panel: a zone is shown with its distance, and warned of by its level alone") {
  WindowView view;
  view.live = at(3e-3, 3e-3);
  view.live.zone = ZoneReading{2.34e-3, kZoneClear};
  CHECK(zone_text(*view.live.zone) == "2.3 mm");
  CHECK(warnings_of(plan(), view).empty());
  view.live.zone = ZoneReading{0.8e-3, kZoneNear};
  CHECK(has(warnings_of(plan(), view), "0.8 mm from a zone"));
  view.live.zone = ZoneReading{-0.4e-3, kZoneInside};
  CHECK(zone_text(*view.live.zone) == "inside 0.4 mm");
  CHECK(has(warnings_of(plan(), view), "0.4 mm inside a zone: move back"));
}

TEST_CASE("panel: the angle is that between shaft and bone, also where the plan is oblique and the bone is turned") {
  WindowPlan oblique = plan();
  oblique.approach.normal = glm::normalize(Vec3(0.0, 0.5, 1.0));
  oblique.world_from_bone = {glm::angleAxis(0.7, Vec3(1.0, 0.0, 0.0)), Vec3(0.1, 0.0, 0.0)};
  LiveState live;
  live.world_from_tool.rotation = rotation_from_z(oblique.world_from_bone.rotate(oblique.approach.normal));
  CHECK(angle_to_surface(oblique, live) < 1e-6);
  live.world_from_tool.rotation = oblique.world_from_bone.rotation;  // along the bone's z
  CHECK(angle_to_surface(oblique, live) == doctest::Approx(std::atan(0.5)));
}

TEST_CASE("panel: beside the plan, bone left and layer are unknown and are not shown") {
  LiveState live = at(5.2e-3, 5e-3);
  live.world_from_tool.translation = Vec3(2e-3, 0.0, -5e-3);
  CHECK(bone_left_text(plan(), live) == "0.8 mm");
  live.world_from_tool.translation = Vec3(3e-3, -4e-3, -5e-3);
  CHECK(bone_left_text(plan(), live) == "-");
  CHECK(layer_under_tip(plan(), live) == "5.0 mm beside the plan");
  WindowView view;
  view.live = live;
  CHECK(has(warnings_of(plan(), view), "5.0 mm beside the plan"));
  CHECK_FALSE(has(warnings_of(plan(), view), "press less"));
}

TEST_CASE("panel: the end shows the result in the words of the report, with its flags") {
  RunSummary summary;
  const auto result_of = [](const RunSummary& s) {
    const auto figures = end_figures(s);
    REQUIRE(figures.front().first == "result");
    return figures.front().second;
  };
  CHECK(result_line(summary).starts_with("result: " + result_of(summary) + ": "));
  summary.plunge_mm = 3.0;
  summary.limits.plunge_mm = 1.5;
  const std::string shown = result_of(summary);
  CHECK(shown.ends_with(", plunged"));
  CHECK(result_line(summary).starts_with("result: " + shown.substr(0, shown.find(',')) + ": "));
}

TEST_CASE("panel: where bone moves, the panel has its motion and what was cut, and no warning speaks of the plan") {
  WindowPlan moving = plan();
  moving.bone_moves = true;
  moving.world_from_approach.translation = Vec3(10e-3, 0.0, 0.0);
  WindowView view;
  view.live = at(5.2e-3, 5e-3);
  view.live.world_from_tool.translation = Vec3(30e-3, 0.0, 0.0);
  view.live.world_from_tool.rotation = glm::angleAxis(40.0 * kDegree, Vec3(1.0, 0.0, 0.0));
  view.live.world_from_rest.rotation = glm::angleAxis(90.0 * kDegree, Vec3(0.0, 0.0, 1.0));
  view.live.removed = 117.2e-9;
  CHECK(warnings_of(plan(), view).size() == 2);  // beside the plan, and off the normal
  CHECK(warnings_of(moving, view).empty());
  view.live.hand.thrust = 79.0;
  CHECK(has(warnings_of(moving, view), "largest force"));
  CHECK(removed_text(view.live) == "117 mm3");
  view.live.removed = 2.34e-9;
  CHECK(removed_text(view.live) == "2.3 mm3");
  CHECK(turned_text(view.live) == "90 deg");
  CHECK(moved_text(moving, view.live) == "14.1 mm");  // a quarter round the origin: 10 mm times the root of 2
}

TEST_CASE("panel: the keys of the bone and of instruments are listed in scenes that have them, and in no others") {
  const auto lists = [](const WindowPlan& plan, const char* keys) {
    return std::ranges::count_if(key_table(plan), [&](const auto& row) { return std::string(row.first).starts_with(keys); });
  };
  WindowPlan plain, moving, assisted;
  moving.bone_moves = true;
  assisted.instruments = kWaxSwitch;
  CHECK(lists(moving, "Alt") == 2);
  CHECK(lists(plain, "Alt") == 0);
  CHECK(lists(assisted, "U, I, M") == 1);
  CHECK(lists(plain, "U, I, M") == 0);
  CHECK(key_table(moving).size() == key_table(plain).size() + 2);
}

TEST_CASE("panel: names of tools are read as words") {
  CHECK(tool_title("round_burr_4mm") == "round burr 4 mm");
  CHECK(tool_title("twist_drill_2_5mm") == "twist drill 2.5 mm");
  CHECK(tool_title("perforator_14_11") == "perforator 14/11");
  CHECK(tool_title("acosta_liu_round") == "acosta liu round");
}
