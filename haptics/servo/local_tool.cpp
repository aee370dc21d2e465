#include "haptics/servo/local_tool.h"

#include <algorithm>
#include <cmath>

#include "core/base/rotation.h"

namespace burrhole {
namespace {

// [m] tolerance of the planes. A plane starts to carry load with at most the effective stiffness times this: 5 to 60 kN/m (coupling and
// damper over a tick) give 6e-5 N.
constexpr double kTolerance = 1e-9;
constexpr int kMostRounds = 5;  // bounds the cost of a tick; one to three are usual

/// [m] Gap of a plane after a move, without the compliance of bone.
double gap_after(const HoldProblem& problem, const HoldPlane& plane, const HoldMove& move) noexcept {
  const Vec3 engaging = plane.cutting ? move.engagement - problem.engaged : Vec3(0.0);
  return plane.gap + glm::dot(plane.normal, move.translation + glm::cross(move.turn, plane.arm) + engaging);
}

/// The listed planes as candidates; returns the most violated one.
class ListedPlanes final : public HoldCandidates {
 public:
  explicit ListedPlanes(std::span<const HoldPlane> planes) : planes_(planes) {}

  std::optional<HoldPlane> most_violated(const HoldProblem& problem, const HoldMove& move,
                                         std::span<const HoldPlane> kept) noexcept override {
    const HoldPlane* worst = nullptr;
    double least = -problem.tolerance;
    for (const HoldPlane& plane : planes_) {
      const double gap = gap_after(problem, plane, move);
      if (!(gap < least) || std::ranges::find(kept, plane.point, &HoldPlane::point) != kept.end()) continue;
      worst = &plane;
      least = gap;
    }
    return worst != nullptr ? std::optional(*worst) : std::nullopt;
  }

 private:
  std::span<const HoldPlane> planes_;
};

/// The equilibrium of springs and dampers without contact, and their total stiffness: the formula of ConstrainedTool, over a servo tick.
struct CouplingTarget {
  Pose world_from_target;
  double stiffness, turn_stiffness;
};

struct HandNow {
  const Pose& pose;
  const Vec3& velocity;
  const Quat& rotation_before;
};

CouplingTarget coupling_target(const LocalContact& local, const Pose& before, const HandNow& hand, double dt) noexcept {
  const double damping = local.coupling_damping / dt;
  CouplingTarget coupling;
  coupling.stiffness = local.coupling_stiffness + damping;
  // K (h - t) + B (h' - (t - t_before) / dt) is zero at the target.
  coupling.world_from_target.translation =
      (local.coupling_stiffness * hand.pose.translation + damping * (before.translation + hand.velocity * dt)) / coupling.stiffness;
  const double share = local.coupling_stiffness / coupling.stiffness;
  coupling.turn_stiffness = local.turn_stiffness / share;
  const Vec3 whole = rotation_vector(hand.pose.rotation * glm::conjugate(before.rotation));
  const Vec3 hands = rotation_vector(hand.pose.rotation * glm::conjugate(hand.rotation_before));
  const Vec3 turn = std::isinf(local.turn_stiffness) ? whole : share * whole + (1.0 - share) * hands;
  coupling.world_from_target.rotation = glm::normalize(rotation_of(turn) * before.rotation);
  return coupling;
}

}  // namespace

void LocalTool::clear() noexcept {
  placed_ = false;
  solver_.clear();
  tangential_.clear();
}

void LocalTool::renew(const ContactState& state, double max_distance) noexcept {
  const LocalContact& local = state.local;
  if (!placed_) {
    world_from_tool_ = state.world_from_tool;
    hand_before_ = state.world_from_hand.rotation;
    placed_ = true;
  }
  const Vec3 apart = world_from_tool_.translation - state.world_from_tool.translation;
  const double distance = glm::length(apart);
  if (!(distance <= max_distance)) world_from_tool_.translation = state.world_from_tool.translation + apart * (max_distance / distance);
  // A new plane starts with the load of the old plane of the same point.
  solver_.refresh([&](HoldPlane& plane) {
    const auto listed = std::ranges::find(local.list(), plane.point, &HoldPlane::point);
    if (plane.both_ways || listed == local.list().end() || listed->both_ways) return false;
    const double force = plane.force;
    plane = *listed;
    plane.force = force;
    return true;
  });
  // What carries load for contact is likely to carry it here: found one by one, each of those would take a round.
  for (const HoldPlane& plane : local.list()) {
    const bool fits = solver_.planes().size() < kMaxHoldPlanes;
    const bool kept = std::ranges::find(solver_.planes(), plane.point, &HoldPlane::point) != solver_.planes().end();
    if (plane.both_ways || (plane.force > 0.0 && fits && !kept)) solver_.add(plane);
  }
}

Wrench LocalTool::step(const ContactState& state, const Pose& world_from_hand, const Vec3& velocity, double dt,
                       TangentialLaw* law) noexcept {
  const LocalContact& local = state.local;
  const Pose& sampled = state.world_from_tool;
  const CouplingTarget coupling = coupling_target(local, world_from_tool_, {world_from_hand, velocity, hand_before_}, dt);
  hand_before_ = world_from_hand.rotation;
  ListedPlanes candidates(local.list());
  const HoldProblem problem{.target = coupling.world_from_target.translation - sampled.translation,
                            .turn = rotation_vector(coupling.world_from_target.rotation * glm::conjugate(sampled.rotation)),
                            .engaged = local.engaged,
                            .stiffness = coupling.stiffness,
                            .turn_stiffness = coupling.turn_stiffness,
                            .cutting_stiffness = local.cutting_stiffness > 0.0 ? local.cutting_stiffness : coupling.stiffness,
                            .tolerance = kTolerance};
  HoldMove move;
  if (law == nullptr) {
    move = solver_.solve(problem, candidates);
  } else {
    // Gaps refer to the sample; the step of the law starts at the current pose of the tool.
    const SmallMove start{sampled.translation - world_from_tool_.translation,
                          rotation_vector(sampled.rotation * glm::conjugate(world_from_tool_.rotation))};
    move =
        tangential_.solve(*law, {.moved = start, .spin = local.spin, .dt = dt, .most_rounds = kMostRounds}, problem, candidates, solver_);
    law->end_step({start.translation + move.translation, start.turn + move.turn});
  }
  world_from_tool_.translation = sampled.translation + move.translation;
  world_from_tool_.rotation = glm::normalize(rotation_of(move.turn) * sampled.rotation);
  Wrench on_hand;
  for (const HoldPlane& plane : solver_.planes()) {
    on_hand.force += plane.normal * plane.force;
    on_hand.torque += glm::cross(plane.arm, plane.normal * plane.force);
  }
  if (law != nullptr) {
    on_hand.force += tangential_.on_tool().force;
    on_hand.torque += tangential_.on_tool().torque;
  }
  return on_hand;
}

}  // namespace burrhole
