// A place for a hole on bones with a closed form: a shell and a tilted plate.
#include "app/window/skull_site.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "app/window/skull_pointer.h"
#include "app/window/view_cut.h"
#include "core/base/units.h"
#include "core/config/toml.h"
#include "core/measure/approach_check.h"

using namespace burrhole;

namespace {

constexpr double kPitch = 1e-3;                       // [m]
constexpr double kRadius = 40e-3, kThickness = 6e-3;  // [m] of the shell
const Vec3 kCentre(0.012, -0.034, 0.8);               // [m]
// On a sphere the 0.5 level between voxels deviates by pitch^2 / (4 radius) (volumes/phantom/phantom.h); twice that is allowed.
constexpr double kSurfaceError = 2.0 * kPitch * kPitch / (4.0 * (kRadius - kThickness));

/// Bone where distance(p) < 0. @param distance [m] signed, of a point from the centre. @param normal its gradient.
std::shared_ptr<const BoneModel> make_bone(const std::function<double(const Vec3&)>& distance,
                                           const std::function<Vec3(const Vec3&)>& normal) {
  DenseBone dense;
  dense.dims = Vec3i(90);
  dense.bone_from_index = Affine::scaling(kPitch, kCentre - 44.5 * kPitch);
  for_each_voxel({Vec3i(0), dense.dims}, [&](const Vec3i& v) {
    const Vec3 p = dense.bone_from_index * Vec3(v) - kCentre, n = glm::abs(normal(p));
    const auto occupancy = static_cast<float>(std::clamp(0.5 - distance(p) / (2.0 * kPitch * (n.x + n.y + n.z)), 0.0, 1.0));
    dense.occupancy.push_back(occupancy);
    dense.hardness.push_back(occupancy > 0.0f ? 0.8f : 0.0f);
    dense.labels.push_back(occupancy >= 0.5f ? 1 : 0);
  });
  auto bone = BoneModel::create(dense);
  REQUIRE(bone.ok());
  return *bone;
}

Vec3 radial(const Vec3& p) { return glm::length(p) > 0.0 ? glm::normalize(p) : Vec3(0.0, 0.0, 1.0); }

std::shared_ptr<const BoneModel> shell() {
  static const auto bone = make_bone(
      [](const Vec3& p) {
        const double r = glm::length(p);
        return std::max(r - kRadius, kRadius - kThickness - r);
      },
      radial);
  return bone;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)); }

WindowEvent key(Key which, bool down) { return {.kind = WindowEvent::Kind::key, .code = static_cast<int>(which), .down = down}; }
WindowEvent button(MouseButton which, bool down, const glm::dvec2& at) {
  return {.kind = WindowEvent::Kind::button, .code = static_cast<int>(which), .down = down, .x = at.x, .y = at.y};
}

}  // namespace

TEST_CASE("site: a ray meets the outer surface of a shell at its closed form, and misses beside it") {
  const Vec3 direction = glm::normalize(Vec3(-0.3, 0.8, -0.5));
  for (const double aside : {0.0, 10e-3, 30e-3}) {
    const Vec3 across = glm::normalize(glm::cross(direction, Vec3(0.0, 0.0, 1.0)));
    const auto hit = find_bone(*shell(), kCentre - 0.3 * direction + aside * across, direction);
    REQUIRE(hit.has_value());
    CHECK(std::abs(glm::length(*hit - kCentre) - kRadius) < kSurfaceError);
    CHECK(glm::dot(*hit - kCentre, direction) < 0.0);  // the near side
  }
  CHECK_FALSE(find_bone(*shell(), kCentre + Vec3(0.3, 0.0, kRadius + kPitch), Vec3(-1.0, 0.0, 0.0)).has_value());
  CHECK_FALSE(find_bone(*shell(), kCentre + Vec3(0.3, 0.0, 0.0), Vec3(1.0, 0.0, 0.0)).has_value());  // away from it
}

TEST_CASE("site: the normal of a disc is that of a plate, and of a sphere from any view") {
  const Vec3 up = glm::normalize(Vec3(0.36, -0.48, 0.8)), seen_from = glm::normalize(Vec3(0.0, -0.9, 0.6));
  const auto plate =
      make_bone([&](const Vec3& p) { return std::max(glm::dot(p, up), -5e-3 - glm::dot(p, up)); }, [&](const Vec3&) { return up; });
  const auto on_plate = find_bone(*plate, kCentre + 0.1 * seen_from, -seen_from);
  REQUIRE(on_plate.has_value());
  CHECK(angle_between(disc_normal(*plate, *on_plate, seen_from, 6e-3), up) < 1e-4);  // the ramp places planes exactly
  // Heights are wrong by kSurfaceError at most, over a disc with a mean square radius of 4.9 mm.
  for (const SkullRegion& region : skull_regions()) {
    const auto at = find_region(*shell(), region);
    REQUIRE(at.has_value());
    const Vec3 oblique = glm::normalize(region.outward + 0.8 * glm::normalize(glm::cross(region.outward, Vec3(0.3, 0.2, 1.0))));
    CHECK(angle_between(disc_normal(*shell(), *at, oblique, 6e-3), radial(*at - kCentre)) < 2.0 * kSurfaceError / 4.9e-3);
  }
}

TEST_CASE("site: a step beside the point does not tilt the normal") {
  const auto step = make_bone([](const Vec3& p) { return std::max(p.x < 4e-3 ? p.z : p.z + 15e-3, -25e-3 - p.z); },
                              [](const Vec3&) { return Vec3(0.0, 0.0, 1.0); });
  const Vec3 up(0.0, 0.0, 1.0);
  CHECK(angle_between(disc_normal(*step, kCentre, up, 6e-3), up) < 1e-4);
}

TEST_CASE("site: the bit stands square to a shell, and its thickness is known") {
  for (const SkullRegion& region : skull_regions()) {
    const auto at = find_region(*shell(), region);
    REQUIRE(at.has_value());
    CHECK(angle_between(radial(*at - kCentre), region.outward) < 1e-6);
    const auto site = make_site(*shell(), *at, glm::normalize(region.outward + Vec3(0.2, -0.1, 0.3)));
    REQUIRE(site.ok());
    CHECK(site->thickness == doctest::Approx(kThickness).epsilon(2.0 * kSurfaceError / kThickness));
    CHECK(angle_between(site->axis, -radial(site->entry - kCentre)) < 2.0 * kSurfaceError / 4.9e-3);
  }
  // From inside the shell a drill would leave the skull.
  const Vec3 up(0.0, 0.0, 1.0);
  CHECK_FALSE(make_site(*shell(), kCentre + (kRadius - kThickness) * up, -up).ok());
  const auto ball = make_bone([](const Vec3& p) { return glm::length(p) - kRadius; }, radial);
  const auto no_end = make_site(*ball, kCentre + Vec3(0.0, 0.0, kRadius), Vec3(0.0, 0.0, 1.0));
  REQUIRE_FALSE(no_end.ok());
  CHECK(no_end.error().message.find("does not end") != std::string::npos);
}

TEST_CASE("site: a proposal is the place of the surface nearest to a point, square to it") {
  for (const SkullRegion& region : skull_regions())
    for (const double height : {20e-3, 1e-3, -2e-3, -kThickness - 3e-3}) {  // [m] above the surface; the last one is inside the cavity
      CAPTURE(region.name);
      CAPTURE(height);
      const Vec3 near = kCentre + (kRadius + height) * region.outward;
      const auto site = suggest_site(*shell(), near);
      REQUIRE_MESSAGE(site.ok(), site.error().message);
      // The middle of the box of the bone is the centre of the shell within half a voxel, so the ray to it leans by that over the radius.
      CHECK(std::abs(glm::length(site->entry - kCentre) - kRadius) < kSurfaceError);
      CHECK(glm::length(site->entry - (kCentre + kRadius * region.outward)) < kPitch + std::abs(height) * kPitch / kRadius);
      CHECK(angle_between(site->axis, -radial(site->entry - kCentre)) < 2.0 * kSurfaceError / 4.9e-3);
    }
  const auto far = suggest_site(*shell(), kCentre + Vec3(0.0, 0.0, 0.2));
  REQUIRE_FALSE(far.ok());
  CAPTURE(far.error().message);
  CHECK(far.error().message.find("161 mm away: 160 mm inferior") != std::string::npos);
  CHECK(far.error().message.find("the bone spans x -27.5 to 51.5") != std::string::npos);
}

// A scan of the upper half of a head on a headrest: behind the entry lies the headrest, and beyond the inner surface the scan ends.
TEST_CASE("site: a headrest beside a cap of skull is not taken for skull, neither as the place nor as what lies behind it") {
  constexpr double kCap = 20e-3, kRest = 42.5e-3;  // [m] radius; distance of the middle of the headrest, a plate of 30 x 60 x 3 mm
  const auto cap = [](const Vec3& p) {
    const double r = glm::length(p);
    return std::max({r - kCap, kCap - kThickness - r, -5e-3 - p.z});
  };
  const auto rest = [](const Vec3& p) { return std::max({std::abs(p.y - kRest) - 1.5e-3, std::abs(p.x) - 15e-3, std::abs(p.z) - 30e-3}); };
  const auto bone = make_bone([&](const Vec3& p) { return std::min(cap(p), rest(p)); },
                              [&](const Vec3& p) { return rest(p) < cap(p) ? Vec3(0.0, 1.0, 0.0) : radial(p); });
  for (const Vec3& way : {Vec3(0.0, 1.0, 0.6), Vec3(0.2, 0.9, 0.6), Vec3(0.6, 0.3, 0.74), Vec3(-1.0, 0.0, 0.6), Vec3(0.0, 0.0, 1.0)})
    for (const double height : {1e-3, -2e-3}) {
      const Vec3 up = glm::normalize(way);
      CAPTURE(way.y);
      CAPTURE(height);
      const auto site = suggest_site(*bone, kCentre + (kCap + height) * up);
      REQUIRE_MESSAGE(site.ok(), site.error().message);
      CHECK(glm::length(site->entry - (kCentre + kCap * up)) < kPitch);
      CHECK(glm::dot(-site->axis, up) > std::cos(3.0 * kDegree));  // the entry may be a voxel aside: 1 mm on a radius of 20 mm
      CHECK(std::abs(site->thickness - kThickness) < 0.1e-3);
      const auto approach = make_approach(*bone, {.entry = site->entry, .axis = site->axis, .place = {}});
      REQUIRE(approach.ok());
      CHECK_FALSE(leaves_skull(*bone, *approach).has_value());
    }
  const auto on_rest = suggest_site(*bone, kCentre + Vec3(0.0, kRest, 5e-3));
  REQUIRE_FALSE(on_rest.ok());
  CHECK(on_rest.error().message.find("no part of the skull") != std::string::npos);
}

TEST_CASE("site: a scene file holds the site and the source, whatever the path") {
  const DrillSite site{Vec3(0.0539, 0.1, 0.8), glm::normalize(Vec3(-0.758, 0.242, -0.606)), 6e-3};
  const std::string path = "/tmp/a \"quoted\" back\\slash\tfolder/scan.nii";
  for (const SkullSource& source :
       {SkullSource{path}, SkullSource{path, "cm"}, SkullSource{path, {}, true}, SkullSource{path, {}, false, "3b"}}) {
    const auto document = TomlDocument::parse(site_scene(site, source), "scene.toml");
    REQUIRE(document.ok());
    Issues issues;
    TableReader root = document->root(issues);
    auto volume = root.table("volume", ""), approach = root.table("approach", "");
    REQUIRE(volume.has_value());
    REQUIRE(approach.has_value());
    CHECK(volume->text("source", "", "") == path);
    CHECK(volume->text("unit", "", "") == source.unit);
    CHECK(volume->text("series", "", "") == source.series);
    CHECK(root.has("outcome"));
    CHECK(volume->has("spacing_mm") == !source.is_bone_model);  // a bone model is used at its own voxels
    const Vec3 entry = approach->vector("entry_mm", Vec3(0.0), {.to_si = kMillimetre}, "");
    CHECK(glm::length(entry - site.entry) < 1e-6);
    CHECK(glm::length(approach->vector("axis", Vec3(0.0), {}, "") - site.axis) < 2e-6);
    CHECK(issues.empty());
  }
}

TEST_CASE("site: a scan whose path is not UTF-8 is named by a link, and the title shows its name escaped") {
  SkullSource source{"/tmp/a\xff scan.nii"};
  source.link = "scan.nii";
  const auto document = TomlDocument::parse(site_scene({Vec3(0.0), Vec3(0.0, 0.0, -1.0), 6e-3}, source), "scene.toml");
  REQUIRE_MESSAGE(document.ok(), document.error().text());
  Issues issues;
  TableReader root = document->root(issues);
  CHECK(root.text("title", "", "") == "Burrhole in a\\xff scan.nii");
  CHECK(root.table("volume", "")->text("source", "", "") == "scan.nii");
}

TEST_CASE("pointer: a click places the bit where the picture shows it; beside the bone it stays") {
  SkullPointer pointer(shell());
  pointer.set_picture_size(800, 600);
  REQUIRE(pointer.site().has_value());
  CHECK(angle_between(radial(pointer.site()->entry - kCentre), skull_regions()[2].outward) < 0.01);
  const Vec3 towards = glm::normalize(pointer.camera().eye - kCentre);
  const Vec3 wanted = kCentre + kRadius * glm::normalize(towards + Vec3(0.2, 0.1, -0.3));
  const auto pixel = project(pointer.camera(), wanted, 800, 600);
  REQUIRE(pixel.has_value());
  pointer.handle(button(MouseButton::left, true, *pixel), false);
  pointer.step(0.01);
  pointer.handle(button(MouseButton::left, false, *pixel), false);
  REQUIRE(pointer.site().has_value());
  CHECK(glm::length(pointer.site()->entry - wanted) < 0.3e-3);  // a pixel covers 0.2 mm
  const Vec3 before = pointer.site()->entry;
  pointer.handle(button(MouseButton::left, true, {2.0, 2.0}), false);
  pointer.step(0.01);
  pointer.handle(button(MouseButton::left, false, {2.0, 2.0}), false);
  CHECK(pointer.site()->entry == before);
  pointer.handle(button(MouseButton::left, true, {400.0, 300.0}), true);  // taken by a button of the panel
  pointer.step(0.01);
  CHECK(pointer.site()->entry == before);
}

TEST_CASE("pointer: arrows move the bit over the bone, a fifth as far with Shift, on and on while they are held") {
  SkullPointer pointer(shell());
  pointer.set_picture_size(800, 600);
  const auto moved = [&](double held) {
    const Vec3 before = pointer.site()->entry;
    pointer.handle(key(Key::right, true), false);
    for (int n = 0; n < std::lround(held / 0.01); ++n) pointer.step(0.01);
    pointer.handle(key(Key::right, false), false);
    return glm::length(pointer.site()->entry - before);
  };
  CHECK(moved(0.0) == doctest::Approx(1e-3).epsilon(0.3));  // across the view; the surface is oblique to it
  pointer.handle(key(Key::left_shift, true), false);
  CHECK(moved(0.0) == doctest::Approx(0.2e-3).epsilon(0.4));
  pointer.handle(key(Key::left_shift, false), false);
  CHECK(moved(0.6) > 4e-3);
  const Vec3 entry = pointer.site()->entry;
  const CameraView camera = pointer.camera();
  pointer.handle(key(Key::left_control, true), false);
  pointer.handle(key(Key::right, true), false);
  pointer.step(0.5);
  CHECK(pointer.site()->entry == entry);
  CHECK_FALSE(pointer.camera() == camera);
  pointer.handle({.kind = WindowEvent::Kind::focus}, false);  // no release will come
  const CameraView still = pointer.camera();
  pointer.step(0.5);
  CHECK(pointer.camera() == still);
}

TEST_CASE("pointer: a number shows a region, and the camera sees the bit") {
  SkullPointer pointer(shell());
  pointer.set_picture_size(800, 600);
  for (std::size_t n = 0; n < skull_regions().size(); ++n) {
    pointer.handle(key(static_cast<Key>(static_cast<int>(Key::digit_0) + static_cast<int>(n) + 1), true), false);
    REQUIRE(pointer.site().has_value());
    CHECK(angle_between(radial(pointer.site()->entry - kCentre), skull_regions()[n].outward) < 0.01);
    CHECK(glm::dot(glm::normalize(pointer.camera().eye - pointer.site()->entry), -pointer.site()->axis) > 0.5);
  }
}
