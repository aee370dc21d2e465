// [spindle] in a run: stall_torque_Nm and inertia_kg_m2 against the closed form of the motor's line, driven, braked, and under the torque of cutting.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/drill_scene.h"
#include "tests/support/temporary_folder.h"

namespace burrhole::test {
namespace {

constexpr double kFree = 1000.0 / 60.0, kStep = 0.02;  // [rev/s], [s] of the bone

struct SpindleKeys {
  double stall_torque = 2.0, inertia = 1e-4;
  [[nodiscard]] std::string text() const { return fmt::format("spindle={{stall_torque_Nm={}, inertia_kg_m2={}}}", stall_torque, inertia); }
  [[nodiscard]] double time_constant() const { return 2.0 * std::numbers::pi * inertia * kFree / stall_torque; }
  /// [rev/s] of a spindle after a bone step.
  [[nodiscard]] double next(double speed, double command, double torque) const {
    const double steady = kFree * (command - torque / stall_torque);
    return std::max(0.0, steady + (speed - steady) * std::exp(-kStep / time_constant()));
  }
};

/// [m] Mean distance of bone from the z axis.
double mean_radius(const BoneModel& bone) {
  std::vector<float> occupancy(bone.bounds().count());
  bone.read_occupancy(bone.bounds(), occupancy);
  double sum = 0.0, weight = 0.0;
  std::size_t n = 0;
  for_each_voxel(bone.bounds(), [&](const Vec3i& voxel) {
    const Vec3 at = bone.bone_from_index() * Vec3(voxel);
    sum += static_cast<double>(occupancy[n]) * std::hypot(at.x, at.y);
    weight += static_cast<double>(occupancy[n++]);
  });
  return sum / weight;
}

/// @param also a column of the same run, for `values`.
std::vector<double> spins(const SmallScene& scene, const SimulationOptions& options, const std::string& also = "",
                          std::vector<double>* values = nullptr) {
  const TemporaryFolder folder;
  DrillRun run(scene, options);
  run_recorded(run, folder.file("run.sqlite"));
  if (values != nullptr) *values = session_column(folder.file("run.sqlite"), also);
  return session_column(folder.file("run.sqlite"), "spin");
}

}  // namespace

TEST_CASE("spindle without load: braked and driven again it follows with 2 pi I n0 / M, by both keys") {
  // Off from 0.2 s, at half speed from 0.6 s, on from 0.8 s. A step rounds by some 1e-16 of 17 rev/s.
  for (const SpindleKeys& keys :
       {SpindleKeys{2.0, 2e-3}, SpindleKeys{2.0, 4e-3}, SpindleKeys{0.5, 2e-3}, SpindleKeys{2.0, 1e-4}, SpindleKeys{0.1, 0.0}}) {
    CAPTURE(keys.text());
    SimulationOptions options;
    options.inputs = {{200, InputKind::spin, 0.0, {}, {}}, {600, InputKind::spin, 0.5, {}, {}}, {800, InputKind::spin, 1.0, {}, {}}};
    const std::vector<double> found = spins({.record = true, .sets = {"duration_s=1.2", "hand.standoff_mm=8", keys.text()}}, options);
    REQUIRE(found.size() >= 59);
    const auto worst = [&](const SpindleKeys& these) {
      double speed = kFree, out = 0.0;
      for (std::size_t n = 0; n < found.size(); ++n) {
        const std::size_t tick = 20 * n;
        const double command = tick < 200 ? 1.0 : tick < 600 ? 0.0 : tick < 800 ? 0.5 : 1.0;
        speed = keys.inertia > 0.0 ? these.next(speed, command, 0.0) : kFree * command;
        out = std::max(out, std::abs(found[n] - speed));
      }
      return out;
    };
    MESSAGE("within " << worst(keys) << " rev/s");
    CHECK(worst(keys) < 1e-12);
    if (keys.time_constant() < 0.02) continue;  // too quick for a tenth to be seen after 20 ms
    CHECK(worst({1.1 * keys.stall_torque, keys.inertia}) > 0.1);
    CHECK(worst({keys.stall_torque, 1.1 * keys.inertia}) > 0.1);
  }
}

TEST_CASE("spindle under load: it settles at n0 (1 - M / stall_torque_Nm), and stalls at that torque") {
  // M = mu F r: half of the recorded force at the mean radius of the post that a flat bit wears down, by the bone in its columns. Without inertia the
  // speed is that of the torque in each step. A step takes columns of one layer unevenly, so its radius is not that of all; over 45 steps this is a few
  // layers, to a part of one: 2 %.
  const auto post = [](double stall, double push) {
    return SmallScene{
        .volume = kPostKeys,
        .record = true,
        .sets = {"duration_s=2.5", "tool.name=\"punch\"", fmt::format("hand.push_N={}", push), SpindleKeys{stall, 0.0}.text()}};
  };
  const double torque_of_force = 0.5 * mean_radius(*load_small(post(1.0, 20.0)).bone);
  struct Settled {
    double speed = 0.0, force = 0.0;  // [rev/s], [N]
  };
  const auto settled = [&](double stall, double push) {
    std::vector<double> force;
    const std::vector<double> spin = spins(post(stall, push), {}, "force_z", &force);
    Settled out;
    for (std::size_t n = 75; n < 120; ++n) out.speed += spin[n] / 45.0;
    for (std::size_t n = 75 * 20; n < 120 * 20; ++n) out.force += force[n] / 900.0;
    return out;
  };
  for (const auto& [stall, push] : {std::pair{0.1, 20.0}, {0.2, 20.0}, {1.0, 20.0}, {0.1, 10.0}}) {
    CAPTURE(stall);
    CAPTURE(push);
    const Settled found = settled(stall, push);
    const double lost = kFree * torque_of_force * found.force / stall;
    MESSAGE("force " << found.force << " N, lost " << kFree - found.speed << " rev/s, expected " << lost);
    CHECK(found.force == doctest::Approx(push).epsilon(0.05).scale(0.0));
    CHECK(kFree - found.speed == doctest::Approx(lost).epsilon(0.02).scale(0.0));
  }
  const double torque = torque_of_force * 20.0;
  CHECK(settled(0.9 * torque, 20.0).speed == 0.0);
  CHECK(settled(1.5 * torque, 20.0).speed ==
        doctest::Approx(kFree / 3.0).epsilon(0.07).scale(0.0));  // 2 % of what is lost, 1.2 of the force
}

}  // namespace burrhole::test
