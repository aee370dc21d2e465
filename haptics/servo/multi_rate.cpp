#include "haptics/servo/multi_rate.h"

#include <algorithm>

#include "core/base/rotation.h"

namespace burrhole {
namespace {

constexpr std::size_t kRemembered = 8;  // contact periods, and ticks: results that are older are stale long since (contact_age.h)
constexpr double kLongestTurn = 0.1;    // [rad] turn of the hand since the sample: planes turn to first order; the error is 5e-3 of a lever

Vec3 bounded(const Vec3& v, double longest) noexcept {
  const double length = glm::length(v);
  return length > longest ? v * (longest / length) : v;
}

/// The pose of the hand, limited to the range in which the planes are valid.
Pose near_sample(const Pose& sampled, const Pose& now, const Vec3& moved) noexcept {
  const Vec3 turn = rotation_vector(now.rotation * glm::conjugate(sampled.rotation));
  if (glm::length(turn) <= kLongestTurn) return {now.rotation, sampled.translation + moved};
  return {glm::normalize(rotation_of(bounded(turn, kLongestTurn)) * sampled.rotation), sampled.translation + moved};
}

/// [AcostaLiu07] eq. (3). The result has no component opposite to the sampled force.
Wrench along_gradient(const ContactState& latest, const Vec3& moved) noexcept {
  const Vec3& sampled = latest.on_hand.force;
  const double square = glm::dot(sampled, sampled);
  if (square == 0.0) return latest.on_hand;  // no force at the sample: the direction of the contact is unknown
  Vec3 force = sampled + latest.force_gradient * moved;
  const double along = glm::dot(force, sampled);
  if (along < 0.0) force -= sampled * (along / square);
  return {force, latest.on_hand.torque};
}

}  // namespace

const char* name_of(MultiRateScheme scheme) noexcept {
  switch (scheme) {
    case MultiRateScheme::hold:
      return "hold";
    case MultiRateScheme::linear:
      return "linear";
    case MultiRateScheme::gradient:
      return "gradient";
    case MultiRateScheme::planes:
      return "planes";
  }
  return "unknown";
}

void MultiRate::clear() noexcept {
  number_ = followed_ = 0;
  ticks_ = 0;
  from_ = shown_ = {};
  tool_.clear();
  trail_.clear();
  spring_.clear();
  if (law_ != nullptr) law_->clear();
}

void MultiRate::use_tangential_law(TangentialLaw* law) {
  law_ = law;
  trail_.resize(kRemembered * static_cast<std::size_t>(std::max(1, config_.contact_ticks)) + kRemembered);
  clear();
}

Wrench MultiRate::between(const Wrench& latest, bool renewed) noexcept {
  if (renewed) {
    from_ = shown_;
    ticks_ = 0;
  }
  ++ticks_;
  if (ticks_ >= config_.contact_ticks) {
    ticks_ = config_.contact_ticks;
    shown_ = latest;  // same bits
  } else {
    const double part = static_cast<double>(ticks_) / static_cast<double>(config_.contact_ticks);
    shown_ = {from_.force + (latest.force - from_.force) * part, from_.torque + (latest.torque - from_.torque) * part};
  }
  return shown_;
}

void MultiRate::follow(const ContactState& latest) noexcept {
  if (followed_ == latest.number) return;
  const auto drift = trail_.drift(latest);
  if (!drift) return;
  followed_ = latest.number;
  trail_.shift(latest.tick, *drift);
  tool_.place(ToolTrail::moved(tool_.world_from_tool(), *drift));
}

Wrench MultiRate::pressed_on(const ContactState& latest, const Pose& near, const HandState& hand, double dt) noexcept {
  if (law_ == nullptr) return tool_.step(latest, near, hand.velocity, dt);
  follow(latest);  // a result of an earlier tick
  const Wrench on_hand = tool_.step(latest, near, hand.velocity, dt, law_);
  trail_.add(hand.tick, tool_.world_from_tool());
  follow(latest);  // a result of this tick
  return on_hand;
}

Wrench MultiRate::extrapolate(const ContactState& latest, const HandState& hand, bool renewed, double dt) noexcept {
  const LocalContact& local = latest.local;
  const Pose& sampled = latest.world_from_hand;
  const Vec3 moved = bounded(hand.world_from_hand.translation - sampled.translation, config_.max_distance);
  const bool with_untouched = config_.scheme == MultiRateScheme::planes;
  if (with_untouched && local.kind == LocalKind::coupled) {
    holds_tool_ = true;
    if (renewed) tool_.renew(latest, config_.max_distance);
    const Wrench on_hand = pressed_on(latest, near_sample(sampled, hand.world_from_hand, moved), hand, dt);
    if (local.count > 0) return on_hand;
  } else if (holds_tool_) {
    holds_tool_ = false;
    tool_.clear();  // its pose would be out of date
    trail_.clear();
  }
  if (local.kind == LocalKind::none || local.count == 0) return along_gradient(latest, moved);
  if (renewed) {
    if (local.kind == LocalKind::penalty)
      loads_.set_penalty(local, with_untouched);
    else
      loads_.set_coupled(local);
  }
  if (law_ != nullptr) return extrapolate_loads(latest, near_sample(sampled, hand.world_from_hand, moved), moved, dt);
  return loads_.extrapolate(latest.on_hand, moved);
}

Wrench MultiRate::extrapolate_loads(const ContactState& latest, const Pose& hand, const Vec3& moved, double dt) noexcept {
  const LocalContact& local = latest.local;
  const bool penalty = local.kind == LocalKind::penalty;
  const TangentialSpringConfig config = penalty ? TangentialSpringConfig{local.tangential_stiffness, local.tangential_turn_stiffness}
                                                : TangentialSpringConfig{local.coupling_stiffness, local.turn_stiffness};
  // For a coupled contact, uses the loads of the planes: on_hand is the coupling's force and includes tangential loads and the tool's
  // inertia.
  const Wrench& all = latest.on_hand;
  const Wrench sampled = penalty ? Wrench{all.force - local.tangential.force, all.torque - local.tangential.torque} : loads_.at_sample();
  const Wrench normal = loads_.extrapolate(sampled, moved);
  std::array<PressedPoint, kMaxLocalPlanes> points;
  const std::size_t count = config.stiffness > 0.0 ? loads_.pressed(moved, points) : 0;
  const Wrench load = spring_.step(*law_, config, {points.data(), count}, hand, local.spin, dt);
  return {normal.force + load.force, normal.torque + load.torque};
}

Wrench MultiRate::operator()(const ContactState& latest, const HandState& hand, double dt) noexcept {
  const bool renewed = latest.number != number_;
  number_ = latest.number;
  if (config_.scheme == MultiRateScheme::hold || latest.number == 0) {
    shown_ = latest.on_hand;
    return latest.on_hand;
  }
  return config_.scheme == MultiRateScheme::linear ? between(latest.on_hand, renewed) : extrapolate(latest, hand, renewed, dt);
}

}  // namespace burrhole
