// A coupling that follows the hardness of bone: the slope of the force that a hand feels on table and diploe, and that the changing spring
// generates no energy.
#include "core/contact/felt_hardness.h"

#include <doctest/doctest.h>

#include "core/base/random.h"
#include "surface_support.h"

using namespace burrhole;
using namespace burrhole::contact_test;

namespace {

constexpr double kTable = 0.9,
                 kDiploe = 0.35;  // hardness of the tables and diploe of the phantom skull_patch: 0.85 to 0.95, and 0.1 to 0.5

/// A block under z = 0 of one hardness above a depth and of another one below it.
DenseBone block(double upper, double lower, double border) {
  DenseBone bone;
  bone.dims = Vec3i(24, 24, 40);
  bone.bone_from_index = Affine::scaling(kFineEdge, Vec3(-11.5, -11.5, -31.5) * kFineEdge);
  for_each_voxel({Vec3i(0), bone.dims}, [&](const Vec3i& v) {
    const double z = (bone.bone_from_index * Vec3(v)).z;
    bone.occupancy.push_back(static_cast<float>(std::clamp(0.5 - z / (2.0 * kFineEdge), 0.0, 1.0)));
    bone.hardness.push_back(static_cast<float>(z > -border ? upper : lower));
    bone.labels.push_back(static_cast<std::uint8_t>(z <= 0.0 ? VoxelLabel::bone : VoxelLabel::none));
  });
  return bone;
}

PointShell one_point() {
  PointShell shell;
  shell.positions = {Vec3(0.0)};
  shell.inward_normals = {Vec3(0.0, 0.0, 1.0)};
  shell.cutting = {0};
  return shell;
}

/// [N/m] The slope of the force between two depths of the hand, each held until all has settled.
double slope_on(double hardness, double felt) {
  const ShippedBone bone(block(hardness, hardness, 1.0));
  ConstrainedToolConfig config = locked();
  config.felt_hardness = felt;
  auto made = ConstrainedTool::create(config, one_point(), kFineEdge);
  REQUIRE(made.ok());
  ConstrainedTool& tool = made.value();
  const auto force_at = [&](double depth) {
    for (int tick = 0; tick < 300; ++tick) (void)tool.step(bone.view(), {{glm::identity<Quat>(), Vec3(0.0, 0.0, -depth)}, Vec3(0.0)}, 1e-3);
    return tool.state().on_hand.force.z;
  };
  tool.place({glm::identity<Quat>(), Vec3(0.0, 0.0, 0.3e-3)});
  const double low = force_at(0.5e-3), high = force_at(1.5e-3);
  return (high - low) / 1e-3;
}

/// Energy [J] that a changing spring has generated beyond the work of cutting, over random loads.
template <class Update>
double generated(Update&& update) {
  constexpr double kStiffness = 5000.0;
  double factor = 1.0, excess = 0.0, most = 0.0;
  for (std::uint64_t n = 0; n < 200'000; ++n) {
    const double hardness = uniform01(1, n), force = 30.0 * uniform01(2, n / 50), advance = 1e-6 * uniform01(3, n);
    const double stretch = force / (factor * kStiffness);
    const double next = update(FeltHardness::Load{hardness, force, kStiffness, advance});
    excess += 0.5 * (next - factor) * kStiffness * stretch * stretch - force * advance;
    excess = std::max(excess, 0.0);  // what was dissipated before is not credit for later
    most = std::max(most, excess);
    factor = next;
  }
  return most;
}

}  // namespace

TEST_CASE("felt hardness: by default the slope of the force is the same on table and diploe, with the key it differs as the law says") {
  // Bone of 20e6 N/m times the hardness in series with 5000 N/m: 0.03 %, hence the slopes differ by less than a tenth of a per cent.
  const double plain = slope_on(kTable, 0.0) / slope_on(kDiploe, 0.0);
  CHECK(std::abs(plain - 1.0) < 1e-3);
  for (const double felt : {0.4, 0.6}) {
    CAPTURE(felt);
    // Stiffness is stored in steps of 1/255, half of which is 0.2 % of K; the tool rests within 0.01 voxel, 2.5 um of 1 mm.
    const double table = slope_on(kTable, felt), diploe = slope_on(kDiploe, felt);
    CHECK(table == doctest::Approx(kStiffness * (1.0 - felt * (1.0 - kTable))).epsilon(0.005));
    CHECK(diploe == doctest::Approx(kStiffness * (1.0 - felt * (1.0 - kDiploe))).epsilon(0.005));
    CHECK(table / diploe > 1.15);
  }
}

TEST_CASE("felt hardness: the spring generates no energy but that of cutting; one that follows hardness at once does") {
  FeltHardness felt(0.6);
  // Where the spring is unloaded it changes freely: 0.05 N on at least 2000 N/m hold 0.6e-6 J, and such periods follow each other at most 50
  // times in a row.
  const double own = generated([&](const FeltHardness::Load& load) {
    felt.update(load, 1e-3);
    return felt.factor();
  });
  CHECK(own < 50.0 * 0.6e-6);
  const double sabotage = generated([](const FeltHardness::Load& load) { return 1.0 - 0.6 * (1.0 - load.hardness); });
  CHECK(sabotage > 1e-3);
}

TEST_CASE("felt hardness: the factor stays within its limits for any load, and returns to 1 away from bone") {
  for (const double dt : {1e-4, 1e-3, 0.1}) {
    FeltHardness felt(0.9);
    for (std::uint64_t n = 0; n < 20'000; ++n) {
      felt.update({.hardness = 3.0 * uniform11(4, n),
                   .force = 1e3 * uniform01(5, n) * uniform01(6, n),
                   .stiffness = 5000.0,
                   .advance = 1e-2 * uniform11(7, n)},
                  dt);
      REQUIRE(felt.factor() >= 0.1 - 1e-12);
      REQUIRE(felt.factor() <= 1.0);
    }
    felt.update({.hardness = -1.0, .force = 0.0, .stiffness = 5000.0}, dt);
    CHECK(felt.factor() == 1.0);
  }
}

TEST_CASE("felt hardness: a harder layer is felt once the tool was lifted, not while it is pressed without cutting") {
  FeltHardness felt(0.6);
  const auto press = [&](double hardness, double force, double advance) {
    for (int n = 0; n < 500; ++n) felt.update({.hardness = hardness, .force = force, .stiffness = 5000.0, .advance = advance}, 1e-3);
    return felt.factor();
  };
  CHECK(press(kDiploe, 20.0, 0.0) == doctest::Approx(1.0 - 0.6 * (1.0 - kDiploe)).epsilon(1e-6));
  CHECK(press(kTable, 20.0, 0.0) == doctest::Approx(1.0 - 0.6 * (1.0 - kDiploe)).epsilon(1e-6));
  CHECK(press(kTable, 20.0, 1e-5) == doctest::Approx(1.0 - 0.6 * (1.0 - kTable)).epsilon(1e-6));
  CHECK(press(kDiploe, 20.0, 0.0) < 0.7);
  (void)press(-1.0, 0.0, 0.0);
  CHECK(press(kTable, 20.0, 0.0) == doctest::Approx(1.0 - 0.6 * (1.0 - kTable)).epsilon(1e-6));
}

TEST_CASE("felt hardness: a share outside 0 to 1 is refused") {
  for (const double share : {-0.1, 1.0, std::nan("")}) {
    ConstrainedToolConfig config = locked();
    config.felt_hardness = share;
    CHECK_FALSE(ConstrainedTool::create(config, one_point(), kFineEdge).ok());
  }
}
