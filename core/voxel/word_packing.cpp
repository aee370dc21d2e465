// A vector kernel; its plain twin is in tests/core/voxel/word_packing_test.cpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/word_packing.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/base/assert.h"
#include "core/voxel/word_packing.h"

#ifndef BURRHOLE_WORD_PACKING_ROWS
#define BURRHOLE_WORD_PACKING_ROWS
namespace burrhole {

/// The target's rows; pointers at its first voxel, strides in voxels.
struct PackRows {
  const float* density;
  std::uint32_t* words;
  std::uint8_t* sides;
  std::ptrdiff_t row, slab;
  std::size_t count, rows, slabs;
  float dead2;
};

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
HWY_INLINE void pack_vector(D d, const PackRows& a, std::ptrdiff_t at) {
  const hn::RebindToSigned<D> di;
  const hn::Rebind<std::uint8_t, D> d8;
  const float* const in = a.density + at;
  const auto half = hn::Set(d, 0.5f), zero = hn::Zero(d);
  const auto byte = hn::Set(di, 0xFF);
  const auto twice = [&](std::ptrdiff_t step) { return hn::Sub(hn::LoadU(d, in + step), hn::LoadU(d, in - step)); };
  const auto x2 = twice(1), y2 = twice(a.row), z2 = twice(a.slab);
  // Twice the gradient: halving and quartering are exact, so that steps and dead zone are those of the gradient itself.
  const auto most = hn::Set(d, 127.0f), least = hn::Set(d, -127.0f);
  const auto part = [&](auto g2) {
    const auto steps = hn::Min(hn::Max(hn::Mul(g2, hn::Set(d, 0.5f * kWordGradient)), least), most);
    // 1.5 * 2^23 leaves the whole number nearest, the even one of two, in the low bits.
    return hn::BitCast(di, hn::Add(steps, hn::Set(d, 12582912.0f)));
  };
  const auto length2 = hn::Add(hn::Add(hn::Mul(x2, x2), hn::Mul(y2, y2)), hn::Mul(z2, z2));
  const auto x = part(x2), y = part(y2), z = part(z2);
  const auto dead = hn::RebindMask(di, hn::Lt(length2, hn::Set(d, 4.0f * a.dead2)));
  const auto none = hn::Or(dead, hn::Eq(hn::And(hn::Or(hn::Or(x, y), z), byte), hn::Zero(di)));

  const auto here = hn::LoadU(d, in);
  const auto some = hn::IfThenElseZero(hn::RebindMask(di, hn::Gt(here, zero)), hn::Set(di, 1));
  const auto bounded = hn::Min(hn::Max(here, zero), hn::Set(d, 1.0f));
  const auto rounded = hn::Floor(hn::Add(hn::Mul(bounded, hn::Set(d, 255.0f)), half));  // a whole number; 2^23 leaves it in the low bits
  const auto density = hn::Max(hn::And(hn::BitCast(di, hn::Add(rounded, hn::Set(d, 8388608.0f))), byte), some);

  const auto still = hn::Set(di, static_cast<std::int32_t>(kEmptyWord));
  const auto packed = hn::Or(hn::Or(hn::ShiftLeft<8>(hn::And(x, byte)), hn::ShiftLeft<16>(hn::And(y, byte))), hn::ShiftLeft<24>(z));
  const auto word = hn::Or(density, hn::IfThenElse(none, still, packed));
  hn::StoreU(hn::BitCast(hn::RebindToUnsigned<D>(), word), hn::RebindToUnsigned<D>(), a.words + at);
  auto side = hn::IfThenElse(hn::Eq(density, hn::Zero(di)), hn::Set(di, kSideEmpty), hn::Set(di, kSideThin));
  side = hn::IfThenElse(hn::Gt(density, hn::Set(di, 127)), hn::Set(di, kSideSolid), side);
  hn::StoreU(hn::DemoteTo(d8, hn::IfThenElseZero(none, side)), d8, a.sides + at);
}

/// A row of at least Lanes(d) voxels: whole vectors, then one that overlaps the last, of half the length where that will do.
template <class D>
HWY_INLINE void pack_row(D d, const PackRows& a, std::ptrdiff_t start) {
  const hn::CappedTag<float, (hn::MaxLanes(D()) + 1) / 2> shorter;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t n = 0;
  for (; n + lanes <= a.count; n += lanes) pack_vector(d, a, start + static_cast<std::ptrdiff_t>(n));
  const std::size_t left = a.count - n, few = hn::Lanes(shorter);
  if (left > few)
    pack_vector(d, a, start + static_cast<std::ptrdiff_t>(a.count - lanes));
  else if (left > 0)
    pack_vector(shorter, a, start + static_cast<std::ptrdiff_t>(a.count - few));
}

void Pack(const PackRows& a) {
  const hn::CappedTag<float, 16> wide;
  const hn::CappedTag<float, 4> narrow;
  const hn::CappedTag<float, 1> single;
  for (std::size_t k = 0; k < a.slabs; ++k)
    for (std::size_t j = 0; j < a.rows; ++j) {
      const std::ptrdiff_t start = static_cast<std::ptrdiff_t>(k) * a.slab + static_cast<std::ptrdiff_t>(j) * a.row;
      if (a.count >= hn::Lanes(wide))
        pack_row(wide, a, start);
      else if (a.count >= hn::Lanes(narrow))
        pack_row(narrow, a, start);
      else
        pack_row(single, a, start);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(Pack);

void pack_words(const DensityBlock& block, const VoxelBox& target, float dead_zone, std::span<ContactWord> words,
                std::span<std::uint8_t> sides) noexcept {
  if (target.empty()) return;
  BH_ASSERT(block.box.contains(target.grown(1)));
  const Vec3i size = block.box.size();
  const glm::uvec3 part(target.size());
  const std::size_t first = block.box.offset_of(target.lo);
  HWY_DYNAMIC_DISPATCH(Pack)
  ({block.density.data() + first, words.data() + first, sides.data() + first, size.x, std::ptrdiff_t{size.x} * size.y, part.x, part.y,
    part.z, dead_zone * dead_zone});
}

}  // namespace burrhole
#endif
