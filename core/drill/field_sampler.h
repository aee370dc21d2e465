/// core/drill/field_sampler.h: interpolation of a cutting field in single precision. Internal to coverage.cpp.
///   Frame   nodes of the cutting field: (p - origin) / pitch.   Units  as each function states.   Errors  none.
///   Source  trilinear interpolation.
#pragma once

#include <vector>

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
        last_(field.dims - 2),
        end_(field.dims - 1) {}

  /// @returns the distance [m]; outside the table a lower bound that is at least the margin.
  [[nodiscard, gnu::always_inline]] float distance(const Vec3f& q) const noexcept {
    if (q.x >= 0.0f && q.y >= 0.0f && q.z >= 0.0f && q.x < end_.x && q.y < end_.y && q.z < end_.z)
      return between(field_->distance.data(), q, Vec3i(q));
    const Vec3f beyond = glm::max(Vec3f(0.0f), glm::max(-q, q - end_));
    return static_cast<float>(field_->margin + field_->pitch * static_cast<double>(glm::length(beyond)));
  }
  /// @returns the gradient [m] per node of the interpolated distance; 0 outside the table.
  [[nodiscard]] Vec3f gradient(const Vec3f& q) const noexcept {
    if (!(q.x >= 0.0f && q.y >= 0.0f && q.z >= 0.0f && q.x < end_.x && q.y < end_.y && q.z < end_.z)) return Vec3f(0.0f);
    const Vec3i v(q);
    const Vec3f t = q - Vec3f(v);
    const float* a = field_->distance.data() + static_cast<std::size_t>(v.z) * slab_ + static_cast<std::size_t>(v.y) * row_ +
                     static_cast<std::size_t>(v.x);
    const float *b = a + row_, *c = a + slab_, *d = c + row_;
    const auto mix = [](float from, float to, float w) { return from + (to - from) * w; };
    const float x = mix(mix(a[1] - a[0], b[1] - b[0], t.y), mix(c[1] - c[0], d[1] - d[0], t.y), t.z);
    const float a0 = mix(a[0], a[1], t.x), b0 = mix(b[0], b[1], t.x), c0 = mix(c[0], c[1], t.x), d0 = mix(d[0], d[1], t.x);
    return {x, mix(b0 - a0, d0 - c0, t.z), mix(c0 - a0, d0 - b0, t.y)};
  }
  [[nodiscard]] std::size_t nearest_node(const Vec3f& q) const noexcept {
    const Vec3i v(glm::clamp(q, Vec3f(0.0f), end_) + 0.5f);
    return static_cast<std::size_t>(v.z) * slab_ + static_cast<std::size_t>(v.y) * row_ + static_cast<std::size_t>(v.x);
  }
  /// @returns the factor [1/rev]; outside the table that of the nearest border point.
  [[nodiscard]] float factor(const Vec3f& q) const noexcept {
    const Vec3f p = glm::clamp(q, Vec3f(0.0f), end_);
    return between(field_->factor.data(), p, glm::min(Vec3i(p), last_));
  }

 private:
  [[nodiscard, gnu::always_inline]] float between(const float* values, const Vec3f& q, const Vec3i& v) const noexcept {
    const float* first =
        values + static_cast<std::size_t>(v.z) * slab_ + static_cast<std::size_t>(v.y) * row_ + static_cast<std::size_t>(v.x);
    return trilinear(q - Vec3f(v), [&](unsigned n) { return first[corner_offset(n, row_, slab_)]; });
  }

  const CuttingField* field_;
  std::size_t row_, slab_;
  Vec3i last_;
  Vec3f end_;
};

/// @returns the curvature of the distances [1/m] per node, by second differences along the axes and all diagonals: downwards (sign -1) or
/// upwards (+1). @param spread each node takes the maximum within this many nodes along each axis.
[[nodiscard]] std::vector<float> bends_of(const CuttingField& field, double sign, int spread);

/// @returns the largest slope [-] >= 1: where they are not negative, interpolated distances within the table change by at most this times
/// the travel. It combines the steepest edges along each axis of the cells with such a point.
[[nodiscard]] double steepest_of(const CuttingField& field);

}  // namespace burrhole
