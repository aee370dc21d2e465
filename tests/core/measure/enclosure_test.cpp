// Whether bone closes round the space under a site, against shapes whose solid angle is known.

#include "core/measure/enclosure.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace burrhole {
namespace {

constexpr double kFine = 0.5e-3, kThick = 4e-3;
// [-] of all directions. Voxels of 0.5 mm, 15 mm or more away, place the rim of an opening within half an edge, 1/60 rad. A cone's share (1 - cos a) / 2
// changes by half the sine of that, 0.0083 at most; and evenly spread directions, 2000, count a cap within some of them, 0.001.
constexpr double kTolerance = 0.01;

/// A body in a grid of equal sides round the origin. @param half of a side [m]. @param bone at a point [m].
template <class Bone>
BoneSamples sampled(double half, const Bone& bone, double pitch = kFine) {
  BoneSamples out;
  out.dims = Vec3i(2 * static_cast<int>(std::lround(half / pitch)) + 1);
  out.bone_from_index.linear = Mat3(pitch);
  out.bone_from_index.offset = Vec3(-half);
  const Affine to_bone = out.bone_from_index;
  out.is_bone = [to_bone, bone](const Vec3i& v) { return bone(to_bone * Vec3(v)); };
  for_each_voxel({Vec3i(0), out.dims}, [&](const Vec3i& v) {
    if (out.is_bone(v)) out.bone_box.include(v);
  });
  return out;
}

bool in_shell(const Vec3& p, double inner) {
  const double r = glm::length(p);
  return r >= inner && r <= inner + kThick;
}

/// From outside the top of a shell round the origin, down.
std::optional<Enclosure> from_top(const BoneSamples& bone, double inner) {
  return measure_enclosure(bone, Vec3(0.0, 0.0, inner + kThick), Vec3(0.0, 0.0, -1.0));
}

TEST_CASE("enclosure: a closed shell is met in every direction, and is a skull's if it is as wide") {
  constexpr double kPitch = 1e-3;
  for (const double inner : {20e-3, 60e-3}) {
    CAPTURE(inner);
    const auto found = from_top(sampled(
                                    inner + 2.0 * kThick, [=](const Vec3& p) { return in_shell(p, inner); }, kPitch),
                                inner);
    REQUIRE(found.has_value());
    CHECK(found->share == 1.0);
    CHECK(found->depth == Enclosure::kProbeDepth);
    // From a point e beside the centre the wall is -e m + sqrt(R^2 - e^2 (1 - m^2)) away, m the cosine with the outward direction, which is
    // evenly spread over -1..1 and below -0.8 in a tenth of the directions.
    const double e = inner - Enclosure::kProbeDepth, reach = 0.8 * e + std::sqrt(inner * inner - e * e * (1.0 - 0.64));
    CHECK(std::abs(found->reach - reach) < 1.5 * kPitch);
    CHECK(found->is_closed() == (reach >= Enclosure::kLeastReach));
  }
}

TEST_CASE("enclosure: a round opening takes its solid angle from the share") {
  // The probe, 15 mm below the inner surface, is the centre of a shell of that radius: a cone of half angle a is open, (1 - cos a) / 2.
  constexpr double kInner = Enclosure::kProbeDepth;
  for (const double degrees : {30.0, 50.0, 60.0, 90.0, 120.0}) {
    CAPTURE(degrees);
    const double rim = std::cos(degrees * std::numbers::pi / 180.0);
    const auto bone = sampled(kInner + 2.0 * kThick, [=](const Vec3& p) { return in_shell(p, kInner) && -p.z < rim * glm::length(p); });
    const auto found = from_top(bone, kInner);
    REQUIRE(found.has_value());
    CHECK(std::abs(found->share - 0.5 * (1.0 + rim)) < kTolerance);
    CHECK_FALSE(found->is_closed());
  }
}

TEST_CASE("enclosure: a disc above the probe is its solid angle, and far from closed") {
  constexpr double kRadius = 25e-3, kDepth = Enclosure::kProbeDepth;
  const auto bone = sampled(35e-3, [](const Vec3& p) { return p.z >= 0.0 && p.z <= kThick && std::hypot(p.x, p.y) <= kRadius; });
  const auto found = measure_enclosure(bone, Vec3(0.0, 0.0, kThick), Vec3(0.0, 0.0, -1.0));
  REQUIRE(found.has_value());
  CHECK(std::abs(found->share - 0.5 * (1.0 - kDepth / std::hypot(kDepth, kRadius))) < kTolerance);
  CHECK_FALSE(found->is_closed());
}

TEST_CASE("enclosure: what lies beyond a face through which bone is cut is not known, and not open") {
  constexpr double kInner = 60e-3, kPitch = 1e-3;
  const auto shell = [](const Vec3& p) { return in_shell(p, kInner); };
  // The vault of a skull: the grid ends 5 mm below the probe, inside the shell.
  BoneSamples vault = sampled(kInner + 2.0 * kThick, shell, kPitch);
  const int cut = static_cast<int>((kInner + 2.0 * kThick + kInner - Enclosure::kProbeDepth - 5e-3) / kPitch);
  vault.bone_from_index.offset.z += cut * kPitch;
  vault.dims.z -= cut;
  vault.bone_box.lo.z = 0;
  vault.bone_box.hi.z -= cut;
  const Affine to_bone = vault.bone_from_index;
  vault.is_bone = [=](const Vec3i& v) { return shell(to_bone * Vec3(v)); };
  const auto found = from_top(vault, kInner);
  REQUIRE(found.has_value());
  CHECK(found->share == 1.0);
  CHECK(found->is_closed());
  // The same with a vault that ends above the last layer of the grid: there is nothing below.
  vault.is_bone = [=](const Vec3i& v) { return v.z > 0 && shell(to_bone * Vec3(v)); };
  vault.bone_box.lo.z = 1;
  const auto open = from_top(vault, kInner);
  REQUIRE(open.has_value());
  CHECK(open->share < 0.7);
  CHECK_FALSE(open->is_closed());
}

TEST_CASE("enclosure: a site cropped out of a skull is not judged, nor an axis without bone") {
  constexpr double kInner = 70e-3;
  const BoneSamples site = sampled(22e-3, [](const Vec3& p) { return in_shell(p + Vec3(0.0, 0.0, kInner), kInner); });
  CHECK_FALSE(measure_enclosure(site, Vec3(0.0, 0.0, kThick), Vec3(0.0, 0.0, -1.0)).has_value());
  CHECK_FALSE(measure_enclosure(site, Vec3(0.0, 0.0, -15e-3), Vec3(1.0, 0.0, 0.0)).has_value());
}

TEST_CASE("enclosure: bone that begins again less than 15 mm below, as in a long bone, is its depth") {
  constexpr double kBore = 5e-3, kWall = 3e-3;
  const auto shaft = sampled(15e-3, [](const Vec3& p) {
    const double r = std::hypot(p.y, p.z);
    return r >= kBore && r <= kBore + kWall;
  });
  const auto found = measure_enclosure(shaft, Vec3(0.0, 0.0, kBore + kWall), Vec3(0.0, 0.0, -1.0));
  REQUIRE(found.has_value());
  CHECK(found->depth == doctest::Approx(2.0 * kBore).epsilon(kFine / kBore));
  CHECK_FALSE(found->is_closed());
}

}  // namespace
}  // namespace burrhole
