// core/tool/field_lanes-inl.h: interpolation of a cutting field in vectors; lane by lane the bits of FieldSampler. Included by SIMD kernels
// only, once a target (hence no #pragma once).
#if defined(BURRHOLE_FIELD_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_FIELD_LANES_INL_H
#undef BURRHOLE_FIELD_LANES_INL_H
#else
#define BURRHOLE_FIELD_LANES_INL_H
#endif

#include <hwy/highway.h>

#include "core/base/trilinear-inl.h"
#include "core/base/trilinear.h"
#include "core/tool/field_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

/// Values of a table between its nodes. kRevolved: the table is one plane, radius along x.
template <bool kRevolved, class D>
struct FieldLanes {
  using F = hwy::HWY_NAMESPACE::Vec<D>;
  using M = hwy::HWY_NAMESPACE::Mask<D>;
  static constexpr std::size_t kAxes = kRevolved ? 2 : 3;

  HWY_INLINE explicit FieldLanes(const FieldJob& field) : job(&field) {
    const D d;
    const float ends[3] = {field.end[0], field.end[kRevolved ? 2 : 1], field.end[2]};
    for (std::size_t axis = 0; axis < kAxes; ++axis) end[axis] = hwy::HWY_NAMESPACE::Set(d, ends[axis]);
  }

  /// @returns distances [m]; outside the table a lower bound that is at least the margin. Every lane must be a finite place.
  HWY_INLINE F distance(F x, F y, F z) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const D d;
    const F zero = hn::Zero(d);
    F q[3];
    place(x, y, z, q);
    M inside = hn::And(hn::Ge(q[0], zero), hn::Lt(q[0], end[0]));
    for (std::size_t axis = 1; axis < kAxes; ++axis) inside = hn::And(inside, hn::And(hn::Ge(q[axis], zero), hn::Lt(q[axis], end[axis])));
    const F found = between(job->distance, q, [&](F value) HWY_ATTR { return hn::IfThenElseZero(inside, value); });
    if (hn::AllTrue(d, inside)) return found;
    F square = zero;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const F beyond = hn::Max(zero, hn::Max(hn::Neg(q[axis]), hn::Sub(q[axis], end[axis])));
      square = hn::Add(square, hn::Mul(beyond, beyond));
    }
    const F away = hn::Add(hn::Set(d, job->margin), hn::Mul(hn::Set(d, job->pitch), hn::Sqrt(square)));
    return hn::IfThenElse(inside, found, away);
  }

  /// @returns factors [1/rev]; outside the table those of the nearest place on its border.
  HWY_INLINE F factor(F x, F y, F z) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const D d;
    F q[3];
    place(x, y, z, q);
    for (std::size_t axis = 0; axis < kAxes; ++axis) q[axis] = hn::Min(hn::Max(q[axis], hn::Zero(d)), end[axis]);
    return between(job->factor, q, [](F value) HWY_ATTR { return value; });
  }

 private:
  HWY_INLINE void place(F x, F y, F z, F* q) const {
    namespace hn = hwy::HWY_NAMESPACE;
    q[0] = kRevolved ? hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y))) : x;
    q[1] = kRevolved ? z : y;
    q[2] = z;
  }
  /// @param limit what becomes of a coordinate first.
  template <class Limit>
  HWY_INLINE F between(const float* values, const F* q, const Limit& limit) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const D d;
    const hn::RebindToSigned<D> di;
    hn::Vec<decltype(di)> cell[kAxes];
    F t[kAxes];
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const F here = limit(q[axis]);
      cell[axis] = hn::Min(hn::ConvertTo(di, here), hn::ConvertTo(di, hn::Sub(end[axis], hn::Set(d, 1.0f))));
      t[axis] = hn::Sub(here, hn::ConvertTo(d, cell[axis]));
    }
    if constexpr (kRevolved) {
      const auto at = hn::Add(cell[0], hn::Mul(cell[1], hn::Set(di, job->slab)));
      const auto along_x = [&](const float* first)
                               HWY_ATTR { return lerp(hn::GatherIndex(d, first, at), hn::GatherIndex(d, first + 1, at), t[0]); };
      return lerp(along_x(values), along_x(values + job->slab), t[1]);
    } else {
      const auto at = hn::Add(hn::Add(cell[0], hn::Mul(cell[1], hn::Set(di, job->row))), hn::Mul(cell[2], hn::Set(di, job->slab)));
      return trilinear(t[0], t[1], t[2],
                       [&](unsigned c) HWY_ATTR { return hn::GatherIndex(d, values + corner_offset(c, job->row, job->slab), at); });
    }
  }

  const FieldJob* job;
  F end[kAxes];
};

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
