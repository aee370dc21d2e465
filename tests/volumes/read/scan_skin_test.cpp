// The skin of a body in a CT: at its place, closed over cavities, without the table beside it.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "core/base/units.h"
#include "volumes/read/bone_from_scan.h"
#include "volumes/read/scan_skin.h"

using namespace burrhole;

namespace {

constexpr double kMm = kMillimetre;
constexpr double kRadius = 40.0 * kMm;

/// A ball of tissue with a shell of bone, with air round it; cubes of a millimetre, tilted against the bone frame.
Scan head_scan(const std::function<double(const Vec3&)>& more, const Mat3& axes = Mat3(1.0)) {
  const Vec3i dims(112, 108, 120);
  const Affine bone_from_index{axes * kMm, -axes * (0.5 * kMm * Vec3(dims - 1))};
  Scan scan{dims, bone_from_index, Quantity::hounsfield, {}};
  for_each_voxel({Vec3i(0), dims}, [&](const Vec3i& v) {
    const Vec3 p = bone_from_index * Vec3(v);
    const double r = glm::length(p);
    // A scanner's blur of 0.7 mm across the skin.
    double hu = -1000.0 + 1040.0 * 0.5 * std::erfc((r - kRadius) / (std::sqrt(2.0) * 0.7 * kMm));
    if (r > 28.0 * kMm && r < 34.0 * kMm) hu = 1100.0;
    scan.values.push_back(static_cast<float>(std::max(hu, more(p))));
  });
  return scan;
}

double air(const Vec3&) { return -1000.0; }

/// Where a ray from the middle leaves the skin last.
double last_crossing(const ScanSkin& skin, const Vec3& way) {
  double out = 0.0;
  for (int n = 100; n < 530; ++n) {
    const double r = 0.1 * kMm * n;
    if (skin.at(r * way) < 0.0) out = r;
  }
  return out;
}

ScanSkin found(const Scan& scan, double offset = 0.0) {
  auto skin = find_scan_skin(scan, offset, 2.0 * kMm);
  REQUIRE(skin.ok());
  return std::move(skin).value();
}

Vec3 way_of(int n) {
  const double z = -0.95 + 1.9 * n / 60.0, angle = 2.399963 * n;
  return {std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z};
}

}  // namespace

TEST_CASE("scan skin: it lies at the surface of a ball, in a straight grid and a tilted one, with an offset or without") {
  const double c = std::cos(0.3), s = std::sin(0.3);
  for (const Mat3& axes : {Mat3(1.0), Mat3(Vec3(c, s, 0), Vec3(-s, c, 0), Vec3(0, 0, 1))}) {
    Scan scan = head_scan(air, axes);
    const ScanSkin skin = found(scan);
    CHECK(skin.dims == Vec3i(56, 54, 60));
    for (int n = 0; n <= 60;
         ++n)  // half a voxel of 2 mm: means over voxels, a threshold of -400 where the middle is -480, smoothing of a ball
      CHECK(std::abs(last_crossing(skin, way_of(n)) - kRadius) < 1.0 * kMm);
    for (float& value : scan.values) value += 1024.0f;
    const ScanSkin shifted = found(scan, -1024.0);
    double worst = 0.0;
    for (std::size_t n = 0; n < skin.value.size(); ++n)
      worst = std::max(worst, static_cast<double>(std::abs(shifted.value[n] - skin.value[n])));
    CHECK(worst < 1e-8);  // floats of a thousand are rounded to 6e-5 HU: of 500 HU in 2 mm 3e-10 m
    CHECK(skin.at(Vec3(0.2, 0.0, 0.0)) > 0.0);
  }
}

TEST_CASE("scan skin: a table that touches the head is left out; without that step it would be part of it") {
  // A plate 3 mm thick under the head, 46 to 49 mm below its middle, and a post of 4 mm between the two; a headrest of foam.
  const auto table = [](const Vec3& p) {
    const bool plate =
        p.y > 46.0 * kMm && p.y<52.0 * kMm, post = p.y> 0.0 && p.y < 47.0 * kMm && std::abs(p.x) < 1.0 * kMm && std::abs(p.z) < 1.0 * kMm;
    return plate || post ? 100.0 : -1000.0;
  };
  const Scan scan = head_scan(table);
  const ScanSkin skin = found(scan);
  for (const double x : {-30.0, -10.0, 10.0, 30.0})
    for (const double z : {-40.0, 5.0, 40.0}) CHECK(skin.at(Vec3(x, 49.0, z) * kMm) > 0.0);
  CHECK(std::abs(last_crossing(skin, Vec3(1, 0, 0)) - kRadius) < 1.0 * kMm);
  CHECK(std::abs(last_crossing(skin, glm::normalize(Vec3(1, 1, 1))) - kRadius) < 1.0 * kMm);
  // The plate is above the threshold: what leaves it out is the component alone.
  CHECK(scan.values[VoxelBox{Vec3i(0), scan.dims}.offset_of({80, 102, 60})] > -400.0f);
}

TEST_CASE("scan skin: cavities and narrow openings belong to the body") {
  Scan scan = head_scan(air);
  const VoxelBox all{Vec3i(0), scan.dims};
  for_each_voxel(all, [&](const Vec3i& v) {
    const Vec3 p = scan.bone_from_index * Vec3(v);
    const bool sinus =
        glm::length(p - Vec3(0, 0, 10.0 * kMm))<9.0 * kMm, nostril = p.x> 0.0 && std::abs(p.y) < 2.0 * kMm && std::abs(p.z) < 2.0 * kMm;
    if (sinus || nostril) scan.values[all.offset_of(v)] = -1000.0f;
  });
  const ScanSkin skin = found(scan);
  CHECK(skin.at(Vec3(0, 0, 10.0 * kMm)) < 0.0);
  CHECK(skin.at(Vec3(20.0 * kMm, 0, 0)) < 0.0);
}

TEST_CASE("scan skin: where the scan ends a plane closes it") {
  Scan scan = head_scan(air);
  // The upper 70 of 120 layers: the ball is cut 9.5 mm below its middle.
  const std::size_t layer = static_cast<std::size_t>(scan.dims.x) * static_cast<std::size_t>(scan.dims.y);
  scan.values.erase(scan.values.begin(), scan.values.begin() + static_cast<std::ptrdiff_t>(50 * layer));
  scan.bone_from_index.offset = scan.bone_from_index * Vec3(0, 0, 50);
  scan.dims.z -= 50;
  const ScanSkin skin = found(scan);
  const double lowest = (skin.bone_from_index * Vec3(0.0)).z;
  CHECK(std::abs(lowest + 9.0 * kMm) < 1e-9);  // the middle of the first two layers
  for (const double x : {-25.0 * kMm, 0.0, 25.0 * kMm}) {
    CHECK(skin.at(Vec3(x, 0.0, lowest + 1e-6)) < 0.0);
    CHECK(skin.at(Vec3(x, 0.0, lowest - 1e-6)) > 0.0);
  }
}

TEST_CASE("scan skin: scans without bone, and values that are not HU, are refused in words") {
  Scan scan = head_scan(air);
  for (float& value : scan.values) value = std::min(value, 60.0f);
  const auto none = find_scan_skin(scan, 0.0, 2.0 * kMm);
  REQUIRE_FALSE(none.ok());
  CHECK(none.error().text().find("no skin") != std::string::npos);
  scan.quantity = Quantity::other;
  CHECK_FALSE(find_hu_offset(scan, {}).ok());
  scan.quantity = Quantity::hounsfield;
  CHECK(find_hu_offset(scan, {}).value() == 0.0);
  BoneOptions given;
  given.hu_offset = -1024.0;
  CHECK(find_hu_offset(scan, given).value() == -1024.0);
}
