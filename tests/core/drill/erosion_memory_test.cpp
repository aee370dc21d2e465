// The memory that is predicted for erosion is what it allocates: its field, the cut surface and its lists are counted in a run through a
// plate, by a malloc of the test's own.

#include "core/drill/erosion_memory.h"

#include <doctest/doctest.h>

#include <string>

#include "core/tool/cutting_field.h"
#include "core/tool/make_tool.h"
#include "tests/support/memory_trap.h"
#include "tests/support/source_folder.h"
#include "volumes/phantom/phantom.h"

namespace burrhole::test {
namespace {

constexpr double kEdge = 0.25e-3;    // [m] of a voxel
constexpr double kThickness = 5e-3;  // [m] of the plate
constexpr double kStep = 0.1e-3;     // [m] of the way in one step
constexpr double kEngaged = 0.2e-3;  // [m] by which a pass leaves bone in the tool: 20 N at 100 kN/m

Tool shipped(const std::string& name) {
  Issues issues;
  auto tool = load_tool(test::in_source("app/tools/" + name + ".toml"), {.erosion_pitch = 0.5 * kEdge, .cutting_voxel = kEdge}, issues);
  REQUIRE_MESSAGE(tool.has_value(), (issues.empty() ? "" : issues.front().text()));
  return std::move(*tool);
}

struct Taken {
  double predicted = 0.0, counted = 0.0;  // [bytes]
  double removed = 0.0;                   // [m^3]
};

/// Drives a bit through a plate, with all that erosion allocates counted.
Taken through_a_plate(const std::string& name, const ErosionConfig& config) {
  Tool tool = shipped(name);
  PhantomSpec spec{.kind = PhantomKind::plate, .pitch = kEdge};
  spec.extent = Vec3(20e-3, 20e-3, kThickness + 3e-3);
  spec.above = 1.5e-3;
  spec.thickness = kThickness;
  spec.hardness = 1.0;
  auto phantom = make_phantom(spec);
  REQUIRE(phantom.ok());
  auto bone = BoneModel::create(phantom->bone);
  REQUIRE(bone.ok());
  auto made = Voxmap::create(*bone, {});
  REQUIRE(made.ok());
  Voxmap voxmap(std::move(*made));
  const Affine index_from_bone = voxmap.bone().bone_from_index().inverse();
  const auto pose = [&](double z) { return index_from_bone * Affine::from_pose({Quat(1.0, 0.0, 0.0, 0.0), Vec3(0.0, 0.0, z)}); };
  const auto place = [&](double z) {
    const auto [lo, hi] = bounds_under(pose(z), {tool.bound_lo, glm::min(tool.bound_hi, Vec3(1.0, 1.0, 12e-3))});
    REQUIRE(voxmap.place_window({floor_int(lo) - 8, floor_int(hi) + 9}).ok());
  };
  Taken out;
  place(0.0);
  out.predicted = static_cast<double>(
      erosion_bytes(config, tool, {pose(0.0), index_from_bone.linear * Vec3(0.0, 0.0, -kThickness)}, kEdge, voxmap.window().box.count()));
  clear_trap();
  std::shared_ptr<const CuttingField> field;
  std::optional<Erosion> erosion;
  on_trap([&] {
    if (config.subvoxel) field = std::make_shared<CuttingField>(*tool.cutting);
    erosion.emplace(std::move(Erosion::create(config, tool.erosion, field).value()));
  });
  for (double z = 0.0; z > -kThickness; z -= kStep) {
    place(z);
    ErosionOutcome outcome;
    // As fast as a face recedes that lags by kEngaged: the step over it is the share that is removed.
    const double dt = 0.01, spin = kStep / kEngaged / dt / 0.1;
    on_trap([&] { outcome = erosion->step(voxmap, {pose(z + kStep), pose(z)}, {.spin = spin, .force = 20.0}, dt); });
    voxmap.commit(outcome.changed);
    out.removed += outcome.removed_mass;
  }
  out.counted = static_cast<double>(trapped().most_held);
  on_trap([&] { erosion.reset(); });
  return out;
}

// Blocks are counted exactly for the way that is given; the lists of nodes are an estimate, a tenth of the whole at most.
TEST_CASE("erosion's memory: predicted to 10 %, by every law and for wide and slim bits") {
  for (const char* name : {"perforator_14_11", "trephine_12mm", "round_burr_4mm", "twist_drill_2_5mm"})
    for (const ErosionConfig& config :
         {ErosionConfig{.subvoxel = true}, ErosionConfig{.law = ErosionLaw::energy, .subvoxel = true}, ErosionConfig{},
          ErosionConfig{.law = ErosionLaw::per_update}, ErosionConfig{.law = ErosionLaw::energy}}) {
      CAPTURE(std::string(name));
      CAPTURE(static_cast<int>(config.law));
      CAPTURE(config.subvoxel);
      const Taken taken = through_a_plate(name, config);
      MESSAGE(std::string(name) << ", law " << static_cast<int>(config.law) << std::string(config.subvoxel ? ", sub-voxel: " : ": ")
                                << taken.predicted * 1e-6 << " MB predicted, " << taken.counted * 1e-6 << " MB counted, ratio "
                                << taken.predicted / taken.counted);
      CHECK(taken.removed > 1e-9);
      CHECK(std::abs(taken.predicted / taken.counted - 1.0) < 0.1);
    }
}

TEST_CASE("erosion's memory: the counter counts") {
  clear_trap();
  std::vector<char> block;
  on_trap([&] { block.resize(1 << 20); });
  CHECK(trapped().held >= 1 << 20);
  on_trap([&] { std::vector<char>().swap(block); });
  CHECK(trapped().held == 0);
  CHECK(trapped().most_held >= 1 << 20);
}

}  // namespace
}  // namespace burrhole::test
