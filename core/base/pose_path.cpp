#include "core/base/pose_path.h"

#include <algorithm>

#include "core/base/rotation.h"

namespace burrhole {
namespace {

constexpr double kSameAxis = 1e-9;  // [-] difference of unit vectors that are read from decimal numbers

Quat rotation_at(const PoseKey& key) noexcept { return rotation_of(key.axis * key.angle); }

bool share_axis(const PoseKey& a, const PoseKey& b) noexcept {
  return a.angle == 0.0 || b.angle == 0.0 || glm::length(a.axis - b.axis) < kSameAxis;
}

}  // namespace

Result<PosePath> PosePath::create(std::vector<PoseKey> keys) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  for (std::size_t n = 0; n < keys.size(); ++n) {
    PoseKey& key = keys[n];
    if (!std::isfinite(key.time) || !is_finite(key.translation) || !is_finite(key.axis) || !std::isfinite(key.angle))
      return refuse("a keyframe is not finite");
    const double length = glm::length(key.axis);
    if (!(length > 0.0)) return refuse("the axis of a keyframe has no length");
    key.axis /= length;
    if (n > 0 && !(key.time > keys[n - 1].time)) return refuse("the times of keyframes must increase");
  }
  PosePath out;
  out.keys_ = std::move(keys);
  return out;
}

Displacement PosePath::at(double time) const noexcept {
  if (keys_.empty()) return {};
  const auto after = std::upper_bound(keys_.begin(), keys_.end(), time, [](double t, const PoseKey& key) { return t < key.time; });
  if (after == keys_.begin() || after == keys_.end()) {
    const PoseKey& key = after == keys_.end() ? keys_.back() : keys_.front();
    return {.translation = key.translation, .rotation = rotation_at(key)};
  }
  const PoseKey &from = *(after - 1), &to = *after;
  const double duration = to.time - from.time, share = (time - from.time) / duration;
  Displacement out{.translation = from.translation + (to.translation - from.translation) * share,
                   .velocity = (to.translation - from.translation) / duration};
  const Quat start = rotation_at(from);
  const Vec3 turn = share_axis(from, to) ? (from.angle == 0.0 ? to.axis : from.axis) * (to.angle - from.angle)
                                         : rotation_vector(rotation_at(to) * glm::conjugate(start));
  out.rotation = glm::normalize(rotation_of(turn * share) * start);
  out.angular_velocity = turn / duration;
  return out;
}

}  // namespace burrhole
