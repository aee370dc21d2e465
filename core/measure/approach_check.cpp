#include "core/measure/approach_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/contact/contact_view.h"

namespace burrhole {
namespace {

constexpr double kReach = 0.3;    // [m] along an axis, more than the length of a head
constexpr double kGap = 2e-3;     // [m] as in make_approach()
constexpr double kBehind = 0.02;  // [m] the search range of make_approach() above the entry

/// Bone as loaded on a line.
class Line {
 public:
  Line(const BoneModel& bone, const Vec3& origin, const Vec3& axis)
      : bone_(&bone),
        index_from_bone_(bone.bone_from_index().inverse()),
        origin_(origin),
        axis_(axis),
        step_(0.5 * bone.bone_from_index().mean_edge()) {}
  [[nodiscard]] bool is_bone(double at) const {
    return sample_occupancy(*bone_, index_from_bone_ * (origin_ + axis_ * at)) >= kSurfaceLevel;
  }
  [[nodiscard]] Vec3 place(double at) const { return origin_ + axis_ * at; }
  /// @returns the first place in steps from `from` towards `to` [m] at which bone is, or is not, as asked; nothing if there is none.
  [[nodiscard]] std::optional<double> find(double from, double to, bool bone) const {
    const double step = to > from ? step_ : -step_;
    const auto count = static_cast<int>(std::abs(to - from) / step_);
    for (int n = 0; n <= count; ++n)
      if (const double at = from + n * step; is_bone(at) == bone) return at;
    return std::nullopt;
  }

 private:
  const BoneModel* bone_;
  Affine index_from_bone_;
  Vec3 origin_, axis_;
  double step_;  // [m]
};

/// @returns the centre of the bone voxel nearest to a point [m]; nothing if there is no bone.
std::optional<Vec3> nearest_bone(const BoneModel& bone, const Vec3& point) {
  const Vec3 at = bone.bone_from_index().inverse() * point;
  struct Region {
    double least;  // [voxels] lower bound of the distance
    VoxelBox box;
  };
  std::vector<Region> regions;
  bone.for_each_region([&](const VoxelBox& box) {
    const VoxelBox inside = box.intersect(bone.bounds());
    regions.push_back({glm::length(glm::max(glm::max(Vec3(inside.lo) - at, at - Vec3(inside.hi - 1)), Vec3(0.0))), inside});
  });
  std::ranges::sort(regions, {}, &Region::least);
  double best = std::numeric_limits<double>::max();
  std::optional<Vec3> out;
  std::vector<float> occupancy;
  for (const Region& region : regions) {
    if (region.least >= best) break;
    occupancy.resize(region.box.count());
    bone.read_occupancy(region.box, occupancy);
    for_each_voxel(region.box, [&](const Vec3i& v) {
      if (occupancy[region.box.offset_of(v)] < kSurfaceLevel) return;
      const double away = glm::length(Vec3(v) - at);
      if (away >= best) return;
      best = away;
      out = bone.bone_from_index() * Vec3(v);
    });
  }
  return out;
}

/// Depths of the first and of the last bone on a line, from its origin [m]; a gap of 2 mm ends the bone. Nothing if bone is there from the
/// start, does not begin, or does not end.
std::optional<std::pair<double, double>> bone_on(const Line& line, double from, double to) {
  const auto first = line.find(from, to, true);
  if (!first || *first <= from) return std::nullopt;
  for (double last = *first; last < to;) {
    const auto free = line.find(last, to, false);
    if (!free) return std::nullopt;
    const auto next = line.find(*free, *free + kGap, true);
    if (!next) return std::pair{*first, *free};
    last = *next;
  }
  return std::nullopt;
}

/// How both surfaces of the bone round the entry are curved, on a ring round the axis: mean depth against that on the axis [m].
struct Curving {
  double outer = 0.0, inner = 0.0;
};

/// Opposite points of the ring cancel a leaning axis. @returns nothing where the ring leaves the bone as loaded.
std::optional<Curving> curving_of(const BoneModel& bone, const Approach& approach) {
  constexpr double kRing = 0.012, kRange = 0.015;  // [m]
  constexpr int kPoints = 16;
  const Vec3 axis = approach.bone_from_approach.rotate(Vec3(0.0, 0.0, -1.0));
  Curving out;
  for (int n = 0; n < kPoints; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kPoints;
    const Line line(bone, approach.bone_from_approach * (kRing * Vec3(std::cos(angle), std::sin(angle), 0.0)), axis);
    const auto found = bone_on(line, -kRange, approach.thickness + kRange);
    if (!found) return std::nullopt;
    out.outer += found->first / kPoints;
    out.inner += (found->second - approach.thickness) / kPoints;
  }
  return out;
}

/// @returns v, rounded to multiples of 1 / per; never -0.
Vec3 rounded(const Vec3& v, double per) { return glm::round(v * per) / per + Vec3(0.0); }

}  // namespace

std::string start_text(const ApproachStart& start) {
  const Vec3 e = rounded(start.entry * 1e3, 10.0), a = rounded(start.axis, 1000.0);
  return fmt::format("entry_mm = [{:.1f}, {:.1f}, {:.1f}], axis = [{:.3f}, {:.3f}, {:.3f}]", e.x, e.y, e.z, a.x, a.y, a.z);
}

std::string way_to_bone(const BoneModel& bone, const Vec3& point) {
  const auto near = nearest_bone(bone, point);
  if (!near) return {};
  constexpr std::array<std::array<const char*, 2>, 3> kWays{{{"right", "left"}, {"anterior", "posterior"}, {"inferior", "superior"}}};
  const Vec3 way = (*near - point) * 1e3;
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < 3; ++c)
    if (std::abs(way[c]) >= 1.0) parts.push_back(fmt::format("{:.0f} mm {}", std::abs(way[c]), kWays[c][way[c] > 0.0 ? 1 : 0]));
  return fmt::format("the nearest bone lies {:.0f} mm away{}{}", glm::length(way), parts.empty() ? "" : ": ", fmt::join(parts, ", "));
}

std::vector<ApproachStart> possible_starts(const BoneModel& bone, const ApproachScene& scene) {
  std::vector<ApproachStart> out;
  const Line line(bone, scene.entry, scene.axis);
  if (const auto free = line.find(-kBehind, -kReach, false)) out.push_back({line.place(*free), scene.axis});
  if (const auto first = line.find(-kReach, kReach, true)) out.push_back({line.place(*first), scene.axis});
  if (const auto near = nearest_bone(bone, scene.entry)) {
    out.push_back({*near, scene.axis});
    const Vec3 way = *near - scene.entry;
    if (glm::length(way) > 0.0) out.push_back({*near, glm::normalize(way)});
  }
  return out;
}

std::optional<std::string> leaves_skull(const BoneModel& bone, const Approach& approach) {
  const Vec3 entry = approach.bone_from_approach.translation, axis = approach.bone_from_approach.rotate(Vec3(0.0, 0.0, -1.0));
  const Line line(bone, entry, axis);
  const bool bone_ahead = line.find(approach.thickness + kBehind, kReach, true).has_value();
  const auto curving = curving_of(bone, approach);
  // From outside both surfaces bulge towards the start, whatever is behind it: a headrest, for example. A sphere of radius R differs by
  // r^2 / (2 R) on a ring of radius r, 0.9 mm for a skull of R = 80 mm.
  constexpr double kCurved = 0.4e-3;  // [m]
  const bool bulges = curving && curving->outer > kCurved && curving->inner > kCurved;
  const bool is_hollow = curving && curving->outer < -kCurved && curving->inner < -kCurved;
  const bool bone_behind = !bone_ahead && !bulges && line.find(-kBehind, -kReach, true).has_value();
  const char* why = approach.from_inside ? "it meets dura or brain before the entry"
                    : bone_behind        ? "the other side of the skull is behind the entry"
                    : is_hollow          ? "the bone is hollow there, as the skull is from inside"
                                         : nullptr;
  if (why == nullptr) return std::nullopt;
  return fmt::format("the approach starts inside the skull and leaves it: {}; start at {}", why,
                     start_text({entry + axis * approach.thickness, -axis}));
}

}  // namespace burrhole
