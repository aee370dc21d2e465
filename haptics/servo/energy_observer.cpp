#include "haptics/servo/energy_observer.h"

#include <algorithm>

namespace burrhole {

void EnergyObserver::operator()(const Vec3& position, const Vec3& velocity, const Vec3& latest) noexcept {
  newest_ = (newest_ + 1) % held_.size();
  held_[newest_] = latest;
  const Vec3& held = held_[(newest_ + held_.size() - static_cast<std::size_t>(config_.delay)) % held_.size()];
  if (started_) {
    const Vec3 moved = position - position_;
    const double square = (glm::dot(velocity_, velocity_) + glm::dot(velocity_, velocity) + glm::dot(velocity, velocity)) / 3.0;
    if (held == Vec3(0.0)) energy_ = std::min(energy_, 0.0);
    energy_ += config_.damping * square * dt_ - glm::dot(held, moved);
    mean_velocity_ = moved / dt_;
  }
  started_ = true;
  position_ = position;
  velocity_ = velocity;
}

Vec3 EnergyObserver::damping_force() const noexcept {
  const double square = glm::dot(mean_velocity_, mean_velocity_);
  if (!(config_.largest_damping > 0.0) || !(energy_ < 0.0) || square == 0.0) return Vec3(0.0);
  return -mean_velocity_ * std::min(config_.largest_damping, -energy_ / (dt_ * square));
}

void EnergyObserver::clear() noexcept {
  started_ = false;
  mean_velocity_ = Vec3(0.0);
  energy_ = 0.0;
  held_.fill(Vec3(0.0));
}

}  // namespace burrhole
