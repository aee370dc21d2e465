// core/contact/probe_cell-inl.h: interpolates cells of surface records, one cell per lane. Included by SIMD kernels only, once per target
//   (hence no #pragma once). The scalar reference is tests/core/contact/surface_probe_twin.cpp.
#if defined(BURRHOLE_PROBE_CELL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BURRHOLE_PROBE_CELL_INL_H
#undef BURRHOLE_PROBE_CELL_INL_H
#else
#define BURRHOLE_PROBE_CELL_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "core/contact/probe_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {

// Each lane is a cell. One load reads a row of a cell (two records); the rows of several cells are transposed as words, without gathers.
// Channels are interpolated along k, then j, then i, in the same order for every width, so the bits are the same. The correction for
// curvature (surface_probe.h) is computed beside them: f (1 - f) times the change of the normal along each axis, weighted by `metric`.

/// Channels stay in the upper bits of their words, which saves a shift: results are the stored values times this power of two. The scale
/// does not change later bits.
template <class Channel>
inline constexpr float kChannelScale = static_cast<float>(std::uint64_t{1} << (32 - 8 * sizeof(Channel)));

/// One row of cells: words of the record at i and of the record at i + 1.
template <class Channel>
struct CellRow {
  Vi here[sizeof(Channel)], next[sizeof(Channel)];
};

/// The four rows of cells, by (j, k).
template <class Channel>
struct CellRows {
  CellRow<Channel> row00, row01, row10, row11;
};

/// Offsets of the rows of the cell of record 0.
template <class Channel>
struct RowStarts {
  const Channel *row00, *row01, *row10, *row11;
};

#if HWY_MAX_BYTES >= 16

inline constexpr std::size_t kCellLanes = HWY_MIN(HWY_MAX_BYTES, 64) / 4;

/// Loads rows of two records, 4 words each, of cells first, first + 4, first + 8 and so on. Loads broadcast over the vector at no cost;
/// blends select each block.
HWY_INLINE Vi load_rows(const std::int16_t* row, const std::int32_t* cells, std::size_t first) {
  const Ints di;
  const hn::Repartition<std::int16_t, Ints> stored;
  const auto block = [&](std::size_t n) HWY_ATTR {
    return hn::BitCast(di, hn::LoadDup128(stored, row + 4 * static_cast<std::ptrdiff_t>(cells[first + 4 * n])));
  };
  if constexpr (kCellLanes == 4)
    return block(0);
  else if constexpr (kCellLanes == 8)
    return hn::ConcatUpperLower(di, block(1), block(0));
  else
    return hn::ConcatUpperLower(di, hn::OddEvenBlocks(block(3), block(2)), hn::OddEvenBlocks(block(1), block(0)));
}

/// The same for records of 2 words per row, of cells first, first + 1, first + 2 and so on.
template <std::size_t kWords>
HWY_INLINE hn::Vec<hn::FixedTag<std::int32_t, kWords>> load_pairs(const std::int8_t* row, const std::int32_t* cells, std::size_t first) {
  const hn::FixedTag<std::int32_t, kWords> d;
  if constexpr (kWords == 2)
    return hn::BitCast(d, hn::LoadU(hn::FixedTag<std::int8_t, 8>(), row + 4 * static_cast<std::ptrdiff_t>(cells[first])));
  else
    return hn::Combine(d, load_pairs<kWords / 2>(row, cells, first + kWords / 4), load_pairs<kWords / 2>(row, cells, first));
}
HWY_INLINE Vi load_rows(const std::int8_t* row, const std::int32_t* cells, std::size_t first) {
  return load_pairs<kCellLanes>(row, cells, first);
}

/// Loads all four rows together, so that each cell's offset is read once.
struct LoadedRows {
  template <class Channel>
  HWY_INLINE LoadedRows(const RowStarts<Channel>& starts, const std::int32_t* cells, std::size_t first)
      : row00(load_rows(starts.row00, cells, first)),
        row01(load_rows(starts.row01, cells, first)),
        row10(load_rows(starts.row10, cells, first)),
        row11(load_rows(starts.row11, cells, first)) {}
  Vi row00, row01, row10, row11;
};

/// Transposes four words of cells n, n + 4 and so on, n from 0 to 3, to one word of all cells.
HWY_INLINE CellRow<std::int16_t> transposed(Vi r0, Vi r1, Vi r2, Vi r3) {
  const Ints di;
  const hn::Repartition<std::int64_t, Ints> dw;
  const auto low01 = hn::BitCast(dw, hn::InterleaveLower(di, r0, r1)), low23 = hn::BitCast(dw, hn::InterleaveLower(di, r2, r3));
  const auto high01 = hn::BitCast(dw, hn::InterleaveUpper(di, r0, r1)), high23 = hn::BitCast(dw, hn::InterleaveUpper(di, r2, r3));
  return {{hn::BitCast(di, hn::InterleaveLower(dw, low01, low23)), hn::BitCast(di, hn::InterleaveUpper(dw, low01, low23))},
          {hn::BitCast(di, hn::InterleaveLower(dw, high01, high23)), hn::BitCast(di, hn::InterleaveUpper(dw, high01, high23))}};
}

HWY_INLINE CellRows<std::int16_t> read_cells(const RowStarts<std::int16_t>& starts, const std::int32_t* cells) {
  const LoadedRows a(starts, cells, 0), b(starts, cells, 1), c(starts, cells, 2), d(starts, cells, 3);
  return {transposed(a.row00, b.row00, c.row00, d.row00), transposed(a.row01, b.row01, c.row01, d.row01),
          transposed(a.row10, b.row10, c.row10, d.row10), transposed(a.row11, b.row11, c.row11, d.row11)};
}

HWY_INLINE CellRow<std::int8_t> transposed(Vi lower, Vi upper) {
  const Ints di;
  return {{hn::ConcatEven(di, upper, lower)}, {hn::ConcatOdd(di, upper, lower)}};
}

HWY_INLINE CellRows<std::int8_t> read_cells(const RowStarts<std::int8_t>& starts, const std::int32_t* cells) {
  const LoadedRows a(starts, cells, 0), b(starts, cells, kCellLanes / 2);
  return {transposed(a.row00, b.row00), transposed(a.row01, b.row01), transposed(a.row10, b.row10), transposed(a.row11, b.row11)};
}

#else  // one lane

template <class Channel>
HWY_INLINE CellRow<Channel> read_row(const Channel* row, std::int32_t cell) {
  CellRow<Channel> out;
  for (std::size_t n = 0; n < sizeof(Channel); ++n) {
    const auto word = [&](std::size_t record) {
      std::int32_t bits;
      hwy::CopyBytes<4>(row + 4 * (static_cast<std::ptrdiff_t>(cell) + static_cast<std::ptrdiff_t>(record)) + n * 4 / sizeof(Channel),
                        &bits);
      return hn::Set(Ints(), bits);
    };
    out.here[n] = word(0);
    out.next[n] = word(1);
  }
  return out;
}

template <class Channel>
HWY_INLINE CellRows<Channel> read_cells(const RowStarts<Channel>& starts, const std::int32_t* cells) {
  return {read_row(starts.row00, *cells), read_row(starts.row01, *cells), read_row(starts.row10, *cells), read_row(starts.row11, *cells)};
}

#endif

/// Channel `kChannel` of four of a record, from its words.
template <std::size_t kChannel, class Channel, std::size_t kWords>
HWY_INLINE Vf channel_of(const Vi (&words)[kWords]) {
  constexpr std::size_t kBits = 8 * sizeof(Channel), kInWord = 32 / kBits, kPlace = kChannel % kInWord;
  static_assert(kChannel / kInWord < kWords);
  const Vi top = hn::ShiftLeft<static_cast<int>(32 - kBits * (kPlace + 1))>(words[kChannel / kInWord]);
  if constexpr (kPlace == 0) return hn::ConvertTo(Floats(), top);  // no bits below it
  constexpr auto kTop = static_cast<std::int32_t>(~std::uint32_t{0} << (32 - kBits));
  return hn::ConvertTo(Floats(), hn::And(top, hn::Set(Ints(), kTop)));
}

HWY_INLINE Vf mix(Vf a, Vf b, Vf t) { return hn::Add(a, hn::Mul(hn::Sub(b, a), t)); }

/// One channel at i or at i + 1 of the cells.
struct CellSide {
  HWY_INLINE CellSide(Vf v00, Vf v01, Vf v10, Vf v11, Vf fy, Vf fz) {
    const Vf near = mix(v00, v01, fz), past = mix(v10, v11, fz);
    value = mix(near, past, fy);
    over_j = hn::Sub(past, near);
    over_k = mix(hn::Sub(v01, v00), hn::Sub(v11, v10), fy);
  }
  Vf value, over_j, over_k;
};

/// One channel at points in cells, and its change along each axis.
struct CellChannel {
  HWY_INLINE CellChannel(const CellSide& left, const CellSide& right, Vf fx)
      : value(mix(left.value, right.value, fx)),
        along_i(hn::Sub(right.value, left.value)),
        along_j(mix(left.over_j, right.over_j, fx)),
        along_k(mix(left.over_k, right.over_k, fx)) {}
  Vf value, along_i, along_j, along_k;
};

template <std::size_t kChannel, class Channel>
HWY_INLINE CellChannel channel_in(const CellRows<Channel>& rows, Vf fx, Vf fy, Vf fz) {
  const CellSide left(channel_of<kChannel, Channel>(rows.row00.here), channel_of<kChannel, Channel>(rows.row01.here),
                      channel_of<kChannel, Channel>(rows.row10.here), channel_of<kChannel, Channel>(rows.row11.here), fy, fz);
  const CellSide right(channel_of<kChannel, Channel>(rows.row00.next), channel_of<kChannel, Channel>(rows.row01.next),
                       channel_of<kChannel, Channel>(rows.row10.next), channel_of<kChannel, Channel>(rows.row11.next), fy, fz);
  return CellChannel(left, right, fx);
}

/// Interpolated values at points in cells; all times kChannelScale.
struct CellSample {
  Vf distance, nx, ny, nz;
};

/// `metric` has four channels per axis, of which the first is not read. `kStraight`: only the diagonal entries are not zero.
template <bool kStraight, class Channel>
HWY_INLINE CellSample interpolate(const CellRows<Channel>& rows, Vf fx, Vf fy, Vf fz, const float* metric) {
  const Floats df;
  const Vf one = hn::Set(df, 1.0f);
  const Vf gx = hn::Mul(fx, hn::Sub(one, fx)), gy = hn::Mul(fy, hn::Sub(one, fy)), gz = hn::Mul(fz, hn::Sub(one, fz));
  const CellChannel distance = channel_in<0>(rows, fx, fy, fz), nx = channel_in<1>(rows, fx, fy, fz), ny = channel_in<2>(rows, fx, fy, fz),
                    nz = channel_in<3>(rows, fx, fy, fz);
  const auto weighed = [&](Vf change, std::size_t at, Vf g) HWY_ATTR { return hn::Mul(change, hn::Mul(hn::Set(df, metric[at]), g)); };
  const auto whole = [&](const CellChannel& n, std::size_t c) HWY_ATTR {
    return hn::Add(hn::Add(weighed(n.along_i, c, gx), weighed(n.along_j, 4 + c, gy)), weighed(n.along_k, 8 + c, gz));
  };
  Vf bend;
  if constexpr (kStraight)
    bend = hn::Add(hn::Add(weighed(nx.along_i, 1, gx), weighed(ny.along_j, 4 + 2, gy)), weighed(nz.along_k, 8 + 3, gz));
  else
    bend = hn::Add(hn::Add(whole(nx, 1), whole(ny, 2)), whole(nz, 3));
  return {hn::Add(distance.value, bend), nx.value, ny.value, nz.value};
}

/// The distance of one record of each cell, times kChannelScale: the masks select the record at i + 1, j + 1, k + 1.
template <class Channel>
HWY_INLINE Vf distance_at(const CellRows<Channel>& rows, hn::Mask<Floats> up_i, hn::Mask<Floats> up_j, hn::Mask<Floats> up_k) {
  const Ints di;
  const auto choose = [&](hn::Mask<Floats> up, Vi next, Vi here) HWY_ATTR { return hn::IfThenElse(hn::RebindMask(di, up), next, here); };
  const auto side = [&](const CellRow<Channel>& row) HWY_ATTR { return choose(up_i, row.next[0], row.here[0]); };
  const Vi past = choose(up_k, side(rows.row11), side(rows.row10)), near = choose(up_k, side(rows.row01), side(rows.row00));
  return channel_of<0, Channel>({choose(up_j, past, near)});
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#endif
