// The planned way into bone, against the phantom's closed form.

#include "core/measure/approach.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>

#include "core/base/units.h"
#include "core/measure/approach_check.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {
namespace {

struct Planned {
  Phantom phantom;
  std::shared_ptr<const BoneModel> bone;
  Result<Approach> approach;
};

Planned plan(const PhantomSpec& spec, const Vec3& entry, const Vec3& axis) {
  auto phantom = make_phantom(spec);
  REQUIRE(phantom);
  auto bone = BoneModel::create(phantom->bone);
  REQUIRE(bone);
  ApproachScene scene;
  scene.entry = entry;
  scene.axis = glm::normalize(axis);
  auto approach = make_approach(**bone, scene);
  return {std::move(*phantom), *bone, std::move(approach)};
}

PhantomSpec patch() {
  PhantomSpec spec;
  spec.extent = Vec3(24e-3, 24e-3, 13e-3);
  return spec;
}

TEST_CASE("approach: entry, thickness and angle of a curved skull agree with the closed form along tilted axes") {
  for (const Vec3& axis : {Vec3(0, 0, -1), Vec3(0.3, 0, -1), Vec3(-0.2, 0.35, -1)}) {
    CAPTURE(axis.x);
    const Vec3 entry(1e-3, -2e-3, 0.4e-3);
    const Planned p = plan(patch(), entry, axis);
    REQUIRE_MESSAGE(p.approach.ok(), (p.approach ? "" : p.approach.error().text()));
    const Vec3 along = glm::normalize(axis), origin = entry - along * 10e-3;
    const auto distance = p.phantom.truth.entry_distance(origin, along);
    REQUIRE(distance.has_value());
    const Vec3 surface = origin + along * *distance;
    // 0.02 mm: the 0.5 level of a curved surface is off by pitch^2 / (4 radius) = 0.2 um, that of the ramp by a chord of a tenth of a
    // voxel.
    CHECK(glm::length(p.approach->bone_from_approach.translation - surface) < 0.02e-3);
    CHECK(std::abs(p.approach->thickness - p.phantom.truth.thickness_along(origin, along)) < 0.02e-3);
    CHECK(glm::length(p.approach->bone_from_approach.rotate(Vec3(0, 0, 1)) + along) < 1e-12);
    const double angle = std::acos(glm::dot(-along, p.phantom.truth.normal(surface)));
    MESSAGE("thickness " << p.approach->thickness * 1e3 << " mm, angle " << p.approach->angle / kDegree << " degrees, truth "
                         << angle / kDegree);
    // 1 degree: the differences span three voxels and the ramp about two, so that they saturate along the normal and not across it.
    CHECK(std::abs(p.approach->angle - angle) < 1.0 * kDegree);
    CHECK(glm::dot(p.approach->normal, p.phantom.truth.normal(surface)) > std::cos(1.0 * kDegree));
  }
}

TEST_CASE("approach: layers come outer table, diploe, inner table, each where it was built") {
  const PhantomSpec spec = patch();
  const Planned p = plan(spec, Vec3(0.0), Vec3(0, 0, -1));
  REQUIRE(p.approach);
  // The last quarter voxel of bone may lie in a voxel whose middle is dura already.
  std::vector<Approach::Layer> layers = p.approach->layers;
  if (layers.back().label == VoxelLabel::dura) layers.pop_back();
  REQUIRE(layers.size() == 3);
  CHECK(layers[0].label == VoxelLabel::outer_table);
  CHECK(layers[1].label == VoxelLabel::diploe);
  CHECK(layers[2].label == VoxelLabel::inner_table);
  // Labels are of whole voxels and looked at every quarter: 0.625 voxel at either end.
  const double tolerance = 0.625 * spec.pitch + 1e-9;
  CHECK(std::abs(layers[0].from) < tolerance);
  CHECK(std::abs(layers[0].to - spec.outer_table) < tolerance);
  CHECK(std::abs(layers[1].to - (spec.thickness - spec.inner_table)) < tolerance);
  CHECK(std::abs(layers[2].to - spec.thickness) < tolerance);
  CHECK(p.approach->axis_index.size() == p.approach->axis_depth.size());
  CHECK(std::abs(p.approach->axis_depth.back() - spec.thickness) < 0.25 * spec.pitch);
}

/// Checks that a refusal begins with `why` and that the place to start that it names is valid.
void check_start(const BoneModel& bone, const Result<Approach>& refused, const std::string& why) {
  REQUIRE_FALSE(refused.ok());
  const std::string text = refused.error().text();
  CAPTURE(text);
  CHECK(text.starts_with(why));
  const std::string form =
      text.substr(0, text.find("; bone begins at")) + "; bone begins at entry_mm = [%lf, %lf, %lf], axis = [%lf, %lf, %lf]";
  Vec3 entry, axis;
  REQUIRE(std::sscanf(text.c_str(), form.c_str(), &entry.x, &entry.y, &entry.z, &axis.x, &axis.y, &axis.z) == 6);
  const auto approach = make_approach(bone, {entry * 1e-3, glm::normalize(axis), {}});
  REQUIRE_MESSAGE(approach.ok(), (approach ? "" : approach.error().text()));
  CHECK_FALSE(leaves_skull(bone, *approach).has_value());
  CHECK(glm::length(approach->bone_from_approach.translation - entry * 1e-3) < 0.2e-3);  // rounded to 0.1 mm
}

TEST_CASE("approach: what cannot be planned is refused with its reason") {
  PhantomSpec plate;
  plate.kind = PhantomKind::plate;
  plate.thickness = 3e-3;
  plate.extent = Vec3(6e-3);
  const Planned missed = plan(plate, Vec3(20e-3, 0, 0), Vec3(0, 0, -1));
  REQUIRE_FALSE(missed.approach.ok());
  // The plate ends at x = 3 mm, its last voxel half of its edge before.
  check_start(*missed.bone, missed.approach,
              "the approach axis meets no bone within 20 mm of entry_mm: the nearest bone lies 17 mm away: 17 mm right;");
  const Planned above = plan(plate, Vec3(-20e-3, 30e-3, 40e-3), Vec3(0, 0, -1));
  check_start(
      *above.bone, above.approach,
      "the approach axis meets no bone within 20 mm of entry_mm: the nearest bone lies 51 mm away: 17 mm left, 27 mm anterior, 40 mm "
      "inferior;");

  PhantomSpec thick = plate;
  thick.pitch = 1e-3;
  thick.thickness = 90e-3;
  thick.extent = Vec3(8e-3, 8e-3, 95e-3);
  const Planned endless = plan(thick, Vec3(0.0), Vec3(0, 0, -1));
  REQUIRE_FALSE(endless.approach.ok());
  CHECK(endless.approach.error().text() == "bone does not end within 60 mm along the approach axis");

  const Planned inside = plan(thick, Vec3(0, 0, -30e-3), Vec3(0, 0, -1));
  REQUIRE_FALSE(inside.approach.ok());
  // From nowhere would the bone end within 60 mm along this axis, but it does across the slab.
  check_start(*inside.bone, inside.approach, "the approach starts inside bone: the point 20 mm above entry_mm is bone");
  PhantomSpec deep = thick;
  deep.thickness = 40e-3;
  const Planned buried = plan(deep, Vec3(0, 0, -30e-3), Vec3(0, 0, -1));
  check_start(*buried.bone, buried.approach, "the approach starts inside bone: the point 20 mm above entry_mm is bone");
}

/// Two slabs of 3 mm with 37 mm between them, square to z, the upper face of the upper one at z = 0: a skull without dura and brain.
std::shared_ptr<const BoneModel> two_slabs() {
  constexpr double kPitch = 0.5e-3;
  DenseBone dense;
  dense.dims = {8, 8, 120};
  dense.bone_from_index.linear = Mat3(kPitch);
  dense.bone_from_index.offset = Vec3(-3.5 * kPitch, -3.5 * kPitch, -110.5 * kPitch);
  const std::size_t count = 8 * 8 * 120;
  dense.occupancy.assign(count, 0.0f);
  dense.hardness.assign(count, 0.8f);
  dense.labels.assign(count, static_cast<std::uint8_t>(VoxelLabel::none));
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t layer = n / 64;
    const double z = (static_cast<double>(layer) - 110.5) * kPitch;
    if ((z > -3e-3 && z < 0.0) || (z > -43e-3 && z < -40e-3)) dense.occupancy[n] = 1.0f;
  }
  auto bone = BoneModel::create(dense);
  REQUIRE(bone);
  return *bone;
}

ApproachScene straight(double z, double axis_z) {
  ApproachScene scene;
  scene.entry = Vec3(0.0, 0.0, z);
  scene.axis = Vec3(0.0, 0.0, axis_z);
  return scene;
}

TEST_CASE("approach: one that leaves the skull through its far side is named with the start of the opposite one, which is valid") {
  const auto bone = two_slabs();
  for (const double axis : {-1.0, 1.0}) {
    CAPTURE(axis);
    const double outside = axis < 0.0 ? 0.0 : -43e-3, inside = axis < 0.0 ? -40e-3 : -3e-3;
    const auto valid = make_approach(*bone, straight(outside, axis)), leaving = make_approach(*bone, straight(inside, axis));
    REQUIRE(valid);
    REQUIRE(leaving);
    CHECK_FALSE(leaves_skull(*bone, *valid).has_value());
    const auto wrong = leaves_skull(*bone, *leaving);
    REQUIRE(wrong.has_value());
    CHECK(wrong->find("the other side of the skull is behind the entry; start at " +
                      start_text({Vec3(0.0, 0.0, axis < 0.0 ? -43e-3 : 0.0), Vec3(0.0, 0.0, -axis)})) != std::string::npos);
  }
  // One slab alone, as a cropped scan: nothing is known of the other side.
  PhantomSpec plate;
  plate.kind = PhantomKind::plate;
  plate.extent = Vec3(6e-3, 6e-3, 12e-3);
  const Planned alone = plan(plate, Vec3(0.0), Vec3(0, 0, -1));
  REQUIRE(alone.approach);
  CHECK_FALSE(leaves_skull(*alone.bone, *alone.approach).has_value());
}

/// A shell of radius R to R + 6 mm without labels, cropped to a box of 40 x 40 x 30 mm round its top at z = 0, as a region of a scan is.
std::shared_ptr<const BoneModel> cropped_shell(double radius) {
  constexpr double kPitch = 0.5e-3;
  const Vec3i dims(80, 80, 60);
  DenseBone dense;
  dense.dims = dims;
  dense.bone_from_index.linear = Mat3(kPitch);
  dense.bone_from_index.offset = Vec3(-39.5, -39.5, -39.5) * kPitch;
  const Vec3 centre(0.0, 0.0, -radius - 6e-3);
  for_each_voxel({Vec3i(0), dims}, [&](const Vec3i& v) {
    const double r = glm::length(dense.bone_from_index * Vec3(v) - centre), inside = std::min(radius + 6e-3 - r, r - radius) / kPitch;
    dense.occupancy.push_back(static_cast<float>(std::clamp(0.5 + inside, 0.0, 1.0)));
  });
  dense.hardness.assign(dense.occupancy.size(), 0.8f);
  dense.labels.assign(dense.occupancy.size(), static_cast<std::uint8_t>(VoxelLabel::none));
  auto bone = BoneModel::create(dense);
  REQUIRE(bone);
  return *bone;
}

TEST_CASE(
    "approach: from inside a cropped shell it is known by the hollow bone, and a flatter shell or a leaning axis from outside is not") {
  // r^2 / (2 R) for r = 12 mm: 0.9 mm and, for the flat one, 0.24 mm, under the 0.4 mm that count.
  for (const double radius : {80e-3, 300e-3}) {
    const bool hollow = radius < 0.1;
    CAPTURE(radius);
    const auto bone = cropped_shell(radius);
    const auto out = make_approach(*bone, straight(-6e-3, 1.0)), in = make_approach(*bone, straight(0.0, -1.0));
    REQUIRE(out);
    REQUIRE(in);
    CHECK(leaves_skull(*bone, *out).has_value() == hollow);
    CHECK_FALSE(leaves_skull(*bone, *in).has_value());
  }
  const auto bone = cropped_shell(80e-3);
  for (const double lean : {-0.3, 0.3}) {
    ApproachScene scene = straight(0.0, -1.0);
    scene.axis = glm::normalize(Vec3(lean, 0.1, -1.0));
    const auto leaning = make_approach(*bone, scene);
    REQUIRE(leaning);
    CHECK_FALSE(leaves_skull(*bone, *leaning).has_value());
  }
}

TEST_CASE("approach: from the brain's side of a patch of skull it is refused by its labels") {
  const Planned out = plan(patch(), Vec3(0.0, 0.0, -7e-3), Vec3(0, 0, 1));
  REQUIRE_MESSAGE(out.approach.ok(), (out.approach ? "" : out.approach.error().text()));
  const auto wrong = leaves_skull(*out.bone, *out.approach);
  REQUIRE(wrong.has_value());
  CHECK(wrong->find("it meets dura or brain before the entry") != std::string::npos);
  CHECK(wrong->find("axis = [0.000, 0.000, -1.000]") != std::string::npos);
  const Planned in = plan(patch(), Vec3(0.0), Vec3(0, 0, -1));
  REQUIRE(in.approach);
  CHECK_FALSE(leaves_skull(*in.bone, *in.approach).has_value());
}

TEST_CASE("approach: an axis that misses is given a valid start, from outside the skull") {
  const std::string none = "the approach axis meets no bone within 20 mm of entry_mm";
  const auto slabs = two_slabs();
  check_start(*slabs, make_approach(*slabs, straight(60e-3, -1.0)), none);
  ApproachScene beside = straight(-1.5e-3, -1.0);
  beside.entry.x = 30e-3;
  check_start(*slabs, make_approach(*slabs, beside), none);
  // From the brain below a patch of skull, along it: the start is on the other side of the bone.
  const Planned below = plan(patch(), Vec3(0.0, 0.0, -40e-3), Vec3(0, 0, -1));
  check_start(*below.bone, below.approach, none);
}

}  // namespace
TEST_CASE("approach: an entry written in RAS is named with the same place in LPS, which is valid; a miss in both is not") {
  auto phantom = make_phantom(patch());
  REQUIRE(phantom);
  const Vec3 aside(60e-3, -40e-3, 0.0);
  phantom->bone.bone_from_index.offset += aside;
  const auto bone = BoneModel::create(phantom->bone);
  REQUIRE(bone);
  ApproachScene scene;
  scene.entry = Vec3(-aside.x, -aside.y, 0.0);
  scene.axis = glm::normalize(Vec3(0.1, 0.2, -1.0));
  const auto missed = make_approach(**bone, scene);
  REQUIRE_FALSE(missed.ok());
  const ApproachStart lps{aside, glm::normalize(Vec3(-0.1, -0.2, -1.0))};
  CHECK_MESSAGE(missed.error().message.find("if the entry was written in RAS") != std::string::npos, missed.error().message);
  CHECK_MESSAGE(missed.error().message.ends_with(start_text(lps)), missed.error().message);
  ApproachScene corrected;
  corrected.entry = lps.entry;
  corrected.axis = lps.axis;
  CHECK(make_approach(**bone, corrected).ok());
  scene.entry = Vec3(-aside.x, aside.y, 0.0);  // on neither side
  const auto elsewhere = make_approach(**bone, scene);
  REQUIRE_FALSE(elsewhere.ok());
  CHECK(elsewhere.error().message.find("RAS") == std::string::npos);
}

}  // namespace burrhole
