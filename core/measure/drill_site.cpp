#include "core/measure/drill_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/bounds.h"
#include "core/base/units.h"
#include "core/measure/approach.h"
#include "core/measure/approach_check.h"
#include "core/measure/largest_part.h"

namespace burrhole {
namespace {

constexpr double kStep = 0.5;           // [voxels] between two samples of a ray, at most
constexpr int kBisections = 20;         // of the place between two samples
constexpr double kFootprint = 6.0e-3;   // [m] radius in which the normal is found: that of a 14 mm perforator, without its edge
constexpr double kBraincase = 75.0e-3;  // [m] of the middle of the braincase below the highest bone
constexpr double kHeadWidth = 0.11;     // [m] a bone that is wider and longer is a head
constexpr double kNear = 30.0e-3;       // [m] largest distance of a proposed entry from the point that was given
constexpr double kOutside = 40.0e-3;    // [m] start of a ray to the surface above the point that was given
constexpr double kOutwards = 0.26;      // [-] cosine of 75 degrees: an axis leads at least so much towards the middle of the braincase
constexpr double kThickest = 20.0e-3;   // [m] more bone than a vault has: the axis follows the bone, or meets the base

/// @returns the part [enter, leave] of a ray in a box; enter > leave if there is none.
std::pair<double, double> clip(const Vec3& from, const Vec3& direction, const Vec3& lo, const Vec3& hi) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int c = 0; c < 3; ++c) {
    if (direction[c] == 0.0) {
      if (from[c] < lo[c] || from[c] > hi[c]) return {1.0, 0.0};
      continue;
    }
    const double a = (lo[c] - from[c]) / direction[c], b = (hi[c] - from[c]) / direction[c];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return {enter, leave};
}

/// Two vectors of length 1 that are perpendicular to n and to each other.
std::pair<Vec3, Vec3> across(const Vec3& n) {
  const Quat turn = rotation_from_z(n);
  return {turn * Vec3(1.0, 0.0, 0.0), turn * Vec3(0.0, 1.0, 0.0)};
}

/// A point of the surface: place in the plane across `outward`, and height along it [m].
struct Height {
  double u, v, h;
};

std::vector<Height> heights_around(const BoneModel& bone, const Vec3& at, const Vec3& outward, double radius) {
  const auto sides = across(outward);
  const Vec3 &right = sides.first, &up = sides.second;
  std::vector<Height> out;
  const auto add = [&](double u, double v) {
    if (const auto hit = find_bone(bone, at + u * right + v * up + radius * outward, -outward))
      if (const double h = glm::dot(*hit - at, outward); std::abs(h) < radius) out.push_back({u, v, h});
  };
  add(0.0, 0.0);
  for (const auto& [share, count] : {std::pair(0.5, 8), std::pair(1.0, 16)})
    for (int n = 0; n < count; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / count;
      add(share * radius * std::cos(angle), share * radius * std::sin(angle));
    }
  return out;
}

/// Least squares h = a + b u + c v. @returns (b, c); nothing if the points lie on a line.
std::optional<glm::dvec2> slopes_of(const std::vector<Height>& points) {
  glm::dmat3 normal(0.0);
  Vec3 right(0.0);
  for (const Height& p : points) {
    const Vec3 row(1.0, p.u, p.v);
    normal += glm::outerProduct(row, row);
    right += row * p.h;
  }
  const double size = normal[0][0] * normal[1][1] * normal[2][2];
  if (!(std::abs(glm::determinant(normal)) > 1e-6 * size)) return std::nullopt;
  const Vec3 fit = glm::inverse(normal) * right;
  return glm::dvec2(fit.y, fit.z);
}

/// Directions at most 75 degrees from one, that first, even on the sphere.
std::vector<Vec3> directions_round(const Vec3& outward) {
  constexpr int kCount = 200;  // on the whole sphere: 11 degrees apart
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<Vec3> out{outward};
  for (int n = 0; n < kCount; ++n) {
    const double z = 1.0 - (2.0 * n + 1.0) / kCount, r = std::sqrt(1.0 - z * z);
    const Vec3 one(r * std::cos(golden * n), r * std::sin(golden * n), z);
    if (glm::dot(one, outward) > kOutwards) out.push_back(one);
  }
  return out;
}

/// The middle of the braincase of a skull in a box of voxels.
Vec3 middle_of(const BoneModel& bone, const VoxelBox& box) {
  const Bounds around = bounds_under(bone.bone_from_index(), Bounds{Vec3(box.lo), Vec3(box.hi - 1)});
  Vec3 middle = 0.5 * (around.lo + around.hi);
  const Vec3 size = around.hi - around.lo;
  if (std::min(size.x, size.y) > kHeadWidth) middle.z = around.hi.z - kBraincase;  // also where the scan ends above it
  return middle;
}

Error no_site(const BoneModel& bone, const Vec3& near, const std::string& why) {
  const VoxelBox& box = bone.bone_box();
  const Bounds around = bounds_under(bone.bone_from_index(), Bounds{Vec3(box.lo), Vec3(box.hi - 1)});
  const Vec3 p = near / kMillimetre, lo = around.lo / kMillimetre, hi = around.hi / kMillimetre;
  return bad_input(
      fmt::format("no hole can be planned near ({:g}, {:g}, {:g}) mm: {}; the bone spans x {:.1f} to {:.1f}, y {:.1f} to {:.1f}, "
                  "z {:.1f} to {:.1f} mm (left, posterior, superior)",
                  p.x, p.y, p.z, why, lo.x, hi.x, lo.y, hi.y, lo.z, hi.z));
}

}  // namespace

std::optional<Vec3> find_bone(const BoneModel& bone, const Vec3& from, const Vec3& direction) {
  const Affine index_from_bone = bone.bone_from_index().inverse();
  const Vec3 start = index_from_bone * from, along = index_from_bone.linear * direction;
  const VoxelBox box = bone.bone_box();
  const auto [enter, leave] = clip(start, along, Vec3(box.lo) - 1.5, Vec3(box.hi) + 0.5);
  if (!(enter <= leave)) return std::nullopt;
  const auto inside = [&](double t) { return sample_occupancy(bone, start + t * along) >= 0.5; };
  const double step = kStep / std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)});
  double before = enter;
  if (inside(before)) return from + before * direction;
  for (double t = enter + step;; t += step) {
    if (inside(t)) {
      for (int n = 0; n < kBisections; ++n) (inside(0.5 * (before + t)) ? t : before) = 0.5 * (before + t);
      return from + t * direction;
    }
    if (t > leave) return std::nullopt;
    before = t;
  }
}

Vec3 disc_normal(const BoneModel& bone, const Vec3& at, const Vec3& outward, double radius) {
  constexpr int kRounds = 4;
  constexpr std::size_t kFewest = 12;  // of 25 points
  Vec3 normal = outward;
  for (int n = 0; n < kRounds; ++n) {
    const std::vector<Height> points = heights_around(bone, at, normal, radius);
    if (points.size() < kFewest) return outward;
    const auto slopes = slopes_of(points);
    if (!slopes) return outward;
    const auto [right, up] = across(normal);
    normal = glm::normalize(normal - slopes->x * right - slopes->y * up);
  }
  return normal;
}

Result<DrillSite> make_site(const BoneModel& bone, const Vec3& at, const Vec3& outward) {
  const Vec3 normal = disc_normal(bone, at, outward, kFootprint);
  const auto approach = make_approach(bone, {.entry = at, .axis = -normal, .place = {}});
  if (!approach) return approach.error();
  if (const auto wrong = leaves_skull(bone, *approach)) return bad_input(*wrong);
  return DrillSite{approach->bone_from_approach.translation, -normal, approach->thickness};
}

Vec3 braincase_middle(const BoneModel& bone) { return middle_of(bone, LargestPart(bone).box()); }

Result<DrillSite> suggest_site(const BoneModel& bone, const Vec3& near) {
  if (bone.bone_voxels() == 0) return bad_input("the volume has no bone");
  const LargestPart skull(bone);
  const Affine index_from_bone = bone.bone_from_index().inverse();
  const Vec3 way = near - middle_of(bone, skull.box());
  const Vec3 outward = glm::length(way) > 0.0 ? glm::normalize(way) : Vec3(0.0, 0.0, 1.0);
  std::optional<DrillSite> best;
  double nearest = std::numeric_limits<double>::infinity();  // [m] of a surface that no hole can be planned on
  std::string why;
  const auto look_from = [&](const Vec3& from) {
    const auto surface = find_bone(bone, near + kOutside * from, -from);
    if (!surface) return;
    const double away = glm::length(*surface - near);
    if (!skull.is_near(index_from_bone * *surface)) {
      if (away <= kNear && why.empty()) why = "what is there is no part of the skull, the largest piece of bone: a headrest, for example";
      return;
    }
    if (away > kNear || (best && away >= glm::length(best->entry - near))) return;
    const auto site = make_site(bone, *surface, from);
    if (site && glm::dot(-site->axis, outward) > kOutwards && site->thickness <= kThickest) {
      best = *site;
    } else if (away < nearest) {
      nearest = away;
      why = !site ? site.error().message : fmt::format("square to the surface there are {:.1f} mm of bone", site->thickness / kMillimetre);
    }
  };
  for (const Vec3& from : directions_round(outward)) look_from(from);
  constexpr int kRounds = 3;  // the nearest place of a surface lies along its normal there
  for (int n = 0; n < kRounds && best; ++n) look_from(-best->axis);
  if (best) return *best;
  return no_site(bone, near, why.empty() ? way_to_bone(bone, near) : why);
}

double distance_to_edge(const BoneModel& bone, const DrillSite& site) {
  const Affine index_from_bone = bone.bone_from_index().inverse();
  const Vec3 last = Vec3(bone.dims() - 1);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& end : {site.entry, site.entry + site.thickness * site.axis}) {
    const Vec3 index = index_from_bone * end;
    for (std::size_t c = 0; c < 3; ++c) {
      // Faces of equal index c are planes, 1 / |gradient of the index| apart, in a sheared grid too.
      const Vec3 gradient(index_from_bone.linear[0][c], index_from_bone.linear[1][c], index_from_bone.linear[2][c]);
      nearest = std::min(nearest, std::min(index[c], last[c] - index[c]) / glm::length(gradient));
    }
  }
  return std::max(0.0, nearest);
}

std::string approach_text(const DrillSite& site) {
  const Vec3 entry = site.entry / kMillimetre;
  return fmt::format(
      "[approach]                          # patient coordinates: left, posterior, superior\n"
      "entry_mm = [{:.3f}, {:.3f}, {:.3f}]\n"
      "axis = [{:.6f}, {:.6f}, {:.6f}]      # square to the bone there\n",
      entry.x, entry.y, entry.z, site.axis.x, site.axis.y, site.axis.z);
}

}  // namespace burrhole
