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

void SampleField(const FieldJob& job, const PlaceList& places, float* out) {
  const hn::CappedTag<float, kFieldPad> d;
  const hn::RebindToSigned<decltype(d)> di;
  using F = hn::Vec<decltype(d)>;
  const F zero = hn::Zero(d);
  const F end[3] = {hn::Set(d, job.end[0]), hn::Set(d, job.end[1]), hn::Set(d, job.end[2])};
  for (std::size_t n = 0; n < places.count; n += hn::Lanes(d)) {
    // Entries beyond the last one are read as 0, which is inside the table.
    const auto used = hn::FirstN(d, places.count - n);
    const F q[3] = {hn::IfThenElseZero(used, hn::LoadU(d, places.x + n)), hn::IfThenElseZero(used, hn::LoadU(d, places.y + n)),
                    hn::IfThenElseZero(used, hn::LoadU(d, places.z + n))};
    auto inside = hn::And(hn::Ge(q[0], zero), hn::Lt(q[0], end[0]));
    for (const std::size_t axis : {1u, 2u}) inside = hn::And(inside, hn::And(hn::Ge(q[axis], zero), hn::Lt(q[axis], end[axis])));
    hn::Vec<decltype(di)> cell[3];
    F t[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const F here = hn::IfThenElseZero(inside, q[axis]);
      cell[axis] = hn::ConvertTo(di, here);
      t[axis] = hn::Sub(here, hn::ConvertTo(d, cell[axis]));
    }
    const auto at = hn::Add(hn::Add(cell[0], hn::Mul(cell[1], hn::Set(di, job.row))), hn::Mul(cell[2], hn::Set(di, job.slab)));
    F found = trilinear(t[0], t[1], t[2],
                        [&](unsigned c) HWY_ATTR { return hn::GatherIndex(d, job.distance + corner_offset(c, job.row, job.slab), at); });
    if (!hn::AllTrue(d, inside)) {
      F square = zero;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const F beyond = hn::Max(zero, hn::Max(hn::Neg(q[axis]), hn::Sub(q[axis], end[axis])));
        square = hn::Add(square, hn::Mul(beyond, beyond));
      }
      const F away = hn::Add(hn::Set(d, job.margin), hn::Mul(hn::Set(d, job.pitch), hn::Sqrt(square)));
      found = hn::IfThenElse(inside, found, away);
    }
    hn::StoreU(found, d, out + n);
  }
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
          .pitch = static_cast<float>(field.pitch)};
}

void sample_field(const FieldJob& job, const PlaceList& places, float* out) noexcept {
  HWY_DYNAMIC_DISPATCH(SampleField)(job, places, out);
}

}  // namespace burrhole
#endif
