/// core/tool/field_sampler.h: interpolation of a cutting field in single precision.
///   Frame   nodes of the cutting field: (p - origin) / pitch.   Units  as each function states.   Errors  none.
///   Source  trilinear interpolation; bilinear in the plane of a solid of revolution.
#pragma once

#include <cmath>

#include "core/base/trilinear.h"
#include "core/tool/cutting_field.h"

namespace burrhole {

/// Interpolated distances and factors of a cutting field; positions in nodes.
class FieldSampler {
 public:
  explicit FieldSampler(const CuttingField& field)
      : field_(&field),
        row_(static_cast<std::size_t>(field.dims.x)),
        slab_(row_ * static_cast<std::size_t>(field.dims.y)),
        last_(glm::max(field.dims - 2, Vec3i(0))),
        end_(field.dims - 1) {}

  /// @returns the distance [m]; outside the table a lower bound that is at least the margin.
  [[nodiscard]] float distance(const Vec3f& q) const noexcept {
    const Vec3f p = in_plane(q);
    if (p.x >= 0.0f && p.y >= 0.0f && p.z >= 0.0f && p.x < end_.x && (field_->revolved || p.y < end_.y) && p.z < end_.z)
      return between(field_->distance.data(), p, Vec3i(p));
    const Vec3f beyond = glm::max(Vec3f(0.0f), glm::max(-p, p - end_));
    const Vec3f square = beyond * beyond;
    return static_cast<float>(field_->margin) + static_cast<float>(field_->pitch) * std::sqrt(square.x + square.y + square.z);
  }
  /// @returns the factor [1/rev]; outside the table that of the nearest border point.
  [[nodiscard]] float factor(const Vec3f& q) const noexcept {
    const Vec3f p = glm::clamp(in_plane(q), Vec3f(0.0f), end_);
    return between(field_->factor.data(), p, glm::min(Vec3i(p), last_));
  }

 private:
  /// @returns the place in the plane of a solid of revolution; other places as they are.
  [[nodiscard]] Vec3f in_plane(const Vec3f& q) const noexcept {
    return field_->revolved ? Vec3f(std::sqrt(q.x * q.x + q.y * q.y), 0.0f, q.z) : q;
  }
  [[nodiscard]] float between(const float* values, const Vec3f& q, const Vec3i& v) const noexcept {
    const float* first =
        values + static_cast<std::size_t>(v.z) * slab_ + static_cast<std::size_t>(v.y) * row_ + static_cast<std::size_t>(v.x);
    const Vec3f t = q - Vec3f(v);
    if (field_->revolved) {
      const auto along_x = [&](const float* low) { return low[0] + (low[1] - low[0]) * t.x; };
      const float low = along_x(first), high = along_x(first + slab_);
      return low + (high - low) * t.z;
    }
    return trilinear(t, [&](unsigned n) { return first[corner_offset(n, row_, slab_)]; });
  }

  const CuttingField* field_;
  std::size_t row_, slab_;
  Vec3i last_;
  Vec3f end_;
};

}  // namespace burrhole
