// core/contact/packed_lanes-inl.h: shared by the kernels of packed_plane: lanes, positions, fields of a word.
// Included by SIMD kernels only, once per target (hence no #pragma once).
#if defined(BURRHOLE_PACKED_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_PACKED_LANES_INL_H
#undef BURRHOLE_PACKED_LANES_INL_H
#else
#define BURRHOLE_PACKED_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <utility>

#include "core/contact/packed_plane_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DI = hn::CappedTag<std::int32_t, 16>;
using DF = hn::CappedTag<float, 16>;
using DD = hn::CappedTag<double, 8>;  // half of the lanes, at least one
using DIofD = hn::Rebind<std::int32_t, DD>;
using DFofD = hn::Rebind<float, DD>;
using VI = hn::Vec<DI>;
using VF = hn::Vec<DF>;
using VD = hn::Vec<DD>;
using MI = hn::Mask<DI>;
inline constexpr DI kI;
inline constexpr DF kF;
inline constexpr DD kD;
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(DI()));  // constant on every supported target
inline constexpr int kFlight = 4;                                    // vectors

template <int N, class F>
HWY_INLINE void Repeat(F&& f) {
  [&]<int... I>(std::integer_sequence<int, I...>) BH_LANES { (f(std::integral_constant<int, I>{}), ...); }
  (std::make_integer_sequence<int, N>{});
}

struct Place {
  VI x, y, z;
};

HWY_INLINE VI Density(VI word) { return hn::And(word, hn::Set(kI, 0xFF)); }
HWY_INLINE MI Still(VI word) { return hn::Lt(word, hn::Set(kI, static_cast<std::int32_t>(0x81000000))); }
HWY_INLINE MI Solid(const PackedJob& job, VI word) { return hn::Gt(Density(word), hn::Set(kI, job.solid - 1)); }
HWY_INLINE VI Leap(VI word) { return hn::And(hn::ShiftRight<8>(word), hn::Set(kI, 0xFF)); }
HWY_INLINE VI Offset(const PackedJob& job, const Place& voxel) {
  return hn::Add(hn::Add(voxel.x, hn::Mul(voxel.y, hn::Set(kI, job.row))), hn::Mul(voxel.z, hn::Set(kI, job.slab)));
}
HWY_INLINE Place VoxelOf(const Place& p) {
  return {hn::ShiftRight<kFractionBits>(p.x), hn::ShiftRight<kFractionBits>(p.y), hn::ShiftRight<kFractionBits>(p.z)};
}
HWY_INLINE VI WordAt(const PackedJob& job, VI offset) { return hn::GatherIndex(kI, job.words, offset); }
HWY_INLINE VI WordOf(const PackedJob& job, const Place& p) { return WordAt(job, Offset(job, VoxelOf(p))); }

struct Triple {
  VF x, y, z;
};
HWY_INLINE Triple Times(const float (&m)[3][3], const Triple& v) {
  const auto row = [&](const float(&r)[3]) BH_LANES {
    return hn::Add(hn::Add(hn::Mul(hn::Set(kF, r[0]), v.x), hn::Mul(hn::Set(kF, r[1]), v.y)), hn::Mul(hn::Set(kF, r[2]), v.z));
  };
  return {row(m[0]), row(m[1]), row(m[2])};
}
HWY_INLINE VF Dot(const Triple& a, const Triple& b) { return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z)); }
HWY_INLINE Triple GradientOf(VI word) {
  return {hn::ConvertTo(kF, hn::ShiftRight<24>(hn::ShiftLeft<16>(word))), hn::ConvertTo(kF, hn::ShiftRight<24>(hn::ShiftLeft<8>(word))),
          hn::ConvertTo(kF, hn::ShiftRight<24>(word))};
}
/// A step of one voxel along `v` (opposite for `length` < 0), as whole numbers, at most one voxel per axis; zero where v is zero.
HWY_INLINE Place StepAlong(const Triple& v, float length) {
  const VF square = Dot(v, v);
  const VF scale = hn::IfThenElseZero(hn::Gt(square, hn::Zero(kF)), hn::Div(hn::Set(kF, length), hn::Sqrt(square)));
  const VI most = hn::Set(kI, kVoxel), least = hn::Set(kI, -kVoxel);
  const auto part = [&](VF x) BH_LANES { return hn::Min(hn::Max(hn::NearestInt(hn::Mul(x, scale)), least), most); };
  return {part(v.x), part(v.y), part(v.z)};
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
