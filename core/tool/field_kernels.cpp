// Sanitizers do not check gather instructions. The scalar form is FieldSampler::distance(); tests/core/tool/field_kernels_test.cpp compares.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tool/field_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/tool/field_kernels.h"
#include "core/tool/field_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <bool kRevolved>
void SampleTable(const FieldJob& job, const PlaceList& places, float* out) {
  const hn::CappedTag<float, kFieldPad> d;
  const FieldLanes<kRevolved, decltype(d)> field(job);
  for (std::size_t n = 0; n < places.count; n += hn::Lanes(d)) {
    // Entries beyond the last one are read as 0, which is inside the table.
    const auto used = hn::FirstN(d, places.count - n);
    const auto read = [&](const float* list) HWY_ATTR { return hn::IfThenElseZero(used, hn::LoadU(d, list + n)); };
    hn::StoreU(field.distance(read(places.x), read(places.y), read(places.z)), d, out + n);
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
          .factor = field.factor.data(),
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
