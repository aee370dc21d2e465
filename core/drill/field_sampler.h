/// core/drill/field_sampler.h: a cutting field between its nodes, in single precision; for core/drill/coverage.cpp.
///   Frame   nodes: (p - origin) / pitch.   Source  trilinear interpolation.
#pragma once

#include <vector>

#include "core/tool/cutting_field.h"

namespace burrhole {

/// Distances and factors between the nodes of a cutting field; places in nodes.
class FieldSampler {
 public:
  explicit FieldSampler(const CuttingField& field)
      : field_(&field),
        row_(static_cast<std::size_t>(field.dims.x)),
        slab_(row_ * static_cast<std::size_t>(field.dims.y)),
        last_(field.dims - 2),
        end_(field.dims - 1) {}

  /// [m] outside the table at least the margin.
  [[nodiscard, gnu::always_inline]] float distance(const Vec3f& q) const noexcept {
    if (q.x >= 0.0f && q.y >= 0.0f && q.z >= 0.0f && q.x < end_.x && q.y < end_.y && q.z < end_.z)
      return between(field_->distance.data(), q, Vec3i(q));
    const Vec3f beyond = glm::max(Vec3f(0.0f), glm::max(-q, q - end_));
    return static_cast<float>(field_->margin + field_->pitch * static_cast<double>(glm::length(beyond)));
  }
  /// [m] per node, of the interpolated distance; 0 outside the table.
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
  /// [1/rev] outside the table that of its edge.
  [[nodiscard]] float factor(const Vec3f& q) const noexcept {
    const Vec3f p = glm::clamp(q, Vec3f(0.0f), end_);
    return between(field_->factor.data(), p, glm::min(Vec3i(p), last_));
  }

 private:
  [[nodiscard, gnu::always_inline]] float between(const float* values, const Vec3f& q, const Vec3i& v) const noexcept {
    const Vec3f t = q - Vec3f(v);
    const float* a = values + static_cast<std::size_t>(v.z) * slab_ + static_cast<std::size_t>(v.y) * row_ + static_cast<std::size_t>(v.x);
    const float* b = a + slab_;
    const auto along = [&](const float* p) { return p[0] + (p[1] - p[0]) * t.x; };
    const float a0 = along(a), a1 = along(a + row_), b0 = along(b), b1 = along(b + row_);
    const float a01 = a0 + (a1 - a0) * t.y, b01 = b0 + (b1 - b0) * t.y;
    return a01 + (b01 - a01) * t.z;
  }

  const CuttingField* field_;
  std::size_t row_, slab_;
  Vec3i last_;
  Vec3f end_;
};

/// How strongly distances bend [1/m], by second differences along the axes and all diagonals: downwards (sign -1) or upwards (+1).
/// @param spread each node takes the largest within so many nodes along each axis.
[[nodiscard]] std::vector<float> bends_of(const CuttingField& field, double sign, int spread);

/// [-] >= 1: where they are not negative, interpolated distances within the table change by no more than this times the way. Axis by axis
/// the steepest edge of each cell that has such a place.
[[nodiscard]] double steepest_of(const CuttingField& field);

}  // namespace burrhole
