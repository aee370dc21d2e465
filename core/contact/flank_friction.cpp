#include "core/contact/flank_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/portable_math.h"
#include "core/contact/flank_sums.h"

namespace burrhole {
namespace {

constexpr double kLeastEngaged = 1e-7;   // [m] smaller values are rounding of a tool that only touches
constexpr double kLeastStiffness = 1.0;  // [N/m] a lower value is imperceptible, and its inverse would dominate the other planes
constexpr double kLargestShare = 0.5;    // [-] of the thrust: largest lateral force of flanks
constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max() - 2;  // beyond every shell point

Vec3 across(const Vec3& v, const Vec3& push) noexcept { return v - push * glm::dot(v, push); }

}  // namespace

void FlankFriction::clear() noexcept {
  stiffness_ = {};
  aside_ = Vec3(0.0);
  to_cut_ = 0.0;
}

void FlankFriction::look(const ProbeHits& inside, const PointShell& shell, const Pose& bone_from_tool, const Vec3& engaged,
                         double stiffness) noexcept {
  stiffness_ = {};
  const double depth = glm::length(engaged);
  if (depth < kLeastEngaged) return clear();
  push_ = engaged / depth;
  const Vec3 u = glm::normalize(glm::cross(push_, std::abs(push_.x) < 0.7 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0)));
  const Vec3 v = glm::cross(push_, u);
  // Summed in the tool frame, the frame of the points.
  const Quat tool_from_bone = glm::conjugate(bone_from_tool.rotation);
  const Vec3 push = tool_from_bone * push_, tool_u = tool_from_bone * u, tool_v = tool_from_bone * v;
  const FlankSums sums = sum_flanks(inside, shell, {push, tool_u, tool_v}, kLeastFacing);
  if (sums.along <= 0.0) return clear();
  arm_ = sums.middle / sums.along;
  const Vec3 off = across(arm_, push);
  half_width_ =
      std::sqrt(std::max(0.0, 2.0 * (sums.spread / sums.along - glm::dot(off, off))));  // for a disc the mean square radius is half of R^2
  const double mean = 0.5 * (sums.uu + sums.vv), skew = 0.5 * (sums.uu - sums.vv), apart = std::sqrt(skew * skew + sums.uv * sums.uv);
  const double angle = 0.5 * portable_atan2(sums.uv, skew), cosine = portable_cos(angle), sine = portable_sin(angle);
  axes_ = {u * cosine + v * sine, v * cosine - u * sine};
  stiffness_ = {stiffness * (mean + apart) / (2.0 * sums.along), stiffness * (mean - apart) / (2.0 * sums.along)};
  start_ = bone_from_tool * arm_;
  engaged_ = engaged;
  aside_ = across(aside_, push_);
}

Vec3 FlankFriction::aside_at(const Pose& bone_from_tool) const noexcept { return across(aside_ + bone_from_tool * arm_ - start_, push_); }

bool FlankFriction::left(const Pose& bone_from_tool) const noexcept {
  return std::abs(glm::dot(bone_from_tool * arm_ - start_, push_)) > glm::length(engaged_);
}

std::array<HoldPlane, 2> FlankFriction::planes(const Pose& bone_from_tool) const noexcept {
  std::array<HoldPlane, 2> out;
  if (left(bone_from_tool)) return out;
  const Vec3 aside = aside_at(bone_from_tool);
  for (std::size_t n = 0; n < 2; ++n) {
    out[n].normal = axes_[n];
    out[n].arm = bone_from_tool.rotate(arm_);
    out[n].gap = glm::dot(axes_[n], aside);
    out[n].yield = stiffness_[n] >= kLeastStiffness ? 1.0 / stiffness_[n] : 0.0;
    out[n].both_ways = true;
    out[n].point = kNoPoint + static_cast<std::uint32_t>(n);
  }
  return out;
}

void FlankFriction::settle(const Pose& bone_from_tool, const Vec3& engaged, double thrust) noexcept {
  if (stiffness_[0] < kLeastStiffness || left(bone_from_tool)) return clear();
  const Vec3 moved = bone_from_tool * arm_ - start_;
  aside_ = aside_at(bone_from_tool);
  // The pose without engagement follows the surface: its motion against the push is what was cut. Reciprocating motion cuts nothing.
  const double depth = std::max(glm::dot(engaged, push_), kLeastEngaged);
  to_cut_ = std::max(to_cut_ - glm::dot(moved + engaged - engaged_, push_), -depth);
  if (to_cut_ > 0.0) {
    aside_ *= std::max(0.0, 1.0 - to_cut_ / depth);
    to_cut_ = 0.0;
  }
  const double far = glm::length(aside_);
  const Vec3 force = axes_[0] * (stiffness_[0] * glm::dot(axes_[0], aside_)) + axes_[1] * (stiffness_[1] * glm::dot(axes_[1], aside_));
  const double most = kLargestShare * thrust, felt = glm::length(force);
  aside_ *= std::min({1.0, far > half_width_ ? half_width_ / far : 1.0, felt > most ? most / felt : 1.0});
}

}  // namespace burrhole
