#include "core/contact/lens_shell.h"

#include <algorithm>
#include <cmath>

#include "core/contact/rounded_edges.h"

namespace burrhole {
namespace {

constexpr double kClearance = 0.25;  // [voxel edges] c, at most; error of interpolated distances near the rim of a hole
constexpr double kShare = 0.3;       // [-] of the engagement, at most: points of the leading face stay
constexpr double kEdgeRadius = 1.5;  // [voxel edges] floors are read too high up to a voxel from the wall
constexpr std::size_t kProbes = 7;   // distance and central differences

}  // namespace

LensShell::LensShell(const PointShell& shell, std::shared_ptr<const CuttingField> field, double voxel_edge)
    : field_(field != nullptr && !field->empty() ? std::move(field) : nullptr),
      edge_(voxel_edge),
      original_(shell.positions),
      position_(shell.positions),
      edges_(shell.size(), Vec3(0.0)) {
  if (!active()) return;
  edges_ = rounded_edges(shell, kEdgeRadius * voxel_edge);
  job_ = field_job(*field_);
  for (std::uint32_t n = 0; n < shell.size(); ++n)
    if (shell.cutting[n] != 0) cutting_.push_back(n);
  const std::size_t room = kProbes * cutting_.size() + kFieldPad;
  for (std::vector<float>* list : {&x_, &y_, &z_, &distance_}) list->resize(room);
  moved_.reserve(cutting_.size());
}

void LensShell::engage(const Vec3& engagement) noexcept {
  const double engaged = glm::length(engagement), clearance = std::min(kClearance * edge_, kShare * engaged);
  const double rounding = std::min(1.0, engaged / (kClearance * edge_));
  const auto put = [&](std::size_t n, const Vec3& p) {
    const Vec3f q((p - field_->origin) / field_->pitch);
    x_[n] = q.x, y_[n] = q.y, z_[n] = q.z;
  };
  for (std::size_t n = 0; n < cutting_.size(); ++n) {
    position_[cutting_[n]] = original_[cutting_[n]] + edges_[cutting_[n]] * rounding;
    put(n, position_[cutting_[n]] + engagement);
  }
  if (engaged == 0.0) return;
  sample_field(job_, {cutting_.size(), x_.data(), y_.data(), z_.data()}, distance_.data());
  moved_.clear();
  for (std::size_t n = 0; n < cutting_.size(); ++n)
    if (static_cast<double>(distance_[n]) > -clearance) moved_.push_back(cutting_[n]);
  // Twice: the gradient is that of the point, which may lie beyond an edge of the tool.
  for (int round = 0; round < 2; ++round) {
    for (std::size_t n = 0; n < moved_.size(); ++n) {
      const Vec3 q = position_[moved_[n]] + engagement;
      put(kProbes * n, q);
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t side = 0; side < 2; ++side) {
          Vec3 beside = q;
          beside[axis] += (side == 0 ? 1.0 : -1.0) * field_->pitch;
          put(kProbes * n + 1 + 2 * axis + side, beside);
        }
    }
    sample_field(job_, {kProbes * moved_.size(), x_.data(), y_.data(), z_.data()}, distance_.data());
    for (std::size_t n = 0; n < moved_.size(); ++n) {
      const float* const d = &distance_[kProbes * n];
      const Vec3 gradient(Vec3f(d[1] - d[2], d[3] - d[4], d[5] - d[6]));
      const double length = glm::length(gradient), here = static_cast<double>(d[0]);
      if (length > 0.0 && here > -clearance) position_[moved_[n]] -= gradient * ((here + clearance) / length);
    }
  }
}

void LensShell::draw(const Vec3& middle, ContactShellPart& part) const noexcept {
  for (std::size_t n = 0; n < part.x.size(); ++n) {
    const Vec3 p = position_[part.point[std::min(n, part.size() - 1)]] - middle;
    part.x[n] = static_cast<float>(p.x);
    part.y[n] = static_cast<float>(p.y);
    part.z[n] = static_cast<float>(p.z);
  }
}

}  // namespace burrhole
