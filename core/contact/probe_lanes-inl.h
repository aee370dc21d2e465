// core/contact/probe_lanes-inl.h: shared by the kernels of the surface probe: number of lanes, transformed points, compaction of lanes.
// Included by SIMD kernels only, once per target (hence no #pragma once).
#if defined(BURRHOLE_PROBE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_PROBE_LANES_INL_H
#undef BURRHOLE_PROBE_LANES_INL_H
#else
#define BURRHOLE_PROBE_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <array>
#include <cstdint>

#ifndef BURRHOLE_PROBE_PACK_ORDER
#define BURRHOLE_PROBE_PACK_ORDER
namespace burrhole {

/// For each set of eight lanes, by its bits: the lanes in it first, then the others. The first four columns serve four lanes.
inline constexpr auto kPackOrder = [] {
  std::array<std::array<std::uint8_t, 8>, 256> out{};
  for (unsigned bits = 0; bits < 256; ++bits) {
    std::size_t at = 0;
    for (const unsigned in : {1u, 0u})
      for (unsigned lane = 0; lane < 8; ++lane)
        if (((bits >> lane) & 1u) == in) out[bits][at++] = static_cast<std::uint8_t>(lane);
  }
  return out;
}();

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// At most sixteen lanes: the padding of the shell.
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Vf = hn::Vec<Floats>;
using Vi = hn::Vec<Ints>;

HWY_INLINE Vf row_times(const float* m, Vf x, Vf y, Vf z, float offset) {
  const Floats df;
  const Vf xy = hn::Add(hn::Mul(hn::Set(df, m[0]), x), hn::Mul(hn::Set(df, m[3]), y));
  return hn::Add(hn::Add(xy, hn::Mul(hn::Set(df, m[6]), z)), hn::Set(df, offset));
}

// Compacts the kept lanes to the lowest lanes. Highway's Compress() is one instruction with 512 bits; with fewer it copies its table to the
// stack at each call and computes the order again for each array, which is five times slower than one order for all arrays.
#if HWY_MAX_BYTES == 16 || HWY_MAX_BYTES == 32
using Packing = decltype(hn::IndicesFromVec(Ints(), hn::Zero(Ints())));

HWY_INLINE Packing packing_of(hn::Mask<Floats> kept) {
  const Ints di;
  const hn::Rebind<std::uint8_t, Ints> bytes;
  std::uint8_t bits[8];
  hn::StoreMaskBits(Floats(), kept, bits);
  return hn::IndicesFromVec(di, hn::PromoteTo(di, hn::LoadU(bytes, kPackOrder[bits[0]].data())));
}
template <class D, class V>
HWY_INLINE void pack_store(V v, Packing packing, D d, hn::TFromD<D>* to) {
  hn::StoreU(hn::BitCast(d, hn::TableLookupLanes(hn::BitCast(Ints(), v), packing)), d, to);
}
#else
using Packing = hn::Mask<Floats>;

HWY_INLINE Packing packing_of(hn::Mask<Floats> kept) { return kept; }
template <class D, class V>
HWY_INLINE void pack_store(V v, Packing packing, D d, hn::TFromD<D>* to) {
  hn::StoreU(hn::Compress(v, hn::RebindMask(d, packing)), d, to);
}
#endif

/// Calls store_all(keep) with a function that stores the lanes of `kept` contiguously: keep(vector, tag, to). If all lanes are kept it is a
/// plain store.
template <class StoreAll>
HWY_INLINE void keep_lanes(hn::Mask<Floats> kept, StoreAll&& store_all) {
  if (hn::AllTrue(Floats(), kept)) {
    store_all([](auto v, auto d, auto* to) HWY_ATTR { hn::StoreU(v, d, to); });
    return;
  }
  const Packing packing = packing_of(kept);
  store_all([&](auto v, auto d, auto* to) HWY_ATTR { pack_store(v, packing, d, to); });
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
