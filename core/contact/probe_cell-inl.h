// core/contact/probe_cell-inl.h: one cell of surface records interpolated. Included by SIMD kernels only, once a target (hence no #pragma once);
// the plain twin is tests/core/contact/surface_probe_twin.cpp.
#if defined(BURRHOLE_PROBE_CELL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_PROBE_CELL_INL_H
#undef BURRHOLE_PROBE_CELL_INL_H
#else
#define BURRHOLE_PROBE_CELL_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The four channels of one cell, mixed along k, then j, then i. Lanes are channels, of as many corners as a vector holds, so that a row is one
// load and nothing is gathered. The order is the same for every width, and so are the bits.
// Beside them goes what bends the distance (surface_probe.h): f (1 - f) times the change of the normal along each axis, by channel and weighted by
// `metric`, four channels an axis; the sum of its lanes belongs to the distance.
#if HWY_MAX_BYTES >= 16

template <std::size_t kLanes, class Channel>
HWY_INLINE hn::Vec<hn::FixedTag<float, kLanes>> read_channels(const Channel* from) {
  const hn::FixedTag<float, kLanes> df;
  const hn::FixedTag<std::int32_t, kLanes> di;
  const hn::FixedTag<Channel, kLanes> stored;
  return hn::ConvertTo(df, hn::PromoteTo(di, hn::LoadU(stored, from)));
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V mix(D d, V a, V b, float t) {
  return hn::Add(a, hn::Mul(hn::Sub(b, a), hn::Set(d, t)));
}

/// Of the changes of all channels along the axes.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V bend_of(D d, V along_i, V along_j, V along_k, float fx, float fy, float fz, const float* metric) {
  const V i = hn::Mul(along_i, hn::Mul(hn::Load(d, metric), hn::Set(d, fx * (1.0f - fx))));
  const V j = hn::Mul(along_j, hn::Mul(hn::Load(d, metric + 4), hn::Set(d, fy * (1.0f - fy))));
  const V k = hn::Mul(along_k, hn::Mul(hn::Load(d, metric + 8), hn::Set(d, fz * (1.0f - fz))));
  return hn::Add(hn::Add(i, j), k);
}

#endif
#if HWY_MAX_BYTES >= 32  // sixteen lanes gain nothing: two corners along j are then two loads all the same

template <class Channel>
HWY_INLINE void interpolate(const Channel* first, std::ptrdiff_t row, std::ptrdiff_t slab, float fx, float fy, float fz,
                            const float* metric, float* out, float* bend) {
  const hn::FixedTag<float, 8> d8;
  const hn::FixedTag<float, 4> d4;
  const auto near0 = read_channels<8>(first), near1 = read_channels<8>(first + slab);
  const auto past0 = read_channels<8>(first + row), past1 = read_channels<8>(first + row + slab);
  const auto near = mix(d8, near0, near1, fz), past = mix(d8, past0, past1, fz);
  const auto pair = mix(d8, near, past, fy);
  const auto left = hn::LowerHalf(d4, pair), right = hn::UpperHalf(d4, pair);
  hn::Store(mix(d4, left, right, fx), d4, out);
  const auto over_j = hn::Sub(past, near);
  const auto over_k = mix(d8, hn::Sub(near1, near0), hn::Sub(past1, past0), fy);
  const auto along_j = mix(d4, hn::LowerHalf(d4, over_j), hn::UpperHalf(d4, over_j), fx);
  const auto along_k = mix(d4, hn::LowerHalf(d4, over_k), hn::UpperHalf(d4, over_k), fx);
  hn::Store(bend_of(d4, hn::Sub(right, left), along_j, along_k, fx, fy, fz, metric), d4, bend);
}

#elif HWY_MAX_BYTES >= 16

/// One side of a cell, mixed along k and j.
struct CellSide {
  hn::Vec<hn::FixedTag<float, 4>> mixed, along_j, along_k;

  template <class Channel>
  HWY_INLINE CellSide(const Channel* first, std::ptrdiff_t row, std::ptrdiff_t slab, float fy, float fz) {
    const hn::FixedTag<float, 4> d4;
    const auto near0 = read_channels<4>(first), near1 = read_channels<4>(first + slab);
    const auto past0 = read_channels<4>(first + row), past1 = read_channels<4>(first + row + slab);
    const auto near = mix(d4, near0, near1, fz), past = mix(d4, past0, past1, fz);
    mixed = mix(d4, near, past, fy);
    along_j = hn::Sub(past, near);
    along_k = mix(d4, hn::Sub(near1, near0), hn::Sub(past1, past0), fy);
  }
};

template <class Channel>
HWY_INLINE void interpolate(const Channel* first, std::ptrdiff_t row, std::ptrdiff_t slab, float fx, float fy, float fz,
                            const float* metric, float* out, float* bend) {
  const hn::FixedTag<float, 4> d4;
  const CellSide left(first, row, slab, fy, fz), right(first + 4, row, slab, fy, fz);
  hn::Store(mix(d4, left.mixed, right.mixed, fx), d4, out);
  hn::Store(bend_of(d4, hn::Sub(right.mixed, left.mixed), mix(d4, left.along_j, right.along_j, fx),
                    mix(d4, left.along_k, right.along_k, fx), fx, fy, fz, metric),
            d4, bend);
}

#else  // one lane

HWY_INLINE float mix(float a, float b, float t) { return a + (b - a) * t; }

template <class Channel>
HWY_INLINE void interpolate(const Channel* first, std::ptrdiff_t row, std::ptrdiff_t slab, float fx, float fy, float fz,
                            const float* metric, float* out, float* bend) {
  for (std::size_t c = 0; c < 4; ++c, ++first) {
    float side[2], over_j[2], over_k[2];
    for (std::ptrdiff_t i = 0; i < 2; ++i) {
      const Channel* at = first + 4 * i;
      const auto near0 = static_cast<float>(at[0]), near1 = static_cast<float>(at[slab]);
      const auto past0 = static_cast<float>(at[row]), past1 = static_cast<float>(at[row + slab]);
      const float near = mix(near0, near1, fz), past = mix(past0, past1, fz);
      side[i] = mix(near, past, fy);
      over_j[i] = past - near;
      over_k[i] = mix(near1 - near0, past1 - past0, fy);
    }
    out[c] = mix(side[0], side[1], fx);
    const float i = (side[1] - side[0]) * (metric[c] * (fx * (1.0f - fx)));
    const float j = mix(over_j[0], over_j[1], fx) * (metric[4 + c] * (fy * (1.0f - fy)));
    const float k = mix(over_k[0], over_k[1], fx) * (metric[8 + c] * (fz * (1.0f - fz)));
    bend[c] = (i + j) + k;
  }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
