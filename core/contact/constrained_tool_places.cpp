// Contact of the constrained tool between the points of its shell.
#include <algorithm>
#include <limits>
#include <utility>

#include "core/contact/constrained_tool.h"
#include "core/contact/tool_candidates.h"

namespace burrhole {
namespace {

constexpr double kKnown = 0.6;                  // [voxel edges] places farther from bone are not kept
constexpr double kFollowed = 0.3;               // [voxel edges] nearer ones follow the contact
constexpr double kBeyondCell = 1.2;             // [-] of the radius of its cell, how far a contact may move from its shell point
constexpr double kSmooth = 0.15, kSharp = 0.4;  // [1/voxel edge] bend up to which bone is smooth, and from which on it is an edge
constexpr double kStill = 0.1;                  // [voxel edges] a contact that moved less is where it was sampled
constexpr double kSame = 0.2;                   // [voxel edges] from a kept plane, at which a place becomes that of the plane
constexpr double kNotYet = 0.15;                // [voxel edges]
constexpr double kStillSame = 0.7;              // [voxel edges] of a kept plane from the place that it stands for
constexpr int kSettleRounds = 4;
constexpr double kAlike = 0.5;  // [-] cosine: least agreement of a contact normal with that of the record

}  // namespace

bool ConstrainedTool::settle(const SurfaceView& bone, const PlaceFinder& finder, HoldPlane& plane) const noexcept {
  plane.cutting = false;
  auto here = finder.sample(plane.place);
  if (!here || here->gap > kKnown * edge_) return false;
  for (int round = 0; round < kSettleRounds; ++round) {
    const ContactPlace from = *here;
    plane.place = from.at;
    plane.arm = bone_from_tool_.rotate(from.at);
    plane.gap = from.gap;
    const double sharp = std::clamp((from.bend * edge_ - kSmooth) / (kSharp - kSmooth), 0.0, 1.0);
    if (sharp < 1.0) {
      const Vec3 smooth = direction(bone, plane, bone_from_tool_.translation + plane.arm, from.normal, false);
      here->normal = glm::normalize(smooth + (from.normal - smooth) * sharp);
    }
    plane.normal = here->normal;
    const auto contact = finder.settle(*here);
    if (!contact || glm::dot(contact->normal, from.normal) < kAlike) break;
    const double moved = glm::length(contact->at - from.at);
    if (moved > kStill * edge_) {
      // What is known at a place holds near it; farther away it is only a direction in which bone may be nearer.
      const auto there = finder.sample(contact->at);
      if (moved > edge_ || !there || there->gap >= from.gap) {
        plane.normal = contact->normal;
        break;
      }
      here = there;
      continue;
    }
    plane.place = contact->at;
    plane.arm = bone_from_tool_.rotate(contact->at);
    plane.normal = contact->normal;
    plane.gap = contact->gap;
    break;
  }
  plane.yield = yield_of(bone, plane, bone_from_tool_.translation + plane.arm);
  return true;
}

void ConstrainedTool::look_between(const SurfaceView& bone, bool far) noexcept {
  if (far) {
    since_far_look_ = 0.0;
    cells_.lower(glm::mat3_cast(bone_from_tool_.rotation), hits_);
  } else {
    ShellCells::copy(hits_);
  }
  const PlaceFinder finder(surface_.get(), bone.records, bone_from_tool_);
  searched_.refresh([&](SearchedPlaces::Place& place) {
    const std::size_t hit = places_.find(hits_, place.point);
    if (hit == hits_.count && far) return false;
    if (!follow(finder, place, far)) return false;
    if (hit < hits_.count) hits_.lower[hit] = kHidden;
    return true;
  });
}

bool ConstrainedTool::follow(const PlaceFinder& finder, SearchedPlaces::Place& place, bool far) const noexcept {
  const auto planes = solver_.planes();
  if (place.same)
    return std::ranges::any_of(planes,
                               [&](const HoldPlane& plane) { return glm::length(plane.place - place.contact.at) < kStillSame * edge_; });
  const auto plane = std::ranges::find(planes, place.point, &HoldPlane::point);
  const bool kept = plane != planes.end();
  if (!kept) {
    place.same = std::ranges::any_of(planes, [&](const HoldPlane& p) { return glm::length(p.place - place.contact.at) < kSame * edge_; });
    // Farther from bone than the tool moves between two far probes: the next one will do.
    if (place.same || (!far && place.contact.gap > kNotYet * edge_)) return true;
  }
  auto found = finder.sample(kept ? plane->place : place.contact.at);
  if (!found || found->gap > kKnown * edge_) return false;
  // A kept plane follows the contact by itself.
  if (!kept && found->gap < kFollowed * edge_) {
    const auto contact = finder.settle(*found);
    const double most = kBeyondCell * cells_.radius(place.point) * edge_;
    if (contact && glm::length(contact->at - found->at) < edge_ && glm::length(contact->at - shell_.positions[place.point]) <= most)
      if (const auto there = finder.sample(contact->at); there && there->gap < found->gap) found = there;
  }
  place.contact = *found;
  place.settled = false;
  return true;
}

std::uint32_t ConstrainedTool::nearest_hit(const Vec3& place, std::uint32_t point) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < hits_.count; ++n) {
    const Vec3 off = shell_.positions[hits_.point[n]] - place;
    if (const double distance2 = glm::dot(off, off); distance2 < least) {
      least = distance2;
      point = hits_.point[n];
    }
  }
  return point;
}

bool ConstrainedTool::settle_kept(const SurfaceView& bone, const PlaceFinder& finder, HoldPlane& plane) noexcept {
  const std::uint32_t before = plane.point;
  if (!settle(bone, finder, plane)) return false;
  const double most = kBeyondCell * cells_.radius(plane.point) * edge_;
  if (glm::length(plane.place - shell_.positions[plane.point]) > most) {
    plane.point = nearest_hit(plane.place, plane.point);
    // The contact has moved to the cell of another point, which may have a plane.
    if (plane.point != before && std::ranges::count(solver_.planes(), plane.point, &HoldPlane::point) > 0) return false;
  }
  for (SearchedPlaces::Place& place : searched_.list()) {
    if (place.point != plane.point) continue;
    place.contact = {plane.place, plane.normal, plane.gap, 0.0};
    place.settled = true;
  }
  return true;
}

}  // namespace burrhole
