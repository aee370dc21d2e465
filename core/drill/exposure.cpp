#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/exposure.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/base/assert.h"
#include "core/drill/exposure.h"
#include "core/drill/exposure_kernels.h"

// Voxel of a point. Positions are 32.32 fixed point [voxels from the window's corner]; floor = the upper word. Point n of a run lies at
// S + T[n], with S the start of its run and T[n] = round(n x step), equal for all runs of a pose. Its floor on each axis is
//   floor(S) + floor(T[n]) + carry,   carry = frac(S) + frac(T[n]) >= 1,   that is   frac(T[n]) > not frac(S)   for unsigned words.
// Offsets in the field are linear in the floors: one table has the offset of floor(T[n]), and three compares add the strides of the
// carries. A straight line meets a cell once, so points of a run that share a voxel are consecutive: a voxel gets the difference of two
// prefix sums of weights.
// TSan does not check gathers and vector stores; one thread owns all the data. The scalar reference is in
// tests/core/drill/exposure_test.cpp.

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void StartRuns(const StartArgs& a) {
  const hn::CappedTag<double, 8> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<std::int32_t, decltype(d)> di32;
  const hn::Rebind<std::uint32_t, decltype(d)> du32;
  const auto bias = hn::Set(d, kFixedBias);
  for (std::size_t n = 0; n < a.runs; n += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, a.x + n), y = hn::LoadU(d, a.y + n), z = hn::LoadU(d, a.z + n), span = hn::LoadU(d, a.span + n);
    auto base = hn::Zero(di32);
    auto inside = hn::MaskFromVec(hn::BitCast(d, hn::Set(du, ~std::uint64_t{0})));
    std::int32_t* const carries[3] = {a.carry_x, a.carry_y, a.carry_z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Mat3& m = a.window_from_tool.linear;
      const auto first = hn::Add(
          hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0][axis]), x), hn::Mul(hn::Set(d, m[1][axis]), y)), hn::Mul(hn::Set(d, m[2][axis]), z)),
          hn::Set(d, a.window_from_tool.offset[axis]));
      const auto last = hn::Add(first, hn::Mul(hn::Set(d, a.along[axis]), span));
      inside = hn::And(
          inside, hn::And(hn::Ge(hn::Min(first, last), hn::Set(d, a.least[axis])), hn::Lt(hn::Max(first, last), hn::Set(d, a.most[axis]))));
      const auto fixed = hn::BitCast(du, hn::Add(first, bias));  // low word: the fraction; above it: 2^19 + whole voxels
      const auto whole = hn::BitCast(di32, hn::TruncateTo(du32, hn::ShiftRight<32>(fixed)));
      const auto origin = static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(kFixedBias) >> 32) + a.corner[axis];
      base = hn::Add(base, hn::Mul(hn::Sub(whole, hn::Set(di32, origin)), hn::Set(di32, a.strides[axis])));
      // "not fraction", with its upper bit inverted so that a signed compare orders unsigned words
      const auto limit = hn::Xor(hn::BitCast(di32, hn::TruncateTo(du32, fixed)), hn::Set(di32, 0x7fffffff));
      hn::StoreU(limit, di32, carries[axis] + n);
    }
    hn::StoreU(base, di32, a.base + n);
    hn::StoreU(hn::BitCast(di32, hn::TruncateTo(du32, hn::BitCast(du, hn::VecFromMask(d, inside)))), di32, a.inside + n);
  }
}

constexpr std::size_t kBatch = 1024;  // points, plus one run at most: their offsets and segments stay in the first-level cache

/// Points from `start`, in many runs.
struct Batch {
  std::uint32_t start = 0;
  std::size_t count = 0;
  HWY_ALIGN std::int32_t offset[kBatch + kLongestRun + 64];  // of each point's voxel
  std::uint64_t ends[(kBatch + kLongestRun) / 64 + 1];       // a bit for each point that is followed by another voxel
};

/// Offsets of the points of a run. Whole vectors: entries written beyond the end of the run are overwritten by the next run.
void append_run(const RunArgs& a, std::size_t r, Batch& b) {
  const hn::CappedTag<std::int32_t, 16> d;
  const auto sx = hn::Set(d, a.strides.x), sy = hn::Set(d, a.strides.y), sz = hn::Set(d, a.strides.z);
  const auto base = hn::Set(d, a.base[r]);
  const auto cx = hn::Set(d, a.carry_x[r]), cy = hn::Set(d, a.carry_y[r]), cz = hn::Set(d, a.carry_z[r]);
  const std::size_t count = a.first[r + 1] - a.first[r];
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    auto at = hn::Add(base, hn::LoadU(d, a.step_offset + n));
    at = hn::Add(at, hn::IfThenElseZero(hn::Gt(hn::LoadU(d, a.step_x + n), cx), sx));
    at = hn::Add(at, hn::IfThenElseZero(hn::Gt(hn::LoadU(d, a.step_y + n), cy), sy));
    at = hn::Add(at, hn::IfThenElseZero(hn::Gt(hn::LoadU(d, a.step_z + n), cz), sz));
    hn::StoreU(at, d, b.offset + b.count + n);
  }
  b.count += count;
}

/// A segment of points in one voxel ends where the next point lies in another voxel, in the same run or not.
void find_ends(Batch& b) {
  const hn::CappedTag<std::int32_t, 16> d;
  const std::size_t lanes = hn::Lanes(d);
  b.offset[b.count] = -1;  // no voxel: ends the last segment
  std::size_t n = 0;
  for (std::uint64_t* word = b.ends; n < b.count; ++word) {
    *word = 0;
    for (std::size_t bit = 0; bit < 64; bit += lanes, n += lanes) {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Ne(hn::LoadU(d, b.offset + n), hn::LoadU(d, b.offset + n + 1)), bits);
      *word |= (std::uint64_t{bits[0]} | std::uint64_t{bits[1]} << 8) << bit;
    }
  }
  if (b.count % 64 != 0) b.ends[b.count / 64] &= ~std::uint64_t{0} >> (64 - b.count % 64);
}

/// Calls add(offset, end) for each segment, in order; `end` counts all points of the tool.
template <class Add>
HWY_INLINE void for_each_stretch(const Batch& b, Add&& add) {
  for (std::size_t from = 0; from < b.count; from += 64)
    for (std::uint64_t ends = b.ends[from / 64]; ends != 0; ends &= ends - 1) {
      const std::size_t last = from + static_cast<std::size_t>(std::countr_zero(ends));
      add(static_cast<std::uint32_t>(b.offset[last]), b.start + static_cast<std::uint32_t>(last) + 1);
    }
}

void flush(const RunArgs& a, Batch& b) {
  if (b.count == 0) return;
  find_ends(b);
  if (a.before != nullptr) {
    std::uint64_t from = a.before[b.start];
    for_each_stretch(b, [&](std::uint32_t offset, std::uint32_t end) {
      a.sums[offset] += static_cast<std::int64_t>(a.before[end] - from);
      from = a.before[end];
    });
  } else {
    std::uint32_t from = b.start;
    for_each_stretch(b, [&](std::uint32_t offset, std::uint32_t end) {
      a.sums[offset] += static_cast<std::int64_t>((end - from) * a.weight);
      from = end;
    });
  }
  b.count = 0;
}

void AddRuns(const RunArgs& a) {
  Batch b;
  for (std::size_t r = 0; r < a.runs; ++r) {
    if (a.inside[r] == 0 || b.count >= kBatch) flush(a, b);
    if (a.inside[r] == 0) continue;
    if (b.count == 0) b.start = a.first[r];
    append_run(a, r, b);
  }
  flush(a, b);
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(StartRuns);
HWY_EXPORT(AddRuns);
namespace {

constexpr std::size_t kRunPad = 8, kStepPad = 64;
constexpr double kFar = 262144.0;  // [voxels] 2^18: positions below this fit the fixed point; no window is a thousandth as long

/// 32.32 fixed point with the rounding of the kernels. |x| < 2^19.
std::int64_t to_fixed(double x) { return std::bit_cast<std::int64_t>(x + kFixedBias) - std::bit_cast<std::int64_t>(kFixedBias); }

/// Order of the tool's lattice: k, j, i, i fastest; ties by number, so that the order is unique.
std::vector<std::uint32_t> lattice_order(const ErosionPoints& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = points.positions[a], &q = points.positions[b];
    return std::tuple(p.z, p.y, p.x, a) < std::tuple(q.z, q.y, q.x, b);
  };
  if (!std::ranges::is_sorted(order, before)) std::ranges::sort(order, before);
  return order;
}

}  // namespace

void ExposureField::place(const MasterWindow& window, const VoxelBox& part) {
  box = part;
  if (part.empty()) return;
  const int lead = (part.lo.x - window.box.lo.x) % 8;
  box.lo.x -= lead;
  box.hi.x = box.lo.x + (part.hi.x - box.lo.x + 7) / 8 * 8;
  if (sums.size() >= box.count()) return;
  sums = {};  // all zero: freed before the larger one is allocated
  sums.resize(box.count(), 0);
}

PointScatter::PointScatter(const ErosionPoints& points) : pitch_(points.pitch), count_(static_cast<std::uint32_t>(points.size())) {
  if (points.size() == 0) return;
  tool_bounds_ = bounds_of_points(points.positions);
  distinct_ = points.factors;
  std::ranges::sort(distinct_);
  distinct_.erase(std::unique(distinct_.begin(), distinct_.end()), distinct_.end());
  distinct_.shrink_to_fit();

  const auto order = lattice_order(points);
  if (distinct_.size() > 1) kind_.reserve(order.size());
  if (distinct_.size() > 1)
    for (const std::uint32_t n : order)
      kind_.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(distinct_, points.factors[n]) - distinct_.begin()));
  for (std::uint32_t n = 0; n < order.size(); ++n) {
    const Vec3& p = points.positions[order[n]];
    if (!run_first_.empty() && n - run_first_.back() < kLongestRun) {
      const Vec3 next(run_x_.back() + pitch_ * (n - run_first_.back()), run_y_.back(), run_z_.back());
      if (glm::length(p - next) < 1e-9 * pitch_) continue;
    }
    run_first_.push_back(n);
    run_x_.push_back(p.x);
    run_y_.push_back(p.y);
    run_z_.push_back(p.z);
  }
  run_first_.push_back(count_);
  for (std::size_t r = 0; r + 1 < run_first_.size(); ++r) {
    longest_ = std::max(longest_, run_first_[r + 1] - run_first_[r]);
    run_span_.push_back(static_cast<double>(run_first_[r + 1] - run_first_[r] - 1));
  }
  const std::size_t padded = (run_x_.size() + kRunPad - 1) / kRunPad * kRunPad;
  for (std::vector<double>* field : {&run_x_, &run_y_, &run_z_, &run_span_}) field->resize(padded, 0.0);
  for (std::vector<std::int32_t>* field : {&base_, &carry_x_, &carry_y_, &carry_z_, &inside_}) field->resize(padded);
  for (std::vector<std::int32_t>* field : {&step_offset_, &step_x_, &step_y_, &step_z_}) field->resize(longest_ + kStepPad);
  set_weights(std::vector<double>(distinct_.begin(), distinct_.end()));
}

std::size_t PointScatter::bytes() const noexcept {
  const auto of = [](const auto&... lists) { return ((lists.capacity() * sizeof(lists[0])) + ...); };
  return of(run_x_, run_y_, run_z_, run_span_, run_first_, distinct_, kind_, before_, step_offset_, step_x_, step_y_, step_z_, base_,
            carry_x_, carry_y_, carry_z_, inside_);
}

void PointScatter::set_weights(std::span<const double> weights) {
  BH_ASSERT(weights.size() == distinct_.size());
  if (weights.empty()) return;
  const double heaviest = *std::ranges::max_element(weights);
  // 38 bits for the largest weight: 2^25 points, more than a tool may have, still fit 63 bits.
  unit_ = heaviest > 0.0 ? std::ldexp(1.0, std::ilogb(heaviest) - 37) : 1.0;
  std::vector<std::uint64_t> whole;
  for (const double weight : weights) whole.push_back(static_cast<std::uint64_t>(weight / unit_ + 0.5));
  weight_ = whole.front();
  if (kind_.empty()) return;
  before_.resize(std::size_t{count_} + 1);
  before_[0] = 0;
  for (std::size_t n = 0; n < count_; ++n) before_[n + 1] = before_[n] + whole[kind_[n]];
}

std::uint64_t PointScatter::weight_before(std::uint32_t point) const noexcept { return before_.empty() ? weight_ * point : before_[point]; }

void PointScatter::measure_steps(const Vec3& along, const Vec3i& strides) {
  constexpr std::uint32_t kTurn = 0x80000000u;  // makes a signed compare order unsigned words
  const std::array<std::int32_t*, 3> fraction{step_x_.data(), step_y_.data(), step_z_.data()};
  for (std::uint32_t n = 0; n < longest_; ++n) {
    std::int64_t offset = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double way = along[axis] * n;
      const std::int64_t fixed = std::abs(way) < kFar ? to_fixed(way) : 0;  // a run of that length is never inside
      offset += (fixed >> 32) * strides[axis];
      fraction[axis][n] = static_cast<std::int32_t>(static_cast<std::uint32_t>(fixed) ^ kTurn);
    }
    step_offset_[n] = static_cast<std::int32_t>(offset);
  }
}

/// A run that may cross the border of the box, point by point.
std::uint32_t PointScatter::add_cut_run(std::size_t run, const Affine& window_from_tool, const VoxelBox& allowed, ExposureField& field,
                                        const Vec3i& corner) {
  const Vec3 first = window_from_tool * Vec3(run_x_[run], run_y_[run], run_z_[run]);
  const Vec3 along = window_from_tool.linear[0] * pitch_;
  const Vec3i size = field.box.size();
  std::uint32_t outside = 0;
  for (std::uint32_t n = run_first_[run]; n < run_first_[run + 1]; ++n) {
    const Vec3 way = along * static_cast<double>(n - run_first_[run]);
    bool near = true;
    Vec3i v(0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      near = near && std::abs(first[axis]) < kFar && std::abs(way[axis]) < kFar;
      if (near) v[axis] = static_cast<int>((to_fixed(first[axis]) + to_fixed(way[axis])) >> 32);
    }
    if (!near || !allowed.contains(v)) {
      ++outside;
      continue;
    }
    const Vec3i in = v - corner;
    const auto at = static_cast<std::size_t>((in.z * size.y + in.y) * size.x + in.x);
    field.sums[at] += static_cast<std::int64_t>(weight_before(n + 1) - weight_before(n));
  }
  return outside;
}

std::uint32_t PointScatter::add(const MasterWindow& window, const Affine& index_from_tool, ExposureField& field) {
  field.unit = unit_;
  field.box = {};
  if (count_ == 0) return 0;
  const VoxelBox erodible = window.erodible_box();
  const VoxelBox allowed{erodible.lo - window.box.lo, erodible.hi - window.box.lo};
  // Relative to the window's corner; cell = centre +- 1/2, so adding half a voxel makes floor the voxel.
  const Affine window_from_tool{index_from_tool.linear, index_from_tool.offset + 0.5 - Vec3(window.box.lo)};
  const auto [lo, hi] = bounds_under(window_from_tool, tool_bounds_);
  // One voxel of margin: corners and points round differently.
  const Vec3 least = glm::max(lo - 1.0, Vec3(allowed.lo)), most = glm::min(hi + 1.0, Vec3(allowed.hi));
  if (!glm::all(glm::lessThan(least, most))) return count_;
  const VoxelBox part{floor_int(least) + window.box.lo, glm::min(floor_int(most) + 1, allowed.hi) + window.box.lo};
  field.place(window, part);

  const Vec3i size = field.box.size(), strides(1, size.x, size.x * size.y), corner = field.box.lo - window.box.lo;
  const Vec3 along = index_from_tool.linear[0] * pitch_;
  measure_steps(along, strides);
  constexpr double kEdge = 1e-6;  // [voxels] far above rounding: runs closer to the border are tested point by point
  const StartArgs starts{run_x_.data(),
                         run_y_.data(),
                         run_z_.data(),
                         run_span_.data(),
                         run_x_.size(),
                         window_from_tool,
                         along,
                         Vec3(allowed.lo) + kEdge,
                         Vec3(allowed.hi) - kEdge,
                         strides,
                         corner,
                         base_.data(),
                         carry_x_.data(),
                         carry_y_.data(),
                         carry_z_.data(),
                         inside_.data()};
  HWY_DYNAMIC_DISPATCH(StartRuns)(starts);
  const std::size_t runs = run_first_.size() - 1;
  const RunArgs adds{run_first_.data(),
                     runs,
                     base_.data(),
                     carry_x_.data(),
                     carry_y_.data(),
                     carry_z_.data(),
                     inside_.data(),
                     step_offset_.data(),
                     step_x_.data(),
                     step_y_.data(),
                     step_z_.data(),
                     strides,
                     before_.empty() ? nullptr : before_.data(),
                     weight_,
                     field.sums.data()};
  HWY_DYNAMIC_DISPATCH(AddRuns)(adds);
  std::uint32_t outside = 0;
  for (std::size_t r = 0; r < runs; ++r)
    if (inside_[r] == 0) outside += add_cut_run(r, window_from_tool, allowed, field, corner);
  return outside;
}

}  // namespace burrhole
#endif  // HWY_ONCE
