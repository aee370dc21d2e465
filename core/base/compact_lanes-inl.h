// core/base/compact_lanes-inl.h: appends the lanes of a mask to a list. Included by SIMD kernels only, once a target (hence no #pragma once).
// Highway 1.0.3's CompressStore copies its table of 1 KiB to the stack at each call below AVX-512; here the lanes' order is looked up once
// for all vectors of a mask.
#if defined(BURRHOLE_COMPACT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_COMPACT_LANES_INL_H
#undef BURRHOLE_COMPACT_LANES_INL_H
#else
#define BURRHOLE_COMPACT_LANES_INL_H
#endif

#include <hwy/highway.h>

#include "core/base/lane_orders.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

/// The lanes of one mask. D: float, std::uint32_t or double, up to 8 lanes of 4 bytes or 4 of 8.
template <class D>
class CompactLanes {
 public:
  HWY_INLINE CompactLanes(D d, hwy::HWY_NAMESPACE::Mask<D> mask) : mask_(mask) {
    namespace hn = hwy::HWY_NAMESPACE;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    bits_ = bits[0];
    count_ = hn::CountTrue(d, mask);
  }
  [[nodiscard]] HWY_INLINE std::size_t count() const { return count_; }
  /// Writes the lanes of the mask to `to` one after the other, and a whole vector.
  template <class Other, class V>
  HWY_INLINE void store(Other d, V value, hwy::HWY_NAMESPACE::TFromD<Other>* to) const {
    namespace hn = hwy::HWY_NAMESPACE;
    static_assert(sizeof(hn::TFromD<Other>) == sizeof(hn::TFromD<D>));
#if HWY_TARGET <= HWY_AVX3
    hn::StoreU(hn::Compress(value, hn::RebindMask(d, mask_)), d, to);
#else
    using Order = hn::TFromD<hn::RebindToSigned<Other>>;
    static constexpr std::size_t kLanes = 16 / sizeof(Order) * (HWY_TARGET <= HWY_AVX2 ? 2 : 1);
    const Order* const order = kLaneOrders<Order, kLanes>.data() + kLanes * bits_;
    hn::StoreU(hn::TableLookupLanes(value, hn::SetTableIndices(d, order)), d, to);
#endif
  }

 private:
  hwy::HWY_NAMESPACE::Mask<D> mask_;
  std::size_t bits_ = 0, count_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
