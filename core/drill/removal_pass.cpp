#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/removal_pass.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <bit>

#include "core/base/assert.h"
#include "core/base/simd_exp-inl.h"
#include "core/drill/removal_pass.h"

// The scalar reference of this pass is in tests/core/drill/removal_pass_test.cpp.

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Processes eight voxels of a row from `n`. @returns bits of those that lost bone.
template <class D>
HWY_INLINE std::uint32_t remove_eight(D d, const RemovalArgs& a, std::size_t at_sum, std::size_t at) {
  const hn::RebindToSigned<D> di;
  const hn::Rebind<float, D> df;
  const hn::Rebind<std::uint32_t, D> du32;
  const hn::RebindToUnsigned<D> du;
  const auto none = hn::Zero(df);
  std::uint32_t bits = 0;
  for (std::size_t p = 0; p < 8; p += hn::Lanes(d)) {
    const auto sum = hn::LoadU(di, a.sums + at_sum + p);
    const auto before = hn::LoadU(df, a.remaining + at + p), occupancy = hn::LoadU(df, a.occupancy + at + p);
    const auto lambda = hn::Mul(hn::Mul(hn::ConvertTo(d, sum), hn::Set(d, a.unit)), hn::Set(d, a.law.scale));
    auto power = hn::Mul(hn::Neg(lambda), hn::Set(d, a.law.dt));
    if (a.law.by_hardness)
      power = hn::Div(power, hn::PromoteTo(d, hn::Max(hn::LoadU(df, a.hardness + at + p), hn::Set(df, a.law.least_hardness))));
    auto after = hn::DemoteTo(df, hn::Mul(hn::PromoteTo(d, before), exp_of_negative(d, power)));
    after = hn::IfThenZeroElse(hn::Lt(hn::Mul(occupancy, after), hn::Set(df, a.law.minimum_density)), after);
    // Bone without exposure is unchanged, also below the minimum density; so are voxels without bone.
    const auto met =
        hn::MaskFromVec(hn::BitCast(df, hn::TruncateTo(du32, hn::BitCast(du, hn::VecFromMask(di, hn::Ne(sum, hn::Zero(di)))))));
    after = hn::IfThenElse(hn::And(met, hn::Ne(occupancy, none)), after, before);
    hn::StoreU(after, df, a.remaining + at + p);
    hn::StoreU(hn::Zero(di), di, a.sums + at_sum + p);
    const auto loss = hn::Mul(hn::PromoteTo(d, occupancy), hn::Sub(hn::PromoteTo(d, before), hn::PromoteTo(d, after)));
    hn::StoreU(hn::Add(hn::LoadU(d, a.mass + p), loss), d, a.mass + p);
    std::uint8_t mask[8] = {};
    hn::StoreMaskBits(df, hn::Ne(after, before), mask);
    bits |= static_cast<std::uint32_t>(mask[0]) << p;
  }
  return bits;
}

/// Whether any of eight sums is not zero.
HWY_INLINE bool any_of_eight(const std::int64_t* sums) {
  const hn::CappedTag<std::int64_t, 8> d;
  auto all = hn::LoadU(d, sums);
  for (std::size_t p = hn::Lanes(d); p < 8; p += hn::Lanes(d)) all = hn::Or(all, hn::LoadU(d, sums + p));
  return !hn::AllTrue(d, hn::Eq(all, hn::Zero(d)));
}

std::uint32_t RemoveRows(const RemovalArgs& a, TileMarks& marks) {
  const hn::CappedTag<double, 8> d;
  std::uint32_t voxels = 0;
  std::size_t at_sum = 0;
  for (int k = 0; k < a.size.z; ++k)
    for (int j = 0; j < a.size.y; ++j) {
      const std::size_t row = a.start + static_cast<std::size_t>(k) * a.slab + static_cast<std::size_t>(j) * a.row;
      for (int i = 0; i < a.size.x; i += 8, at_sum += 8) {
        if (!any_of_eight(a.sums + at_sum)) continue;
        const std::uint32_t bits = remove_eight(d, a, at_sum, row + static_cast<std::size_t>(i));
        marks.mark(a.corner + Vec3i(i, j, k), bits);
        voxels += static_cast<std::uint32_t>(std::popcount(bits));
      }
    }
  return voxels;
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(RemoveRows);

Removal apply_removal(Voxmap& voxmap, const RemovalLaw& law, ExposureField& exposure, TileMarks& marks) {
  if (exposure.box.empty()) return {};
  const MasterWindow& window = voxmap.window();
  // Rows may extend up to seven voxels beyond the erodible box, which ends two voxels before the window's end. Those entries are the start
  // of the next row and are written back unchanged.
  BH_ASSERT(window.erodible_box().contains(VoxelBox{exposure.box.lo + Vec3i(7, 0, 0), exposure.box.hi - Vec3i(7, 0, 0)}));
  const Vec3i corner = exposure.box.lo - window.box.lo;
  const auto row = static_cast<std::size_t>(window.box.size().x);
  double mass[8] = {};
  const RemovalArgs args{law,
                         corner,
                         exposure.box.size(),
                         row,
                         row * static_cast<std::size_t>(window.box.size().y),
                         window.box.offset_of(exposure.box.lo),
                         exposure.unit,
                         exposure.sums.data(),
                         window.occupancy.data(),
                         window.hardness.data(),
                         voxmap.remaining().data(),
                         mass};
  Removal out;
  out.voxels = HWY_DYNAMIC_DISPATCH(RemoveRows)(args, marks);
  for (const double lane : mass) out.mass += lane;
  return out;
}

}  // namespace burrhole
#endif  // HWY_ONCE
