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
// Channels are interpolated along k, then j, then i, in the same order for every width, so the bits are the same. The corrections for
// curvature and for edges (surface_probe.h) are computed beside them, by axis.

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

/// One axis of a cell. Slopes are times -1/2.
struct AxisTurn {
  Vf turn;           ///< change of slope across the cell
  Vf before, after;  ///< slopes at its sides
  Vf rise;           ///< change of the distance
  Vf f;
};

/// [-] At most 0 for a curved surface, at least 1 for a convex edge. @param metric as in ProbeJob.
template <class Channel>
HWY_INLINE Vf sharpness(const AxisTurn& a, const float* metric) {
  const Floats df;
  const auto scaled = [&](Vf value, std::size_t at) HWY_ATTR { return hn::Mul(value, hn::Set(df, metric[at] / kChannelScale<Channel>)); };
  const Vf uneven = hn::Abs(hn::Add(a.rise, hn::Add(a.before, a.after)));
  const Vf sharp = hn::Max(hn::Sub(scaled(hn::Neg(a.turn), 0), hn::Set(df, 2.0f)), hn::Sub(scaled(uneven, 4), hn::Set(df, 1.0f)));
  return hn::IfThenElseZero(hn::Lt(a.turn, hn::Zero(df)), sharp);
}

HWY_INLINE Vf parabola(const AxisTurn& a) { return hn::Mul(a.turn, hn::Mul(a.f, hn::Sub(hn::Set(Floats(), 1.0f), a.f))); }

/// The highest of the eight tangent planes at the corners.
template <bool kStraight, class Channel>
HWY_INLINE Vf highest_tangent(const CellRows<Channel>& rows, Vf fx, Vf fy, Vf fz, const float* metric) {
  const Floats df;
  const Vf one = hn::Set(df, 1.0f);
  const auto corner = [&](const Vi(&words)[sizeof(Channel)], Vf x, Vf y, Vf z) HWY_ATTR {
    const Vf nx = channel_of<1, Channel>(words), ny = channel_of<2, Channel>(words), nz = channel_of<3, Channel>(words);
    const auto weighed = [&](Vf normal, std::size_t at) HWY_ATTR { return hn::Mul(normal, hn::Set(df, metric[at])); };
    const auto whole = [&](std::size_t axis) HWY_ATTR {
      return hn::Add(hn::Add(weighed(nx, 4 * axis + 1), weighed(ny, 4 * axis + 2)), weighed(nz, 4 * axis + 3));
    };
    const Vf along_i = kStraight ? weighed(nx, 1) : whole(0), along_j = kStraight ? weighed(ny, 6) : whole(1),
             along_k = kStraight ? weighed(nz, 11) : whole(2);
    const Vf half = hn::Add(hn::Add(hn::Mul(x, along_i), hn::Mul(y, along_j)), hn::Mul(z, along_k));
    return hn::Sub(channel_of<0, Channel>(words), hn::Add(half, half));
  };
  const Vf bx = hn::Sub(fx, one), by = hn::Sub(fy, one), bz = hn::Sub(fz, one);
  const auto row = [&](const CellRow<Channel>& r, Vf y, Vf z)
                       HWY_ATTR { return hn::Max(corner(r.here, fx, y, z), corner(r.next, bx, y, z)); };
  return hn::Max(hn::Max(row(rows.row00, fy, fz), row(rows.row01, fy, bz)), hn::Max(row(rows.row10, by, fz), row(rows.row11, by, bz)));
}

/// `metric` as in ProbeJob. `cut`: cells that may hold a cut surface. `kStraight`: only the diagonal entries of its weights are not zero.
template <bool kStraight, class Channel>
HWY_INLINE CellSample interpolate(const CellRows<Channel>& rows, Vf fx, Vf fy, Vf fz, const float* metric, hn::Mask<Floats> cut) {
  const Floats df;
  const CellChannel distance = channel_in<0>(rows, fx, fy, fz), nx = channel_in<1>(rows, fx, fy, fz), ny = channel_in<2>(rows, fx, fy, fz),
                    nz = channel_in<3>(rows, fx, fy, fz);
  const auto weighed = [&](Vf normal, std::size_t at) HWY_ATTR { return hn::Mul(normal, hn::Set(df, metric[at])); };
  const auto axis = [&]<std::size_t kAxis>(std::integral_constant<std::size_t, kAxis>, Vf f, Vf CellChannel::*along) HWY_ATTR {
    const auto turn_of = [&](const CellChannel& n, std::size_t c) HWY_ATTR { return weighed(n.*along, 4 * kAxis + 1 + c); };
    const auto before_of = [&](const CellChannel& n, std::size_t c)
                               HWY_ATTR { return weighed(hn::Sub(n.value, hn::Mul(f, n.*along)), 4 * kAxis + 1 + c); };
    const auto whole = [&](const auto& of) HWY_ATTR { return hn::Add(hn::Add(of(nx, 0), of(ny, 1)), of(nz, 2)); };
    if constexpr (kStraight) {
      const CellChannel& own = kAxis == 0 ? nx : kAxis == 1 ? ny : nz;
      const Vf turn = turn_of(own, kAxis), before = before_of(own, kAxis);
      return AxisTurn{turn, before, hn::Add(before, turn), distance.*along, f};
    } else {
      const Vf turn = whole(turn_of), before = whole(before_of);
      return AxisTurn{turn, before, hn::Add(before, turn), distance.*along, f};
    }
  };
  const AxisTurn x = axis(std::integral_constant<std::size_t, 0>(), fx, &CellChannel::along_i),
                 y = axis(std::integral_constant<std::size_t, 1>(), fy, &CellChannel::along_j),
                 z = axis(std::integral_constant<std::size_t, 2>(), fz, &CellChannel::along_k);
  Vf value = hn::Add(distance.value, hn::Add(hn::Add(parabola(x), parabola(y)), parabola(z)));
  if (hn::AllFalse(df, cut)) return {value, nx.value, ny.value, nz.value};
  const Vf sharpest = hn::Max(hn::Max(sharpness<Channel>(x, metric), sharpness<Channel>(y, metric)), sharpness<Channel>(z, metric));
  const Vf sharp = hn::IfThenElseZero(cut, hn::Min(hn::Max(sharpest, hn::Zero(df)), hn::Set(df, 1.0f)));
  if (hn::AllFalse(df, hn::Gt(sharp, hn::Zero(df)))) return {value, nx.value, ny.value, nz.value};
  value = hn::Add(value, hn::Mul(sharp, hn::Sub(highest_tangent<kStraight>(rows, fx, fy, fz, metric), value)));
  return {value, nx.value, ny.value, nz.value};
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
