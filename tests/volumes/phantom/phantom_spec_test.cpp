#include "volumes/phantom/phantom_spec.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "tests/volumes/phantom/phantom_support.h"

namespace burrhole {
namespace {

using phantom_test::agree;

struct Reading {
  PhantomSpec spec;
  Issues issues;
};

Reading read(const std::string& lines, std::string_view kind) {
  Result<TomlDocument> document = TomlDocument::parse("[volume]\nsource = \"phantom\"\n" + lines, "scene.toml");
  REQUIRE(document.ok());
  Reading reading;
  TableReader root = document->root(reading.issues);
  std::optional<TableReader> volume = root.table("volume", "");
  REQUIRE(volume.has_value());
  static_cast<void>(volume->text("source", {}, ""));
  reading.spec = read_phantom(*volume, kind);
  volume->finish();
  return reading;
}

bool names(const Issues& issues, const std::string& words) {
  return std::any_of(issues.begin(), issues.end(), [&](const Error& e) { return e.text().find(words) != std::string::npos; });
}

TEST_CASE("phantom spec: the defaults of every kind are valid and an empty table gives exactly them") {
  REQUIRE(phantom_names().size() > 1);
  for (const std::string& name : phantom_names()) {
    CAPTURE(name);
    PhantomSpec spec;
    spec.kind = find_phantom(name).value();
    CHECK(phantom_name(spec.kind) == name);
    CHECK(validate(spec).empty());
    const Reading reading = read("", name);
    CHECK(reading.issues.empty());
    CHECK(reading.spec == spec);  // the same bits: a scene without keys and a default spec make the same grid
  }
  for (const phantom_test::Case& c : phantom_test::every_shape()) CHECK_MESSAGE(validate(c.spec).empty(), c.name);
}

TEST_CASE("phantom spec: keys are read in their units") {
  const Reading patch = read(
      "spacing_mm = 0.5\nextent_mm = [20, 24, 12]\nabove_mm = 1\nouter_table_mm = 2\nporosity = 0.2\nseed = 7\nrim_mm = 8", "skull_patch");
  CHECK(patch.issues.empty());
  CHECK(agree(patch.spec.pitch, 0.5e-3, 1e-12));
  CHECK(agree(patch.spec.extent.y, 24e-3, 1e-12));
  CHECK(agree(patch.spec.outer_table, 2e-3, 1e-12));
  CHECK(agree(patch.spec.rim_radius, 8e-3, 1e-12));
  CHECK(patch.spec.seed == 7);
  const Reading wedge = read("wedge_deg = 60\nhardness = 0.3\nnoise = 0.04", "wedge");
  CHECK(wedge.issues.empty());
  CHECK(agree(wedge.spec.wedge_angle, 1.0471975512, 1e-10));
  CHECK(agree(wedge.spec.noise, 0.04, 1e-12));
  CHECK(read("plate_normal = [1, 0, 1]", "plate").spec.plate_normal == Vec3(1.0, 0.0, 1.0));
}

TEST_CASE("phantom spec: errors stand at their line, and a key of another kind is unknown") {
  const Reading range = read("noise = 0.9", "block");
  REQUIRE(range.issues.size() == 1);
  CHECK(range.issues[0].place == "scene.toml:3:1");
  CHECK(names(range.issues, "volume.noise = 0.9"));

  const Reading blind = read("hole_depth_mm = 8", "pit");
  REQUIRE(blind.issues.size() == 1);
  CHECK(blind.issues[0].text() ==
        "scene.toml:3:1: volume.hole_depth_mm = 8 must be less than volume.thickness_mm = 7.04: the hole is blind");

  CHECK(names(read("radius_mm = 5", "block").issues, "radius_mm"));
  CHECK(names(read("spacing_mm = 0.004", "block").issues, "voxels"));
}

TEST_CASE("phantom spec: an unknown kind names the nearest and the known ones") {
  const Reading reading = read("outer_table_mm = 2\nhole_depth_mm = 3", "skul_patch");
  REQUIRE(reading.issues.size() == 1);
  CHECK(names(reading.issues, "did you mean \"phantom:skull_patch\"?"));
  CHECK(names(reading.issues, "wedge"));
}

TEST_CASE("phantom spec: validate finds every error and names the scene's keys") {
  PhantomSpec spec;
  spec.noise = -0.1;
  spec.porosity = std::numeric_limits<double>::quiet_NaN();
  spec.extent.x = 0.0;
  const Issues issues = validate(spec);
  CHECK(issues.size() == 3);
  CHECK(names(issues, "volume.noise = -0.1 must be in [0, 0.5]"));
  CHECK(names(issues, "volume.porosity"));
  CHECK(names(issues, "volume.extent_mm = [0, 30, 16]"));
}

TEST_CASE("phantom spec: numbers that do not fit together are refused") {
  const auto fault = [](PhantomKind kind, auto change, const std::string& words) {
    PhantomSpec spec;
    spec.kind = kind;
    change(spec);
    const Issues issues = validate(spec);
    CHECK_MESSAGE(names(issues, words), words);
    CHECK_FALSE(make_phantom(spec).ok());
  };
  fault(
      PhantomKind::skull_patch, [](PhantomSpec& s) { s.outer_table = 6e-3; }, "volume.outer_table_mm = 6");
  fault(
      PhantomKind::skull_patch, [](PhantomSpec& s) { s.curvature = 12e-3; }, "volume.curvature_mm = 12");
  fault(
      PhantomKind::skull_patch, [](PhantomSpec& s) { s.rim_radius = 70e-3; }, "volume.rim_mm = 70");
  fault(
      PhantomKind::skull_patch, [](PhantomSpec& s) { s.pitch = 2.5e-3; }, "volume.spacing_mm = 2.5 is too coarse");
  fault(
      PhantomKind::plate, [](PhantomSpec& s) { s.plate_normal = Vec3(1.0, 0.0, 0.0); }, "volume.plate_normal");
  fault(
      PhantomKind::plate, [](PhantomSpec& s) { s.plate_normal = Vec3(0.0); }, "volume.plate_normal");
  fault(
      PhantomKind::block, [](PhantomSpec& s) { s.above = 16e-3; }, "volume.above_mm = 16");
  fault(
      PhantomKind::block, [](PhantomSpec& s) { s.block_size.z = 0.5e-3; }, "volume.block_mm leaves");
  fault(
      PhantomKind::sphere, [](PhantomSpec& s) { s.seed = -1; }, "volume.seed = -1");
}

TEST_CASE("phantom spec: tables may fill the bone, leaving no diploe") {
  PhantomSpec spec;
  spec.thickness = 4.1e-3;
  spec.extent = Vec3(0.004, 0.004, 0.008);
  REQUIRE(validate(spec).empty());
  const Result<Phantom> phantom = make_phantom(spec);
  REQUIRE(phantom.ok());
  for (std::size_t at = 0; at < phantom->bone.labels.size(); ++at)
    if (phantom->bone.occupancy[at] > 0.0f) REQUIRE(phantom->bone.hardness[at] == static_cast<float>(spec.table_hardness));
}

}  // namespace
}  // namespace burrhole
