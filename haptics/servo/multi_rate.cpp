#include "haptics/servo/multi_rate.h"

#include <algorithm>

#include "core/base/rotation.h"

namespace burrhole {
namespace {

constexpr double kLongestTurn = 0.1;  // [rad] of the hand since the sample: planes turn in first order only, 5e-3 of a lever is left out

Vec3 bounded(const Vec3& v, double longest) noexcept {
  const double length = glm::length(v);
  return length > longest ? v * (longest / length) : v;
}

/// The hand, no further from where it was sampled than the planes are good for.
Pose near_sample(const Pose& sampled, const Pose& now, const Vec3& moved) noexcept {
  const Vec3 turn = rotation_vector(now.rotation * glm::conjugate(sampled.rotation));
  if (glm::length(turn) <= kLongestTurn) return {now.rotation, sampled.translation + moved};
  return {glm::normalize(rotation_of(bounded(turn, kLongestTurn)) * sampled.rotation), sampled.translation + moved};
}

/// [AcostaLiu07] eq. (3); of the result nothing pulls against the force that was sampled.
Wrench along_gradient(const ContactState& latest, const Vec3& moved) noexcept {
  const Vec3& sampled = latest.on_hand.force;
  const double square = glm::dot(sampled, sampled);
  if (square == 0.0) return latest.on_hand;  // which way bone pushes is not known
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
  number_ = 0;
  ticks_ = 0;
  from_ = shown_ = {};
  tool_.clear();
}

Wrench MultiRate::between(const Wrench& latest, bool renewed) noexcept {
  if (renewed) {
    from_ = shown_;
    ticks_ = 0;
  }
  ++ticks_;
  if (ticks_ >= config_.contact_ticks) {
    ticks_ = config_.contact_ticks;
    shown_ = latest;  // to the bit
  } else {
    const double part = static_cast<double>(ticks_) / static_cast<double>(config_.contact_ticks);
    shown_ = {from_.force + (latest.force - from_.force) * part, from_.torque + (latest.torque - from_.torque) * part};
  }
  return shown_;
}

Wrench MultiRate::pressed_on(const ContactState& latest, const Pose& hand, const Vec3& velocity, bool renewed, double dt) noexcept {
  if (renewed) tool_.renew(latest, config_.max_distance);
  return tool_.step(latest, hand, velocity, dt);
}

Wrench MultiRate::extrapolate(const ContactState& latest, const HandState& hand, bool renewed, double dt) noexcept {
  const LocalContact& local = latest.local;
  const Pose& sampled = latest.world_from_hand;
  const Vec3 moved = bounded(hand.world_from_hand.translation - sampled.translation, config_.max_distance);
  const bool with_untouched = config_.scheme == MultiRateScheme::planes;
  if (with_untouched && local.kind == LocalKind::coupled) {
    const Wrench on_hand = pressed_on(latest, near_sample(sampled, hand.world_from_hand, moved), hand.velocity, renewed, dt);
    if (local.count > 0) return on_hand;
  } else {
    tool_.clear();  // it would come back from long ago
  }
  if (local.kind == LocalKind::none || local.count == 0) return along_gradient(latest, moved);
  if (renewed) {
    if (local.kind == LocalKind::penalty)
      loads_.set_penalty(local, with_untouched);
    else
      loads_.set_coupled(local);
  }
  return loads_.extrapolate(latest.on_hand, moved);
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
