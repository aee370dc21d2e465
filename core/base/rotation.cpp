#include "core/base/rotation.h"

#include <algorithm>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr double kShort = 1e-12;  // [rad] below this angle, sine and angle are equal to within rounding
constexpr double kLongest = 1e6;  // [rad] range in which portable_sin is accurate

}  // namespace

Vec3 rotation_vector(const Quat& q) noexcept {
  const Quat near = q.w < 0.0 ? -q : q;
  const Vec3 v(near.x, near.y, near.z);
  const double s = glm::length(v);
  return s < kShort ? 2.0 * v : v * (2.0 * portable_atan2(s, near.w) / s);
}

Quat rotation_of(const Vec3& vector) noexcept {
  const double length = glm::length(vector);
  if (length < kShort) return glm::normalize(Quat(1.0, 0.5 * vector.x, 0.5 * vector.y, 0.5 * vector.z));
  const double half = 0.5 * std::min(length, kLongest);
  const Vec3 v = vector * (portable_sin(half) / length);
  return glm::normalize(Quat(portable_cos(half), v.x, v.y, v.z));
}

}  // namespace burrhole
