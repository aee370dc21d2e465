// Leaps. Call a voxel an obstacle if it has a gradient, or lies on the outermost layer, or has no gradient and a neighbour across one of
// its six faces, without gradient either, on another side. The leap is the Chebyshev distance to the nearest obstacle, within 1..kMaxLeap.
//   Proof. Let no obstacle be nearer than L. Two voxels of different sides in that cube are joined inside it by a path across faces; on it
//   two neighbours differ, both without gradient (they are no obstacles), hence both obstacles: a contradiction.
// The Chebyshev distance is separable: first within the plane across i, by two scans that carry a row of bytes at a time; then along i the
// least over r of max(r, what lies r to either side).
//
// Vector kernels; their plain twin is in tests/core/voxel/contact_words_test.cpp.
#include "core/voxel/contact_words.h"

#include <algorithm>
#include <cstring>

#include "core/base/assert.h"
#include "core/voxel/box_parts.h"
#include "core/voxel/word_packing.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxel/contact_words.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef BURRHOLE_CONTACT_WORDS_JOBS
#define BURRHOLE_CONTACT_WORDS_JOBS
namespace burrhole {

/// Rows of `target` in a window `row` wide and `slab` a layer; offsets from the window's first voxel.
struct RowRange {
  std::ptrdiff_t row, slab, first;
  int width, rows, layers;
  [[nodiscard]] std::ptrdiff_t at(int j, int k) const noexcept { return first + j * row + k * slab; }
};

struct SeedJob {
  RowRange range;
  const std::uint8_t* sides;
  std::uint8_t* seeds;
};

/// The target, and the seeds that decide about it: kMaxLeap - 1 further, as far as the window goes.
struct LeapJob {
  RowRange target;                // of words
  RowRange read;                  // of seeds
  int below_i, below_j, below_k;  // from read to target
  const std::uint8_t* seeds;      // at the window's first voxel
  std::uint32_t* words;
  std::uint8_t* across;   // room for read with a row and a layer more on each side
  std::ptrdiff_t stride;  // bytes a row of it
  /// Row j of layer k of read, -1 and the number of them included.
  [[nodiscard]] std::uint8_t* row(int j, int k) const noexcept {
    return across + (static_cast<std::ptrdiff_t>(k + 1) * (read.rows + 2) + j + 1) * stride;
  }
};

inline constexpr std::size_t kBytePad = 128;
inline constexpr std::size_t kRowBuffer = static_cast<std::size_t>(kMaxWindowEdge) + 64;

}  // namespace burrhole
#endif

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void Seed(const SeedJob& job) {
  const hn::ScalableTag<std::uint8_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN std::uint8_t seeds[kRowBuffer];
  const auto one = hn::Set(d, 1), zero = hn::Zero(d), most = hn::Set(d, kMaxLeap);
  for (int k = 0; k < job.range.layers; ++k)
    for (int j = 0; j < job.range.rows; ++j) {
      const std::ptrdiff_t at = job.range.at(j, k);
      const std::uint8_t* here = job.sides + at;
      for (int i = 0; i < job.range.width; i += lanes) {
        const auto side = hn::LoadU(d, here + i);
        auto round = side;
        for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, job.range.row, job.range.slab})
          round = hn::Or(round, hn::Or(hn::LoadU(d, here + i + step), hn::LoadU(d, here + i - step)));
        const auto alike = hn::Eq(hn::And(round, hn::Sub(round, one)), zero);  // one bit at most
        const auto seed = hn::IfThenElseZero(hn::And(alike, hn::Ne(side, zero)), most);
        hn::Store(seed, d, seeds + i);
      }
      std::copy_n(seeds, job.range.width, job.seeds + at);
    }
}

/// Distance within the plane across i, in two scans: each row takes its seeds, and one more than what its neighbours before it have.
void ScanAcross(const LeapJob& job) {
  const hn::ScalableTag<std::uint8_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto one = hn::Set(d, 1), far = hn::Set(d, kMaxLeap);
  const RowRange& read = job.read;
  const auto edge = [&](int j, int k) { std::memset(job.row(j, k), kMaxLeap, static_cast<std::size_t>(job.stride)); };
  for (int j = -1; j <= read.rows; ++j)
    for (const int k : {-1, read.layers}) edge(j, k);
  for (int k = 0; k < read.layers; ++k)
    for (const int j : {-1, read.rows}) edge(j, k);
  const auto beyond = [&](int j, int k, int i) {
    return hn::Min(hn::Min(hn::LoadU(d, job.row(j - 1, k) + i), hn::LoadU(d, job.row(j, k) + i)), hn::LoadU(d, job.row(j + 1, k) + i));
  };
  for (int i = 0; i < read.width; i += lanes) {
    for (int k = 0; k < read.layers; ++k) {
      auto last = far;
      for (int j = 0; j < read.rows; ++j) {
        last = hn::Min(hn::LoadU(d, job.seeds + read.at(j, k) + i), hn::Add(hn::Min(beyond(j, k - 1, i), last), one));
        hn::StoreU(last, d, job.row(j, k) + i);
      }
    }
    for (int k = read.layers - 1; k >= 0; --k) {
      auto last = far;
      for (int j = read.rows - 1; j >= 0; --j) {
        last = hn::Min(hn::LoadU(d, job.row(j, k) + i), hn::Add(hn::Min(beyond(j, k + 1, i), last), one));
        hn::StoreU(last, d, job.row(j, k) + i);
      }
    }
  }
}

void MergeLeaps(const std::uint8_t* leaps, int width, std::uint32_t* words) {
  const hn::ScalableTag<std::uint32_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const auto still = hn::Set(d, 0x80u), mask = hn::Set(d, 0xFFFF00FFu), one = hn::Set(d, 1u);
  for (int i = 0; i < width; i += lanes) {
    const auto word = hn::LoadU(d, words + i);
    const auto leap = hn::Max(hn::PromoteTo(d, hn::LoadU(d8, leaps + i)), one);
    const auto with = hn::Or(hn::And(word, mask), hn::ShiftLeft<8>(leap));
    const auto out = hn::IfThenElse(hn::Eq(hn::ShiftRight<24>(word), still), with, word);
    hn::BlendedStore(out, hn::FirstN(d, static_cast<std::size_t>(width - i)), d, words + i);
  }
}

void Leaps(const LeapJob& job) {
  const hn::ScalableTag<std::uint8_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  const RowRange& target = job.target;
  HWY_ALIGN std::uint8_t leaps[kRowBuffer];
  ScanAcross(job);
  // Past the end of a row lies another: nothing there is nearer than the outermost layer, which the row ends with.
  for (int k = 0; k < target.layers; ++k)
    for (int j = 0; j < target.rows; ++j) {
      const std::uint8_t* in = job.row(job.below_j + j, job.below_k + k) + job.below_i;
      for (int i = 0; i < target.width; i += lanes) {
        auto best = hn::LoadU(d, in + i);
        for (int r = 1; r < kMaxLeap; ++r) {
          const auto nearest = hn::Min(hn::LoadU(d, in + i - r), hn::LoadU(d, in + i + r));
          best = hn::Min(best, hn::Max(hn::Set(d, static_cast<std::uint8_t>(r)), nearest));
        }
        hn::Store(best, d, leaps + i);
      }
      MergeLeaps(leaps, target.width, job.words + target.at(j, k));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {

HWY_EXPORT(Seed);
HWY_EXPORT(Leaps);

namespace {

constexpr int kSlabLayers = 40;  // bounds the scratch of a rebuild

RowRange range_of(const VoxelBox& box, const VoxelBox& target) {
  const Vec3i size = box.size(), part = target.size();
  return {size.x, static_cast<std::ptrdiff_t>(size.x) * size.y, static_cast<std::ptrdiff_t>(box.offset_of(target.lo)), part.x, part.y,
          part.z};
}

}  // namespace

std::size_t ContactWords::bytes() const noexcept {
  return words_.size() * sizeof(ContactWord) + sides_.size() + seeds_.size() + across_.size();
}

void ContactWords::reserve(std::size_t window_voxels) {
  words_.reserve(window_voxels);
  sides_.reserve(window_voxels + 2 * kBytePad);
  seeds_.reserve(window_voxels + 2 * kBytePad);
}

void ContactWords::place(const VoxelBox& box) {
  BH_ASSERT(box.size().x <= kMaxWindowEdge);
  box_ = box;
  words_.assign(box.count(), kEmptyWord);
  sides_.assign(box.count() + 2 * kBytePad, kSideEmpty);
  seeds_.assign(box.count() + 2 * kBytePad, 0);
}

void ContactWords::pack(const MasterWindow& window, const VoxelBox& target) {
  if (target.empty()) return;
  BH_ASSERT(box_.grown(-1).contains(target));
  pack_words({box_, window.density}, target, window.gradient_dead_zone, words_, std::span(sides_).subspan(kBytePad));
}

void ContactWords::find_leaps(const VoxelBox& target) {
  for (int k = target.lo.z; k < target.hi.z && !target.empty(); k += kSlabLayers) {
    VoxelBox slab = target;
    slab.lo.z = k;
    slab.hi.z = std::min(k + kSlabLayers, target.hi.z);
    const VoxelBox read = slab.grown(kMaxLeap - 1).intersect(box_);
    const Vec3i size = read.size(), below = slab.lo - read.lo;
    const int stride = (size.x + 63) / 64 * 64;
    across_.resize(std::max(across_.size(), static_cast<std::size_t>((size.z + 2) * (size.y + 2) * stride) + 2 * kBytePad));
    HWY_DYNAMIC_DISPATCH(Leaps)
    ({range_of(box_, slab), range_of(box_, read), below.x, below.y, below.z, seeds_.data() + kBytePad, words_.data(),
      across_.data() + kBytePad, stride});
  }
}

void ContactWords::rebuild(const MasterWindow& window) {
  place(window.box);
  (void)update(window, window.box);
}

void ContactWords::seed(const VoxelBox& target) {
  if (target.empty()) return;
  HWY_DYNAMIC_DISPATCH(Seed)({range_of(box_, target), sides_.data() + kBytePad, seeds_.data() + kBytePad});
}

VoxelBox ContactWords::update(const MasterWindow& window, const VoxelBox& dirty) {
  BH_ASSERT(window.box == box_);
  const VoxelBox known = window.valid_box(), changed = dirty.intersect(known);
  if (changed.empty()) return {};
  pack(window, changed);
  seed(changed.grown(1).intersect(known));
  const VoxelBox leaping = changed.grown(kMaxLeap).intersect(known);
  find_leaps(leaping);
  return leaping;
}

void ContactWords::slide(const MasterWindow& window) {
  const VoxelBox from = box_, to = window.box, kept = kept_by_slide(from, to, 1);
  if (from.size() != to.size() || kept.empty()) return rebuild(window);
  slide_values(from, words_.data(), to, words_.data());
  slide_values(from, sides_.data() + kBytePad, to, sides_.data() + kBytePad);
  slide_values(from, seeds_.data() + kBytePad, to, seeds_.data() + kBytePad);
  box_ = to;
  const std::vector<VoxelBox> fresh = box_without(to, kept);
  for (const VoxelBox& part : fresh) {
    fill_part(part, kEmptyWord, to, words_.data());
    fill_part(part, kSideEmpty, to, sides_.data() + kBytePad);
    fill_part(part, std::uint8_t{0}, to, seeds_.data() + kBytePad);
    pack(window, part.intersect(window.valid_box()));
  }
  for (const VoxelBox& part : fresh) seed(part.grown(1).intersect(window.valid_box()));
  for (const VoxelBox& part : box_without(to, kept_by_slide(from, to, kWordSlideMargin))) find_leaps(part.intersect(window.valid_box()));
}

}  // namespace burrhole
#endif
