#include "core/contact/tool_candidates.h"

#include <algorithm>

namespace burrhole {
namespace {

constexpr double kSamePlace = 0.35;    // [voxel edges] places nearer to each other than this, with like normals, are one contact
constexpr double kSameNormal = 0.996;  // [-] cosine of 5 degrees

}  // namespace

ConstrainedTool::Candidates::Candidates(ConstrainedTool& tool, const SurfaceView& bone, bool spinning) noexcept
    : tool_(&tool),
      bone_(&bone),
      spinning_(spinning),
      axes_(glm::mat3_cast(tool.bone_from_tool_.rotation)),
      finder_(tool.surface_.get(), bone.records, tool.bone_from_tool_) {}

PointMotion ConstrainedTool::Candidates::motion(const HoldMove& move, const Vec3& shift) const noexcept {
  PointMotion out;
  for (std::size_t c = 0; c < 3; ++c) out.linear[c] = glm::cross(move.turn, axes_[c]) / tool_->edge_;
  out.offset = (move.translation + shift + glm::cross(move.turn, axes_ * tool_->middle_)) / tool_->edge_;
  return out;
}

std::optional<WorstHit> ConstrainedTool::Candidates::worst_hit(const HoldProblem& problem, const HoldMove& move) const noexcept {
  const ProbeHits& hits = tool_->hits_;
  std::optional<WorstHit> worst;
  const auto consider = [&](std::size_t first, std::size_t last, const Vec3& shift) {
    // Slightly more than the tolerance: the decision is made in double precision below.
    const float limit = worst ? worst->distance : static_cast<float>(-0.99 * problem.tolerance / tool_->edge_);
    if (const auto found = find_worst(hits, first, last, motion(move, shift), limit)) worst = found;
  };
  consider(0, tool_->cutting_hits_, spinning_ ? move.engagement - problem.engaged : Vec3(0.0));
  consider(tool_->cutting_hits_, hits.count, Vec3(0.0));
  if (!worst || static_cast<double>(worst->distance) * tool_->edge_ > -problem.tolerance) return std::nullopt;
  return worst;
}

double ConstrainedTool::Candidates::after(const ContactPlace& place, const HoldMove& move) const noexcept {
  return place.gap + glm::dot(place.normal, move.translation + glm::cross(move.turn, axes_ * place.at));
}

bool ConstrainedTool::Candidates::same_place(const HoldPlane& plane, const ContactPlace& place) const noexcept {
  return glm::length(plane.place - place.at) < kSamePlace * tool_->edge_ && glm::dot(plane.normal, place.normal) > kSameNormal;
}

SearchedPlaces::Place* ConstrainedTool::Candidates::worst_place(const HoldProblem& problem, const HoldMove& move,
                                                                std::span<const HoldPlane> kept) noexcept {
  SearchedPlaces::Place* worst = nullptr;
  double least = -problem.tolerance;
  for (SearchedPlaces::Place& place : tool_->searched_.list()) {
    if (place.same) continue;
    const double gap = after(place.contact, move);
    if (gap >= least) continue;
    if (std::ranges::any_of(kept, [&](const HoldPlane& plane) { return plane.point == place.point || same_place(plane, place.contact); }))
      continue;
    least = gap;
    worst = &place;
  }
  return worst;
}

std::optional<HoldPlane> ConstrainedTool::Candidates::most_violated(const HoldProblem& problem, const HoldMove& move,
                                                                    std::span<const HoldPlane> kept) noexcept {
  unmask_dropped(kept);
  mask_kept(kept);
  if (!tool_->follows_surface(spinning_)) {
    const auto worst = worst_hit(problem, move);
    return worst ? std::optional(plane_of(worst->hit)) : std::nullopt;
  }
  // Each round searches a hit or settles a place, and a settled place is not settled again.
  for (std::size_t round = 0; round < 2 * SearchedPlaces::kMost; ++round) {
    SearchedPlaces::Place* const place = worst_place(problem, move, kept);
    const double known = place != nullptr ? after(place->contact, move) : 0.0;
    const auto worst = worst_hit(problem, move);
    if (worst && static_cast<double>(worst->distance) * tool_->edge_ < known) {
      if (!search(worst->hit)) return plane_of(worst->hit);
      continue;
    }
    if (place == nullptr) return std::nullopt;
    const HoldPlane plane = plane_at(*place);
    if (after(place->contact, move) < -problem.tolerance) return plane;
  }
  return std::nullopt;
}

bool ConstrainedTool::Candidates::search(std::size_t hit) noexcept {
  const ProbeHits& hits = tool_->hits_;
  const std::uint32_t point = hits.point[hit];
  const Vec3& home = tool_->shell_.positions[point];
  const auto found =
      hits.lower[hit] < hits.distance[hit] ? finder_.search(home, tool_->cells_.radius(point) * tool_->edge_) : finder_.sample(home);
  if (!found) return false;
  const bool same = std::ranges::any_of(tool_->solver_.planes(), [&](const HoldPlane& plane) { return same_place(plane, *found); });
  if (!tool_->searched_.add({.point = point, .same = same, .settled = false, .contact = *found})) return false;
  tool_->hits_.lower[hit] = kHidden;
  return true;
}

HoldPlane ConstrainedTool::Candidates::plane_at(SearchedPlaces::Place& place) const noexcept {
  HoldPlane plane;
  plane.point = place.point;
  plane.place = place.contact.at;
  if (!place.settled && tool_->settle(*bone_, finder_, plane)) {
    place.contact = {plane.place, plane.normal, plane.gap, place.contact.bend};
  } else {
    plane.arm = axes_ * plane.place;
    plane.normal = place.contact.normal;
    plane.gap = place.contact.gap;
    plane.yield = tool_->yield_of(*bone_, plane, tool_->bone_from_tool_.translation + plane.arm);
  }
  place.settled = true;
  return plane;
}

HoldPlane ConstrainedTool::Candidates::plane_of(std::size_t hit) const noexcept {
  const ProbeHits& hits = tool_->hits_;
  HoldPlane plane;
  plane.point = hits.point[hit];
  plane.place = tool_->shell_.positions[plane.point];
  plane.arm = axes_ * tool_->cleared(plane.point);
  plane.normal = Vec3(static_cast<double>(hits.nx[hit]), static_cast<double>(hits.ny[hit]), static_cast<double>(hits.nz[hit]));
  const double length = glm::length(plane.normal);
  // Where bone has no normal (deep inside, noise at one level) the tool's own outward direction replaces it.
  plane.normal = length > 0.1 ? plane.normal / length : axes_ * tool_->shell_.inward_normals[plane.point];
  plane.gap = static_cast<double>(hits.distance[hit]) * tool_->edge_;
  plane.cutting = spinning_ && hit < tool_->cutting_hits_;
  const Vec3 position = tool_->bone_from_tool_.translation + plane.arm + (plane.cutting ? tool_->engaged_ : Vec3(0.0));
  plane.normal =
      plane.cutting ? tool_->cutting_normal(plane.point, plane.normal) : tool_->direction(*bone_, plane, position, plane.normal, spinning_);
  plane.yield = tool_->yield_of(*bone_, plane, position);
  return plane;
}

void ConstrainedTool::Candidates::mask_kept(std::span<const HoldPlane> kept) noexcept {
  const ProbeHits& hits = tool_->hits_;
  for (const HoldPlane& plane : kept) {
    const std::size_t hit = tool_->places_.find(hits, plane.point);
    if (hit == hits.count || distances()[hit] == kHidden) continue;
    hidden_[masked_++] = {hit, distances()[hit]};
    distances()[hit] = kHidden;
  }
}

void ConstrainedTool::Candidates::unmask_dropped(std::span<const HoldPlane> kept) noexcept {
  std::size_t left = 0;
  for (std::size_t n = 0; n < masked_; ++n) {
    if (std::ranges::find(kept, tool_->hits_.point[hidden_[n].hit], &HoldPlane::point) != kept.end())
      hidden_[left++] = hidden_[n];
    else
      restore(n);
  }
  masked_ = left;
}

}  // namespace burrhole
