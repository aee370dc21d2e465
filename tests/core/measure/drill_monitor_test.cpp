// The monitor tells front, breakthrough and tunnelling apart on bone that was cleared by hand.

#include "core/measure/drill_monitor.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/voxel/contact_window.h"
#include "tests/app/run/cleared_plate.h"

namespace burrhole::test {
namespace {

constexpr double kQuarter = 0.25 * ClearedPlate::kPitch;  // [m] between the places the monitor looks at

/// Shows the monitor the plate as it is, the tip at a depth on the axis.
void look(DrillMonitor& monitor, ClearedPlate& plate, double depth, double engagement, double time) {
  ContactWindowPublisher publisher(*plate.voxmap);
  publisher.publish(*plate.voxmap);
  const ContactView view(publisher.exchange().latest(), plate.bone->bone_from_index(), {});
  monitor.look(view, Vec3(0, 0, -depth), Vec3(0, 0, 10.0 * time), engagement, time);
}

TEST_CASE("monitor: cutting front and depth follow the hole, the force's peak stays") {
  ClearedPlate plate;
  DrillMonitor monitor(plate.approach);
  look(monitor, plate, -0.5e-3, 0.0, 0.2);
  CHECK(std::abs(monitor.progress().depth + 0.5e-3) < 1e-6);
  CHECK(monitor.progress().front <= kQuarter);
  plate.clear(2e-3, 1.25e-3);
  look(monitor, plate, 1.2e-3, 0.0, 0.1);
  CHECK(std::abs(monitor.progress().front - 1.25e-3) <= kQuarter);
  CHECK(monitor.progress().peak_force == doctest::Approx(2.0).epsilon(1e-12));
  CHECK_FALSE(monitor.progress().breakthrough_time.has_value());
}

TEST_CASE("monitor: bone that grew again is bone again, near the tip or not, and can be drilled through a second time") {
  ClearedPlate plate;
  DrillMonitor monitor(plate.approach);
  plate.clear(2e-3, 10e-3);
  look(monitor, plate, 2.9e-3, 0.0, 1.0);
  REQUIRE(monitor.progress().breakthrough_time.has_value());
  ClearedPlate whole;
  const std::vector<std::uint8_t> bone = bone_on_axis(whole.approach, *whole.voxmap);
  CHECK(std::ranges::count(bone, 1) == static_cast<std::ptrdiff_t>(bone.size()));
  CHECK(std::ranges::count(bone_on_axis(plate.approach, *plate.voxmap), 1) == 0);
  monitor.bone_grew(bone);
  CHECK_FALSE(monitor.progress().breakthrough_time.has_value());
  CHECK_FALSE(monitor.progress().passed_time.has_value());
  CHECK(monitor.progress().front <= kQuarter);
  CHECK(monitor.progress().peak_force == doctest::Approx(10.0).epsilon(1e-12));
  look(monitor, whole, 0.5e-3, 0.0, 1.5);
  CHECK(std::abs(monitor.progress().deepest - 0.5e-3) < 1e-9);  // [m]; not the depth in the bone that was taken back
  CHECK(std::abs(monitor.progress().undone - 2.9e-3) < 1e-9);
  look(monitor, plate, 2.9e-3, 0.0, 2.0);
  REQUIRE(monitor.progress().breakthrough_time.has_value());
  CHECK(*monitor.progress().breakthrough_time == 2.0);
}

TEST_CASE("monitor: an axis without bone at the start has no breakthrough, and nothing to pass") {
  ClearedPlate plate;
  plate.clear(2e-3, 10e-3);
  DrillMonitor monitor(plate.approach);
  monitor.start(bone_on_axis(plate.approach, *plate.voxmap));
  CHECK(monitor.progress().open_axis);
  look(monitor, plate, 5e-3, 0.0, 1.0);
  CHECK_FALSE(monitor.progress().breakthrough_time.has_value());
  CHECK_FALSE(monitor.progress().passed_time.has_value());
  CHECK(std::abs(monitor.progress().deepest - 5e-3) < 1e-9);
  CHECK(monitor.progress().largest_ahead < 0.0);
  DrillMonitor unaware(plate.approach);  // the twin that does not know the bone at the start
  look(unaware, plate, 5e-3, 0.0, 1.0);
  CHECK(unaware.progress().breakthrough_time.has_value());
}

TEST_CASE("monitor: of a hole that was begun before, only what the run cuts counts") {
  ClearedPlate plate;
  plate.clear(2e-3, 2e-3);
  DrillMonitor monitor(plate.approach);
  monitor.start(bone_on_axis(plate.approach, *plate.voxmap));
  CHECK_FALSE(monitor.progress().open_axis);
  look(monitor, plate, 3.5e-3, 0.0, 1.0);  // pushed through the last millimetre: none of it is cut
  REQUIRE(monitor.progress().passed_time.has_value());
  CHECK(monitor.progress().removed_at_passing == 0.0);
  CHECK_FALSE(monitor.progress().breakthrough_time.has_value());
  plate.clear(2e-3, 10e-3);
  look(monitor, plate, 3.5e-3, 0.0, 2.0);
  CHECK(monitor.progress().breakthrough_time == 2.0);
}

TEST_CASE("monitor: bone left on the axis ahead of the tip is no breakthrough, none left is one, noted once") {
  ClearedPlate plate;
  DrillMonitor monitor(plate.approach);
  plate.clear(2e-3, 2.5e-3);
  look(monitor, plate, 2.5e-3, 0.0, 1.0);
  CHECK_FALSE(monitor.progress().breakthrough_time.has_value());
  plate.clear(2e-3, 10e-3);
  look(monitor, plate, 2.9e-3, 0.0, 2.0);
  REQUIRE(monitor.progress().breakthrough_time.has_value());
  CHECK(*monitor.progress().breakthrough_time == 2.0);
  CHECK(std::abs(*monitor.progress().breakthrough_depth - 2.9e-3) < 1e-6);
  CHECK(monitor.progress().passed_time == 2.0);
  CHECK(monitor.progress().removed_at_passing == 1.0);
  CHECK(std::abs(monitor.progress().front - ClearedPlate::kThickness) < 1e-6);
  look(monitor, plate, 4.0e-3, 0.0, 3.0);
  CHECK(*monitor.progress().breakthrough_time == 2.0);
  CHECK(std::abs(monitor.progress().deepest - 4.0e-3) < 1e-6);
}

TEST_CASE("monitor: the tip is out of the bone once it is beyond the bone as loaded, not where the axis is clear ahead of it") {
  ClearedPlate plate;
  DrillMonitor monitor(plate.approach);
  plate.clear(2e-3, 10e-3);
  look(monitor, plate, 2.9e-3, 0.0, 1.0);
  REQUIRE(monitor.progress().breakthrough_time == 1.0);
  CHECK(monitor.progress().passed_time == 1.0);
  CHECK_FALSE(monitor.progress().out_time.has_value());
  look(monitor, plate, ClearedPlate::kThickness + 0.1e-3, 0.0, 2.0);
  CHECK(monitor.progress().out_time == 2.0);
  look(monitor, plate, ClearedPlate::kThickness + 0.5e-3, 0.0, 3.0);
  CHECK(monitor.progress().out_time == 2.0);
  ClearedPlate whole;
  monitor.bone_grew(bone_on_axis(whole.approach, *whole.voxmap));
  CHECK_FALSE(monitor.progress().out_time.has_value());
}

TEST_CASE("monitor: a tip ahead of the cutting front by more than it may engage is reported as tunnelling") {
  ClearedPlate plate;
  plate.clear(2e-3, 1.0e-3);
  DrillMonitor honest(plate.approach), tunnelled(plate.approach);
  look(honest, plate, 1.3e-3, 0.3e-3, 1.0);
  CHECK(std::abs(honest.progress().largest_ahead) <= kQuarter);
  look(tunnelled, plate, 2.5e-3, 0.0, 1.0);
  CHECK(tunnelled.progress().largest_ahead > 1.5e-3 - kQuarter);
  CHECK(tunnelled.progress().largest_ahead > ClearedPlate::kPitch);
}

TEST_CASE("monitor: a tip that passed the far side through bone is reported as pop-through, and is no breakthrough") {
  ClearedPlate plate;
  plate.clear(2e-3, 1.0e-3);
  DrillMonitor monitor(plate.approach);
  look(monitor, plate, 3.5e-3, 0.0, 1.0);
  CHECK(monitor.progress().passed_time == 1.0);
  CHECK_FALSE(monitor.progress().breakthrough_time.has_value());
  // A third of the axis is cleared; one place of 48 either way.
  CHECK(std::abs(monitor.progress().removed_at_passing - 1.0 / 3.0) < 0.04);
  // Nor is it one for a tool pushed so hard that its engaged depth is most of the bone.
  look(monitor, plate, 3.5e-3, 3.4e-3, 1.5);
  CHECK_FALSE(monitor.progress().breakthrough_time.has_value());
  // Once the rest is cut it is one.
  plate.clear(2e-3, 10e-3);
  look(monitor, plate, 3.5e-3, 0.0, 2.0);
  CHECK(monitor.progress().breakthrough_time == 2.0);
  CHECK(monitor.progress().passed_time == 1.0);
}

TEST_CASE("monitor: a bit that comes out while it is engaged in the last of the bone has broken through") {
  ClearedPlate plate;
  plate.clear(2e-3, 2.5e-3);
  DrillMonitor engaged(plate.approach), loose(plate.approach);
  const double tip = ClearedPlate::kThickness + 0.1e-3, uncut = tip - 2.5e-3;
  look(engaged, plate, tip, uncut, 1.0);
  CHECK(engaged.progress().breakthrough_time == 1.0);
  CHECK(engaged.progress().removed_at_passing < 0.9);
  look(loose, plate, tip, uncut - 1.5 * ClearedPlate::kPitch, 1.0);
  CHECK_FALSE(loose.progress().breakthrough_time.has_value());
  CHECK(loose.progress().passed_time == 1.0);
}

TEST_CASE("monitor: support ends where the thrust along the axis does, not at breakthrough, and grown bone takes that back") {
  ClearedPlate plate;
  DrillMonitor monitor(plate.approach);
  plate.clear(2e-3, 10e-3);
  ContactWindowPublisher publisher(*plate.voxmap);
  publisher.publish(*plate.voxmap);
  const ContactView view(publisher.exchange().latest(), plate.bone->bone_from_index(), {});
  double time = 0.0;
  const auto at = [&](double beyond, const Vec3& force) {
    monitor.look(view, Vec3(0.0, 0.0, -ClearedPlate::kThickness - beyond), force, 0.0, time += 0.05);
  };
  const Vec3 thrust(0.0, 0.0, 20.0);
  for (int n = 0; n < 20; ++n) at(-1e-3, thrust);
  at(0.1e-3, thrust);
  at(0.8e-3, thrust);  // a shoulder still cuts
  REQUIRE(monitor.progress().breakthrough_time.has_value());
  CHECK_FALSE(monitor.progress().loss.has_value());
  at(1.8e-3, Vec3(20.0, 0.0, 0.0));  // a force on its side carries no thrust
  at(2.8e-3, Vec3(0.0));
  at(0.5e-3, Vec3(0.0));
  REQUIRE(monitor.progress().loss.has_value());
  CHECK(monitor.progress().loss->time == doctest::Approx(22 * 0.05).epsilon(1e-9));
  CHECK(std::abs(monitor.progress().loss->depth - (ClearedPlate::kThickness + 0.8e-3)) < 1e-6);
  CHECK(std::abs(monitor.progress().loss->plunge - 2e-3) < 1e-6);
  ClearedPlate whole;
  monitor.bone_grew(bone_on_axis(whole.approach, *whole.voxmap));
  CHECK_FALSE(monitor.progress().loss.has_value());
}

TEST_CASE("monitor: distance from the axis counts in contact alone, and until the tip has passed the bone") {
  ClearedPlate plate;
  DrillMonitor monitor(plate.approach);
  ContactWindowPublisher publisher(*plate.voxmap);
  publisher.publish(*plate.voxmap);
  const ContactView view(publisher.exchange().latest(), plate.bone->bone_from_index(), {});
  double time = 0.0;
  const auto aside = [&](const Vec3& tip, double force) {
    monitor.look(view, tip, Vec3(0.0, 0.0, force), 0.0, time += 0.1);
    return monitor.progress().largest_aside;
  };
  CHECK(aside(Vec3(9e-3, 0.0, 1e-3), kAsideForce) == 0.0);
  CHECK(std::abs(aside(Vec3(3e-3, 4e-3, -1e-3), 1.01 * kAsideForce) - 5e-3) < 1e-9);
  CHECK(std::abs(aside(Vec3(1e-3, 0.0, -1e-3), 20.0) - 5e-3) < 1e-9);    // the largest stays
  CHECK(std::abs(aside(Vec3(6e-3, 0.0, -3.5e-3), 20.0) - 6e-3) < 1e-9);  // the tick in which it passes still counts
  CHECK(monitor.progress().passed_time.has_value());
  CHECK(std::abs(aside(Vec3(20e-3, 0.0, -4e-3), 20.0) - 6e-3) < 1e-9);
}

}  // namespace
}  // namespace burrhole::test
