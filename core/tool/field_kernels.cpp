// Sanitizers do not check gather instructions. The scalar form is FieldSampler::distance(); tests/core/tool/field_kernels_test.cpp compares.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tool/field_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/base/trilinear-inl.h"
#include "core/base/trilinear.h"
#include "core/tool/field_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// kRevolved: the table is one plane, radius along x.
template <bool kRevolved>
void SampleTable(const FieldJob& job, const PlaceList& places, float* out) {
  const hn::CappedTag<float, kFieldPad> d;
  const hn::RebindToSigned<decltype(d)> di;
  using F = hn::Vec<decltype(d)>;
  using I = hn::Vec<decltype(di)>;
  const F zero = hn::Zero(d);
  constexpr std::size_t kAxes = kRevolved ? 2 : 3;
  const F end[3] = {hn::Set(d, job.end[0]), hn::Set(d, job.end[kRevolved ? 2 : 1]), hn::Set(d, job.end[2])};
  for (std::size_t n = 0; n < places.count; n += hn::Lanes(d)) {
    // Entries beyond the last one are read as 0, which is inside the table.
    const auto used = hn::FirstN(d, places.count - n);
    const F x = hn::IfThenElseZero(used, hn::LoadU(d, places.x + n)), y = hn::IfThenElseZero(used, hn::LoadU(d, places.y + n)),
            z = hn::IfThenElseZero(used, hn::LoadU(d, places.z + n));
    const F radius = kRevolved ? hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y))) : x;
    const F q[3] = {radius, kRevolved ? z : y, z};
    auto inside = hn::And(hn::Ge(q[0], zero), hn::Lt(q[0], end[0]));
    for (std::size_t axis = 1; axis < kAxes; ++axis) inside = hn::And(inside, hn::And(hn::Ge(q[axis], zero), hn::Lt(q[axis], end[axis])));
    I cell[kAxes];
    F t[kAxes];
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      const F here = hn::IfThenElseZero(inside, q[axis]);
      cell[axis] = hn::ConvertTo(di, here);
      t[axis] = hn::Sub(here, hn::ConvertTo(d, cell[axis]));
    }
    F found;
    if constexpr (kRevolved) {
      const I at = hn::Add(cell[0], hn::Mul(cell[1], hn::Set(di, job.slab)));
      const auto along_x = [&](const float* first)
                               HWY_ATTR { return lerp(hn::GatherIndex(d, first, at), hn::GatherIndex(d, first + 1, at), t[0]); };
      found = lerp(along_x(job.distance), along_x(job.distance + job.slab), t[1]);
    } else {
      const I at = hn::Add(hn::Add(cell[0], hn::Mul(cell[1], hn::Set(di, job.row))), hn::Mul(cell[2], hn::Set(di, job.slab)));
      found = trilinear(t[0], t[1], t[2],
                        [&](unsigned c) HWY_ATTR { return hn::GatherIndex(d, job.distance + corner_offset(c, job.row, job.slab), at); });
    }
    if (!hn::AllTrue(d, inside)) {
      F square = zero;
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        const F beyond = hn::Max(zero, hn::Max(hn::Neg(q[axis]), hn::Sub(q[axis], end[axis])));
        square = hn::Add(square, hn::Mul(beyond, beyond));
      }
      const F away = hn::Add(hn::Set(d, job.margin), hn::Mul(hn::Set(d, job.pitch), hn::Sqrt(square)));
      found = hn::IfThenElse(inside, found, away);
    }
    hn::StoreU(found, d, out + n);
  }
}

void SampleField(const FieldJob& job, const PlaceList& places, float* out) {
  if (job.revolved)
    SampleTable<true>(job, places, out);
  else
    SampleTable<false>(job, places, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(SampleField);

FieldJob field_job(const CuttingField& field) noexcept {
  const Vec3f end(field.dims - 1);
  return {.distance = field.distance.data(),
          .row = field.dims.x,
          .slab = field.dims.x * field.dims.y,
          .end = {end.x, end.y, end.z},
          .margin = static_cast<float>(field.margin),
          .pitch = static_cast<float>(field.pitch),
          .revolved = field.revolved};
}

void sample_field(const FieldJob& job, const PlaceList& places, float* out) noexcept {
  HWY_DYNAMIC_DISPATCH(SampleField)(job, places, out);
}

}  // namespace burrhole
#endif
