// Opened pores and the volume of a hole: bored cylinders, planes and balls against closed forms, levels against a plain twin, and updates in any
// order. Counting the faces of voxels instead must fail.
#include "core/blood/blood_site.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

using namespace burrhole;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFar = 1e9;  // [s] no coagulation

/// A block of bone [m] whose top is at z = 0, with air above; all of one porosity.
SiteBone block(double edge, const Vec3& half, double below, double porosity, const Vec3& down = {0.0, 0.0, -1.0}) {
  const Vec3i n(glm::ceil(half / edge));
  SiteBone out{.box = {Vec3i(-n.x, -n.y, -static_cast<int>(std::ceil(below / edge))), Vec3i(n.x + 1, n.y + 1, 4)},
               .bone_from_index = Affine::scaling(edge, Vec3(0.0, 0.0, 0.5 * edge)),
               .down = down};
  for_each_voxel(out.box, [&](const Vec3i& voxel) {
    const bool bone = voxel.z < 0;
    out.whole.push_back(bone ? 1.0f : 0.0f);
    out.pores.push_back(bone ? static_cast<float>(porosity) : 0.0f);
    out.outside.push_back(bone ? 0 : 1);
  });
  out.start = out.whole;
  return out;
}

/// Density of the block less what a body holds. @param depth [m] of a point inside the body, negative outside. @param ramp [voxels] half width.
std::vector<float> cut_by(const SiteBone& bone, const VoxelBox& of, const std::function<double(const Vec3&)>& depth, double ramp) {
  std::vector<float> out;
  const double edge = bone.bone_from_index.mean_edge();
  for_each_voxel(of, [&](const Vec3i& voxel) {
    const float whole = bone.box.contains(voxel) ? bone.whole[bone.box.offset_of(voxel)] : voxel.z < 0 ? 1.0f : 0.0f;
    const double d = depth(bone.bone_from_index * Vec3(voxel)) / edge;
    const double left = ramp > 0.0 ? std::clamp(0.5 - 0.5 * d / ramp, 0.0, 1.0) : d > 0.0 ? 0.0 : 1.0;
    out.push_back(whole * static_cast<float>(left));
  });
  return out;
}

BloodSite drilled(const SiteBone& bone, const std::function<double(const Vec3&)>& depth, double ramp) {
  BloodSite site(bone);
  site.update(bone.box, cut_by(bone, bone.box.grown(1), depth, ramp), 0.0, kFar);
  return site;
}

std::function<double(const Vec3&)> cylinder(double radius, double bottom) {
  return [=](const Vec3& p) { return std::min(radius - std::hypot(p.x, p.y), p.z + bottom); };
}

/// Area [m^2] of the faces of voxels between bone and the hole.
double faces(const SiteBone& bone, const std::function<double(const Vec3&)>& depth) {
  const std::vector<float> left = cut_by(bone, bone.box, depth, 0.0);
  double count = 0.0;
  for_each_voxel(bone.box.grown(-1), [&](const Vec3i& voxel) {
    if (voxel.z >= 0 || left[bone.box.offset_of(voxel)] > 0.5f) return;
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1}) {
        Vec3i step(0);
        step[axis] = sign;
        count += left[bone.box.offset_of(voxel + step)] > 0.5f ? 1.0 : 0.0;
      }
  });
  const double edge = bone.bone_from_index.mean_edge();
  return count * edge * edge;
}

}  // namespace

TEST_CASE("blood: the opened pores of a bored cylinder have the area of its wall and floor, times the porosity") {
  const double radius = 5e-3, bottom = 4e-3, porosity = 0.4;
  const double exact = porosity * (2.0 * kPi * radius * bottom + kPi * radius * radius);
  double before = 1.0;
  for (const double edge : {0.5e-3, 0.25e-3, 0.125e-3}) {
    const SiteBone bone = block(edge, Vec3(7e-3), 6e-3, porosity);
    // The wall ends at the top, where half a voxel of the gradient is lost, and meets the floor in a rounded edge: errors of the order of
    // edge / bottom = 0.125, 0.06, 0.03 times the wall's share, halved with the voxel.
    const double error = std::abs(drilled(bone, cylinder(radius, bottom), 1.0).open_pores() / exact - 1.0);
    MESSAGE("edge " << edge * 1e3 << " mm: error " << error);
    CHECK(error < 0.6 * edge / bottom);
    CHECK(error < 0.7 * before);
    before = error;
    // Whole voxels: central differences see a step over two voxels, so directions are known to some degrees only.
    const double whole = std::abs(drilled(bone, cylinder(radius, bottom), 0.0).open_pores() / exact - 1.0);
    MESSAGE("whole voxels: error " << whole);
    CHECK(whole < 0.08 + 0.6 * edge / bottom);
    // The sabotage: faces of voxels do not converge. The wall of a cylinder has 4/pi of its area, so the sum 17 % too much; less the row at the top.
    const double wrong = porosity * faces(bone, cylinder(radius, bottom)) / exact - 1.0;
    CHECK(wrong > 0.1);
  }
}

TEST_CASE("blood: planes in 40 directions have their area within 1.5 % as ramps and within 15 % as whole voxels") {
  std::mt19937 random(7);  // seed 7
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double edge = 0.25e-3, half = 4e-3;
  for (int n = 0; n < 40; ++n) {
    Vec3 normal(uniform(random), uniform(random), uniform(random));
    if (glm::length(normal) < 0.2) continue;
    normal = glm::normalize(normal);
    CAPTURE(normal.x);
    CAPTURE(normal.y);
    SiteBone bone = block(edge, Vec3(half + 2 * edge), 2.0 * half, 1.0);
    std::ranges::fill(bone.whole, 1.0f);
    bone.start = bone.whole;
    // Counted inside a ball only, where the plane's area is pi r^2.
    const Vec3 centre(0.0, 0.0, -half);
    for_each_voxel(bone.box, [&](const Vec3i& voxel) {
      bone.pores[bone.box.offset_of(voxel)] = glm::length(bone.bone_from_index * Vec3(voxel) - centre) < 0.8 * half ? 1.0f : 0.0f;
    });
    const auto plane = [&](const Vec3& p) { return glm::dot(normal, p - centre) - 0.3 * edge; };
    const double exact = kPi * 0.64 * half * half;
    const auto of = [&](double ramp) {
      BloodSite site(bone);
      std::vector<float> left;
      for_each_voxel(bone.box.grown(1), [&](const Vec3i& voxel) {
        const double d = plane(bone.bone_from_index * Vec3(voxel)) / edge;
        left.push_back(static_cast<float>(ramp > 0.0 ? std::clamp(0.5 - 0.5 * d / ramp, 0.0, 1.0) : d > 0.0 ? 0.0 : 1.0));
      });
      site.update(bone.box, left, 0.0, kFar);
      return site.open_pores() / exact - 1.0;
    };
    CHECK(std::abs(of(1.5)) < 0.015);  // 1 % of central differences across a clamped ramp, 0.5 % of the rim of the ball
    CHECK(std::abs(of(0.0)) < 0.15);   // between the axes a step is seen over two voxels twice; faces of voxels have up to 73 % too much
  }
}

TEST_CASE("blood: dense bone, bone as loaded and cuts of before the run do not bleed") {
  SiteBone bone = block(0.25e-3, Vec3(5e-3), 5e-3, 0.4);
  BloodSite whole(bone);
  whole.update(bone.box,
               cut_by(
                   bone, bone.box.grown(1), [](const Vec3&) { return -1.0; }, 1.0),
               0.0, kFar);
  CHECK(whole.open_pores() == 0.0);
  CHECK(whole.capacity() == 0.0);
  bone.start = cut_by(bone, bone.box, cylinder(3e-3, 3e-3), 1.0);
  const BloodSite earlier = drilled(bone, cylinder(3e-3, 3e-3), 1.0);
  CHECK(earlier.open_pores() == 0.0);
  CHECK(earlier.capacity() > 0.0);
  const BloodSite dense = drilled(block(0.25e-3, Vec3(5e-3), 5e-3, 0.0), cylinder(3e-3, 3e-3), 1.0);
  CHECK_FALSE(dense.has_pores());
  CHECK(dense.open_pores() == 0.0);
}

TEST_CASE("blood: a cylindrical hole of area A fills to V / A, and overflows at its rim") {
  for (const double edge : {0.5e-3, 0.25e-3}) {
    const double radius = 5.1e-3, bottom = 4e-3;
    const BloodSite site = drilled(block(edge, Vec3(7e-3), 6e-3, 0.4), cylinder(radius, bottom), 0.0);
    // Whole voxels: those whose centres lie inside. Their area differs from the circle's by the circle problem, some percent here.
    int inside = 0;
    for (int i = -30; i <= 30; ++i)
      for (int j = -30; j <= 30; ++j) inside += std::hypot(i * edge, j * edge) < radius ? 1 : 0;
    const double area = inside * edge * edge;
    CHECK(site.capacity() == doctest::Approx(area * bottom).epsilon(1e-9));
    CHECK(std::abs(site.spill()) < 1e-9 * bottom);
    CHECK(site.floor() == doctest::Approx(-bottom));
    for (const double share : {0.1, 0.37, 0.5, 0.99})
      CHECK(site.level_of(share * site.capacity()) - site.floor() == doctest::Approx(share * bottom).epsilon(1e-9));
    CHECK(site.level_of(2.0 * site.capacity()) == site.spill());
    CHECK(site.area_at(-0.5 * bottom) == doctest::Approx(area).epsilon(1e-9));
  }
}

TEST_CASE("blood: under any gravity the level agrees with a plain twin that fills the voxels from the lowest on") {
  std::mt19937 random(3);  // seed 3
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  const double edge = 0.25e-3;
  for (int n = 0; n < 8; ++n) {
    const Vec3 down = n == 0 ? Vec3(0.0, 0.0, -1.0) : glm::normalize(Vec3(uniform(random), uniform(random), -1.0));
    const SiteBone bone = block(edge, Vec3(6e-3), 6e-3, 0.4, down);
    const auto depth = cylinder(4e-3, 4e-3);
    const BloodSite site = drilled(bone, depth, 1.0);
    const std::vector<float> left = cut_by(bone, bone.box, depth, 1.0);
    std::vector<std::pair<double, double>> voxels;  // height, volume
    double spill = 1.0;
    for_each_voxel(bone.box, [&](const Vec3i& voxel) {
      const std::size_t at = bone.box.offset_of(voxel);
      const double gone = static_cast<double>(bone.whole[at] - left[at]), height = -glm::dot(down, bone.bone_from_index * Vec3(voxel));
      if (gone > 0.0) voxels.emplace_back(height, gone * edge * edge * edge);
      if (gone > 0.5 && voxel.z == -1) spill = std::min(spill, -glm::dot(down, bone.bone_from_index * Vec3(Vec3i(voxel.x, voxel.y, 0))));
    });
    std::ranges::sort(voxels);
    // A layer is at most one edge high, and the rim is known to a layer.
    CHECK(std::abs(site.spill() - (spill - 0.5 * edge)) < 1.1 * edge);
    for (const double share : {0.2, 0.6, 0.95}) {
      double sum = 0.0, level = 0.0;
      for (const auto& [height, volume] : voxels) {
        if (sum >= share * site.capacity()) break;
        sum += volume;
        level = height;
      }
      CHECK(std::abs(site.level_of(share * site.capacity()) - level) < 1.1 * edge);
      CHECK(site.volume_below(site.level_of(share * site.capacity())) == doctest::Approx(share * site.capacity()).epsilon(1e-9));
    }
  }
}

TEST_CASE("blood: updates box by box in any order give the same hole as one, and bone that comes back leaves nothing") {
  const SiteBone bone = block(0.25e-3, Vec3(5e-3), 5e-3, 0.4);
  const auto depth = cylinder(3e-3, 3e-3);
  const BloodSite once = drilled(bone, depth, 1.0);
  BloodSite parts(bone);
  std::vector<VoxelBox> boxes;
  for (int i = bone.box.lo.x; i < bone.box.hi.x; i += 7)
    for (int k = bone.box.lo.z; k < bone.box.hi.z; k += 5)
      boxes.push_back(VoxelBox{Vec3i(i, bone.box.lo.y, k), Vec3i(i + 7, bone.box.hi.y, k + 5)}.intersect(bone.box));
  std::ranges::shuffle(boxes, std::mt19937(5));  // seed 5
  for (const VoxelBox& box : boxes) parts.update(box, cut_by(bone, box.grown(1), depth, 1.0), 1.0, kFar);
  CHECK(parts.capacity() == once.capacity());
  CHECK(parts.spill() == once.spill());
  CHECK(parts.open_pores() == doctest::Approx(once.open_pores()).epsilon(1e-12));
  parts.update(bone.box,
               cut_by(
                   bone, bone.box.grown(1), [](const Vec3&) { return -1.0; }, 1.0),
               2.0, kFar);
  CHECK(parts.capacity() == 0.0);
  CHECK(parts.drive(1e3, -1.0, 0.0) == 0.0);
  CHECK(std::abs(parts.open_pores()) < 1e-15);
}

TEST_CASE("blood: wax closes all sources; a cut through it opens the new surface alone, unless the wax is deeper") {
  constexpr double kEdge = 0.25e-3, kRadius = 3e-3, kPorosity = 0.4;
  const SiteBone bone = block(kEdge, Vec3(6e-3), 6e-3, kPorosity);
  // A hole of 3 mm is waxed and goes on to 4 mm. Its face, a ramp of one voxel to both sides, is a source up to two voxels from it: 0.5 mm of the
  // new wall are waxed by any wax, and none of the new floor by wax of up to 0.5 mm. The floor's ramp has slopes of 1/8 in the first and in the fourth row
  // of voxels, 3/8 in the others, so wax to a depth of 0.75 mm, past the first row, takes an eighth of it; of 1.5 mm all.
  const double wall = kPorosity * 2.0 * kPi * kRadius * kEdge, ground = kPorosity * kPi * kRadius * kRadius;  // a row of it; the floor
  struct Case {
    double depth, left;  // [m], [m^2]
  };
  for (const Case& one : {Case{0.0, 2.0 * wall + ground}, {0.5e-3, 2.0 * wall + ground}, {0.75e-3, wall + 0.875 * ground}, {1.5e-3, 0.0}}) {
    CAPTURE(one.depth);
    BloodSite site = drilled(bone, cylinder(kRadius, 3e-3), 1.0);
    const double open = site.open_pores();
    CHECK(site.wax(one.depth) == open);
    CHECK(site.open_pores() == 0.0);
    CHECK(site.waxed_pores() == open);
    CHECK(site.drive(1e3, site.floor(), 0.0) == 0.0);
    site.update(bone.box, cut_by(bone, bone.box.grown(1), cylinder(kRadius, 4e-3), 1.0), 1.0, kFar);
    // Wax ends within half a voxel, of the wall. Where wall and floor meet, the gradient is theirs together over two voxels: of each a voxel times 1 - 1/sqrt(2) is lost.
    const double off = (0.5 + 2.0 * (1.0 - std::numbers::sqrt2 / 2.0)) * wall;
    MESSAGE("wax " << one.depth * 1e3 << " mm deep: open " << site.open_pores() * 1e6 << " mm2, expected " << one.left * 1e6 << " within "
                   << off * 1e6);
    CHECK(std::abs(site.open_pores() - one.left) < off);
    // Sabotage: wax that is measured from the last source, 1.5 voxels deeper.
    if (one.depth == 0.5e-3) CHECK(std::abs(site.open_pores() - (0.5 * wall + 0.5 * ground)) > 2.0 * off);
    site.unwax(1.0, kFar);
    CHECK(std::abs(site.waxed_pores()) < 1e-12 * open);
    CHECK(site.open_pores() == doctest::Approx(drilled(bone, cylinder(kRadius, 4e-3), 1.0).open_pores()).epsilon(1e-9));
  }
}

TEST_CASE("blood: each source coagulates from the time at which it was cut") {
  const SiteBone bone = block(0.25e-3, Vec3(6e-3), 6e-3, 0.4);
  const double tau = 50.0, dt = 0.02;
  BloodSite site(bone);
  site.update(bone.box, cut_by(bone, bone.box.grown(1), cylinder(3e-3, 2e-3), 1.0), 0.0, tau);
  const double first = site.open_pores();
  const int steps = 1000;
  for (int n = 0; n < steps; ++n) site.decay(std::exp(-dt / tau));
  CHECK(site.drive(1.0, site.floor(), 0.0) == doctest::Approx(first * std::exp(-steps * dt / tau)).epsilon(1e-9));
  // All surfaces are cut again by widening: all are fresh.
  site.update(bone.box, cut_by(bone, bone.box.grown(1), cylinder(4e-3, 3e-3), 1.0), steps * dt, tau);
  CHECK(site.drive(1.0, site.floor(), 0.0) == doctest::Approx(site.open_pores()).epsilon(1e-6));
}
