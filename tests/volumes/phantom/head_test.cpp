// The head phantom: size, layers, landmarks, sites; its voxels against the implicit function evaluated at every voxel.
#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <vector>

#include "core/base/random.h"
#include "core/base/units.h"
#include "core/measure/approach.h"
#include "volumes/phantom/head_bone.h"
#include "volumes/phantom/head_sites.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {
namespace {

constexpr double kMm = kMillimetre;
const HeadShape kHead(7.04 * kMm);

/// A head at a site, coarse enough for a test.
PhantomSpec spec_at(const std::string& site, double pitch, double surroundings) {
  PhantomSpec spec;
  spec.kind = PhantomKind::head;
  spec.pitch = pitch;
  spec.surroundings = surroundings;
  const auto found = find_head_site(site);
  REQUIRE(found);
  spec.head_entry = found->point;
  spec.head_axis = -found->normal;
  return spec;
}

/// Central differences of the bone's field, which do not use its slope.
Vec3 gradient_at(const Vec3& p) {
  constexpr double kStep = 1e-6;
  Vec3 out;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 d(0.0);
    d[a] = kStep;
    out[a] = (kHead.at(p + d).bone.value - kHead.at(p - d).bone.value) / (2.0 * kStep);
  }
  return out;
}

Vec3 random_point(std::uint64_t n) {
  const Vec3 lo(-0.09, -0.13, -0.12), hi(0.09, 0.11, 0.13);
  return lo + (hi - lo) * Vec3(uniform01(3, 3 * n), uniform01(3, 3 * n + 1), uniform01(3, 3 * n + 2));
}

}  // namespace

TEST_CASE("head: the vault has the size of an adult's skull, and the skull lies within its stated reach") {
  Vec3 lo(1.0), hi(-1.0);
  double beyond = -1.0;
  int outside = 0;  // of the hull
  for (int i = -80; i <= 80; i += 2)
    for (int j = -120; j <= 100; j += 2)
      for (int k = -115; k <= 125; k += 2) {
        const Vec3 p = Vec3(i, j, k) * kMm;
        const HeadFields f = kHead.at(p);
        if (HeadShape::vault(p).value < 0.0) lo = glm::min(lo, p), hi = glm::max(hi, p);
        if (f.bone.value >= 0.0) continue;
        outside += HeadShape::hull(p) > 0.0;
        for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), glm::normalize(Vec3(1, -2, 1)), glm::normalize(Vec3(1, 1, 2)),
                                glm::normalize(Vec3(0, -1, -2)), glm::normalize(Vec3(2, -1, -1))})
          for (const double sign : {-1.0, 1.0}) beyond = std::max(beyond, sign * glm::dot(p, way) - HeadShape::reach(sign * way));
      }
  // Length 180, breadth 145, height above the ears 115 mm; on a lattice of 2 mm.
  CHECK(std::abs(hi.y - lo.y - 180.0 * kMm) < 5.0 * kMm);
  CHECK(std::abs(hi.x - lo.x - 145.0 * kMm) < 5.0 * kMm);
  CHECK(std::abs(hi.z - 115.0 * kMm) < 4.0 * kMm);
  CHECK(beyond < 0.0);
  CHECK(outside == 0);
}

TEST_CASE("head: the skin holds the skull with room, is the scalp's thickness above the sites of the vault, and lies in its box") {
  int under = 0, bare = 0, out_of_box = 0;
  double least = 1.0;
  const Bounds box = HeadShape::skin_box();
  for (int i = -114; i <= 114; i += 3)
    for (int j = -150; j <= 114; j += 3)
      for (int k = -150; k <= 135; k += 3) {
        const Vec3 p = Vec3(i, j, k) * kMm;
        const double skin = HeadShape::skin(p);
        out_of_box += skin <= 0.0 && (glm::any(glm::lessThan(p, box.lo + 2.0 * kMm)) || glm::any(glm::greaterThan(p, box.hi - 2.0 * kMm)));
        if (kHead.at(p).bone.value > 0.0) continue;
        ++under;
        least = std::min(least, -skin);
        bare += skin > -1.0 * kMm;
      }
  CHECK(under > 5'000);
  CHECK(bare == 0);
  CHECK(least > 1.0 * kMm);
  CHECK(out_of_box == 0);
  for (const std::string name : {"kocher", "keen", "frazier", "parietal"})
    for (const std::string side : {"_left", "_right"}) {
      const auto site = find_head_site(name + side);
      REQUIRE(site);
      double low = 0.0, high = 30.0 * kMm;
      for (int n = 0; n < 40; ++n)
        (HeadShape::skin(site->point + 0.5 * (low + high) * site->normal) < 0.0 ? low : high) = 0.5 * (low + high);
      // 5.5 mm; the field of an ellipsoid is a distance to first order: 5.5^2 / (2 x 50) mm off where it is curved most.
      CHECK_MESSAGE(std::abs(low - 5.5 * kMm) < 0.5 * kMm, name);
    }
}

TEST_CASE("head: the fields slope by about 1 on their surfaces, and the slope given is their gradient there") {
  int checked = 0;
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 20'000; ++n) {
    // Newton's steps to the surface; points that do not arrive are not counted.
    Vec3 p = random_point(n);
    for (int step = 0; step < 12; ++step) {
      const Vec3 g = gradient_at(p);
      p -= g * (kHead.at(p).bone.value / std::max(glm::dot(g, g), 0.1));
    }
    if (std::abs(kHead.at(p).bone.value) > 1e-9) continue;
    const Vec3 g = gradient_at(p);
    // Half way between two parts that meet at an angle of 90 degrees the mean of their normals has a length of 0.71; sutures and teeth
    // add up to 1 mm x 0.81 / 0.75 mm = 0.8 and 1.6 mm x 8.5 x 3 / 30 mm to it.
    CHECK(glm::length(g) > 0.2);
    CHECK(glm::length(g) < 2.6);
    ++checked;
    // Away from sutures, teeth and edges the slope is the gradient; elsewhere it only sets the width of the ramp.
    const HeadFields f = kHead.at(p);
    if (glm::length(g) > 0.9 && glm::length(g) < 1.1) worst += glm::length(f.bone.slope - g) > 0.3 ? 1.0 : 0.0;
  }
  CHECK(checked > 5'000);
  CHECK(worst < 0.05 * checked);
}

TEST_CASE("head: the 0.5 surface of the voxels lies on the implicit surface, in the region and around it") {
  const PhantomSpec spec = spec_at("parietal_left", 0.5 * kMm, 1.5 * kMm);
  const auto bone = make_head_bone(spec);
  REQUIRE(bone);
  const HeadGrid grid = head_grid(spec);
  REQUIRE((*bone)->surroundings() != nullptr);
  const auto check = [&](const BoneModel& model, const VoxelBox& box, double allowed) {
    const double pitch = model.bone_from_index().mean_edge();
    std::vector<float> occupancy(box.count());
    model.read_occupancy(box, occupancy);
    int crossings = 0, wrong = 0;
    for_each_voxel({box.lo, box.hi - 1}, [&](const Vec3i& v) {
      for (const Vec3i& step : {Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1)}) {
        const double a = occupancy[box.offset_of(v)], b = occupancy[box.offset_of(v + step)];
        if ((a < 0.5) == (b < 0.5)) continue;
        const Vec3 p = model.bone_from_index() * (Vec3(v) + Vec3(step) * ((0.5 - a) / (b - a)));
        ++crossings;
        const double slope = std::max(glm::length(gradient_at(p)), 0.3);
        if (std::abs(kHead.at(p).bone.value) / slope > allowed * pitch) ++wrong;
      }
    });
    CHECK(crossings > 1'000);
    return static_cast<double>(wrong) / crossings;
  };
  // Along an edge the field is a parabola: its chord deviates by pitch^2 / (8 r), which is 0.01 voxel of 1.5 mm for r = 19 mm, and 0.1 for
  // the sutures' and rims' r of 2 mm. A ramp that saturates at its end adds as much. 0.2 voxel are allowed; at edges between parts (teeth,
  // sutures, walls of holes) the surface is no plane, so 3 % may be worse.
  CHECK(check(**bone, grid.region, 0.2) < 0.01);
  const BoneModel& around = *(*bone)->surroundings()->coarse;
  CHECK(check(around, around.bounds(), 0.2) < 0.05);
}

TEST_CASE("head: voxels in tiles that are left out are as if evaluated") {
  PhantomSpec spec = spec_at("kocher_right", 1.0 * kMm, 2.5 * kMm);
  const auto bone = make_head_bone(spec);
  REQUIRE(bone);
  const BoneModel& around = *(*bone)->surroundings()->coarse;
  const VoxelBox all = around.bounds();
  std::vector<float> occupancy(all.count()), soft(all.count());
  around.read_occupancy(all, occupancy);
  around.read_soft(all, soft);
  const double pitch = around.bone_from_index().mean_edge();
  int wrong = 0, seen = 0;
  for_each_voxel(all, [&](const Vec3i& v) {
    const HeadFields f = kHead.at(around.bone_from_index() * Vec3(v));
    const std::size_t n = all.offset_of(v);
    // The ramp is at most sqrt(3) voxels wide on either side: beyond twice that the sign of a field gives the voxel.
    if (std::abs(f.bone.value) > 3.5 * pitch) wrong += occupancy[n] != (f.bone.value < 0.0 ? 1.0f : 0.0f), ++seen;
    if (std::abs(f.cavity.value) > 3.5 * pitch && f.bone.value > 3.5 * pitch) wrong += soft[n] != (f.cavity.value < 0.0 ? 1.0f : 0.0f);
  });
  CHECK(seen > 100'000);
  CHECK(wrong == 0);
}

TEST_CASE("head: at each site of the vault the layers along the axis are those of the spec") {
  for (const HeadSite& site : head_sites()) {
    INFO(site.name);
    CHECK(std::abs(HeadShape::vault(site.point).value) < 1e-6);
    CHECK(std::abs(glm::length(site.normal) - 1.0) < 1e-12);
    // Square to the vault: points a millimetre aside, in the plane across the normal, are as far below the vault on both sides. The radius of
    // curvature is at least 20 mm there, so it falls by at most 0.025 mm; a tilt of 0.1 degrees makes a difference of 0.0035 mm.
    const Vec3 aside = glm::normalize(glm::cross(site.normal, Vec3(0.3, 0.5, 0.8)));
    for (const Vec3& way : {aside, glm::cross(site.normal, aside)})
      CHECK(std::abs(HeadShape::vault(site.point + 1e-3 * way).value - HeadShape::vault(site.point - 1e-3 * way).value) < 3.5e-6);
    double inner = 0.0;
    while (inner < 0.02 && kHead.at(site.point - inner * site.normal).cavity.value > 0.0) inner += 1e-5;
    // Off an ellipsoid's surface f / |grad f| errs by half its second derivative along the normal: less than 2 % at 7 mm. Where two parts
    // blend their gradients add up to the cosine of half the angle between them: 50 degrees at the temple, 0.91.
    CHECK(std::abs(inner - 7.04 * kMm) < 0.10 * 7.04 * kMm);
  }
}

TEST_CASE("head: the approach at a site is square to the skull, and as thick as the spec says") {
  const PhantomSpec spec = spec_at("parietal_left", 0.5 * kMm, 1.5 * kMm);
  const auto bone = make_head_bone(spec);
  REQUIRE(bone);
  const auto approach = make_approach(**bone, {spec.head_entry, spec.head_axis, ""});
  REQUIRE(approach);
  // The vault falls by 0.75^2 / (2 x 60) = 0.005 mm within the step of 0.75 mm: 0.4 degrees; the axes of the grid are exact.
  CHECK(approach->angle < 1.0 * kDegree);
  CHECK(std::abs(approach->thickness - 7.04 * kMm) < 0.02 * 7.04 * kMm);
  CHECK(glm::length(approach->bone_from_approach.translation - spec.head_entry) < 0.05 * kMm);
}

TEST_CASE("head: sites lie where the rules say, mirrored on the other side; names are unique") {
  std::set<std::string> names;
  for (const HeadSite& site : head_sites()) names.insert(site.name);
  CHECK(names.size() == head_site_names().size());
  const auto point = [](const std::string& name) {
    for (const HeadSite& mark : head_landmarks())
      if (mark.name == name) return mark.point;
    const auto site = find_head_site(name);
    REQUIRE(site);
    return site->point;
  };
  CHECK(glm::length(point("kocher_left") * Vec3(-1, 1, 1) - point("kocher_right")) < 1e-12);
  CHECK(point("kocher_left").x > 0.0);  // +x is to the left
  CHECK(!find_head_site("kocher"));
  // An independent walk: chords of a plane curve, in the midline from the nasion, found by rays from the middle of the head.
  const auto on_midline = [](double angle) {
    const Vec3 way(0.0, -std::cos(angle), std::sin(angle)), from(0.0, -0.005, 0.045);
    double lo = 0.0, hi = 0.15;
    for (int n = 0; n < 60; ++n) (HeadShape::vault(from + 0.5 * (lo + hi) * way).value < 0.0 ? lo : hi) = 0.5 * (lo + hi);
    return from + lo * way;
  };
  const Vec3 nasion = point("nasion");
  double angle = std::atan2(nasion.z - 0.045, -(nasion.y + 0.005)), walked = 0.0;
  Vec3 p = on_midline(angle);
  CHECK(glm::length(p - nasion) < 1e-6);
  while (walked < 0.110) {
    const Vec3 next = on_midline(angle += 1e-4);
    walked += glm::length(next - p);
    p = next;
  }
  // Kocher's point lies 3 cm to the side of p along the surface: the chord of 30 mm on a radius of 60 mm is 0.3 mm shorter.
  const double chord = glm::length(point("kocher_left") - p);
  CHECK(chord < 30.1 * kMm);
  CHECK(chord > 28.5 * kMm);
  // About 1 cm in front of the coronal suture, 3 cm from the midline: that is 0 to 2.5 cm.
  CHECK(point("bregma").y - p.y > 0.0);
  CHECK(point("bregma").y - p.y < 25.0 * kMm);
  CHECK(point("inion").y > 0.07);
  CHECK(point("vertex").z > 0.108);
  CHECK(point("ear_left").x > 0.06);
}

TEST_CASE("head: the grids agree in place, the region holds the entry, and bad specs are refused") {
  for (const std::string& name : head_site_names()) {
    INFO(name);
    const PhantomSpec spec = spec_at(name, 0.25 * kMm, 1.5 * kMm);
    const HeadGrid grid = head_grid(spec);
    CHECK(grid.factor == 6);
    CHECK(grid.dims == grid.factor * (grid.coarse_dims - 1) + 1);
    CHECK(grid.region.lo % grid.factor == Vec3i(0));
    CHECK((grid.region.hi - 1) % grid.factor == Vec3i(0));
    CHECK(VoxelBox{Vec3i(0), grid.dims}.contains(grid.region));
    const Vec3 entry = grid.bone_from_index.inverse() * spec.head_entry;
    CHECK(glm::length(entry - glm::round(entry)) < 1e-6);
    CHECK(grid.region.contains(VoxelBox{Vec3i(glm::round(entry)), Vec3i(glm::round(entry)) + 1}));
    // k points out of the skull, along the axis.
    CHECK(glm::length(grid.bone_from_index.linear[2] / spec.pitch + spec.head_axis) < 1e-9);
  }
  PhantomSpec thin = spec_at("pterion_left", 0.25 * kMm, 0.25 * kMm);
  CHECK(!validate(thin).empty());
  CHECK(!make_head_bone(thin));
  CHECK(!make_phantom(spec_at("pterion_left", 0.25 * kMm, 1.5 * kMm)));
}

}  // namespace burrhole
