#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/strength_field.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/base/bounds.h"

#include "core/drill/strength_field.h"

// The scalar reference of the look-up is in tests/core/drill/strength_field_test.cpp. TSan does not check gathers.

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D, class DW, class V>
HWY_INLINE void store_wide(D d, DW dw, V found, std::int64_t* out) {
  const hn::Rebind<std::int32_t, DW> part;
  if constexpr (hn::MaxLanes(d) == hn::MaxLanes(dw)) {
    hn::StoreU(hn::PromoteTo(dw, found), dw, out);
  } else {
    HWY_ALIGN std::int32_t lanes[8];
    hn::Store(found, d, lanes);
    for (std::size_t p = 0; p < hn::Lanes(d); p += hn::Lanes(dw)) hn::StoreU(hn::PromoteTo(dw, hn::LoadU(part, lanes + p)), dw, out + p);
  }
}

/// The table is passed by copy: the compiler then knows that stores do not change it.
void LookUpRows(const StrengthTable t, std::span<const StrengthRow> rows) {
  const hn::CappedTag<std::int32_t, 8> d;
  const hn::CappedTag<std::int64_t, 8> dw;
  using V = hn::Vec<decltype(d)>;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const V zero = hn::Zero(d), lane = hn::Iota(d, 0), slab = hn::Set(d, t.size.x * t.size.y), line = hn::Set(d, t.size.x);
  const V last_x = hn::Set(d, t.size.x - 1), last_y = hn::Set(d, t.size.y - 1), last_z = hn::Set(d, t.size.z - 1);
  const V step_x = hn::Mul(lane, hn::Set(d, t.step.x)), step_y = hn::Mul(lane, hn::Set(d, t.step.y)),
          step_z = hn::Mul(lane, hn::Set(d, t.step.z));
  const V far_x = hn::Set(d, lanes * t.step.x), far_y = hn::Set(d, lanes * t.step.y), far_z = hn::Set(d, lanes * t.step.z);
  const auto node = [&](V place, V last) { return hn::Min(hn::Max(hn::ShiftRight<16>(place), zero), last); };
  for (const StrengthRow& row : rows) {
    const std::int32_t from = row.from, to = row.to, first = from / 8 * 8;
    std::int64_t* const out = row.sums;
    V x = hn::Add(hn::Set(d, row.start.x + first * t.step.x), step_x), y = hn::Add(hn::Set(d, row.start.y + first * t.step.y), step_y),
      z = hn::Add(hn::Set(d, row.start.z + first * t.step.z), step_z);
    for (std::int32_t i = first; i < to; i += lanes) {
      const V n = hn::Add(lane, hn::Set(d, i));
      const V at = hn::Add(hn::Add(hn::Mul(node(z, last_z), slab), hn::Mul(node(y, last_y), line)), node(x, last_x));
      const auto inside = hn::And(hn::Gt(n, hn::Set(d, from - 1)), hn::Lt(n, hn::Set(d, to)));
      store_wide(d, dw, hn::IfThenElseZero(inside, hn::GatherIndex(d, t.table, at)), out + i);
      x = hn::Add(x, far_x);
      y = hn::Add(y, far_y);
      z = hn::Add(z, far_z);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(LookUpRows);
namespace {

constexpr double kNodesPerVoxel = 3.0;
constexpr double kOne = 65536.0;    // of the fixed point
constexpr double kRounding = 0.05;  // [nodes] bound on the error of the fixed point over the longest row

struct Stretch {
  double lo, hi;
  void keep(double from, double to) noexcept {
    lo = std::max(lo, from);
    hi = std::min(hi, to);
  }
};

/// Interval on a line start + n x step in which its first `axes` coordinates lie within a radius of 0; shared data of all lines of a pose.
class RoundCut {
 public:
  RoundCut(const Vec3& step, std::size_t axes, double radius) : step_(step), axes_(axes), radius_(radius) {
    for (std::size_t axis = 0; axis < axes; ++axis) square_ += step[axis] * step[axis];
    per_square_ = square_ > 1e-9 ? 1.0 / square_ : 0.0;
  }
  void keep(Stretch& part, const Vec3& start) const {
    double b = 0.0, c = -radius_ * radius_;
    for (std::size_t axis = 0; axis < axes_; ++axis) {
      b += step_[axis] * start[axis];
      c += start[axis] * start[axis];
    }
    const double under = b * b - square_ * c;
    // A line along the axis is completely inside or outside; it is not clipped.
    if (per_square_ == 0.0) return;
    if (under < 0.0) {
      part.hi = part.lo;
      return;
    }
    const double half = std::sqrt(under);
    part.keep((-b - half) * per_square_, (-b + half) * per_square_);
  }

 private:
  Vec3 step_;
  std::size_t axes_;
  double radius_, square_ = 0.0, per_square_ = 0.0;
};

}  // namespace

/// Clips rows of one pose to the part that may meet a node > 0.
class StrengthField::RowCut {
 public:
  RowCut(const StrengthField& field, const Vec3& step, std::int32_t from, std::int32_t to)
      : ball_(step, 3, field.ball_),
        tube_(step, 2, field.tube_),
        middle_(field.middle_),
        axis_(-field.origin_ / field.spacing_),
        lo_(Vec3(field.lo_) - 0.5 - kRounding),
        hi_(Vec3(field.hi_) - 0.5 + kRounding),
        from_(from),
        to_(to) {
    for (std::size_t axis = 0; axis < 3; ++axis) per_step_[axis] = std::abs(step[axis]) > 1e-9 ? 1.0 / step[axis] : 0.0;
  }
  [[nodiscard]] std::pair<std::int32_t, std::int32_t> operator()(const Vec3& start) const {
    Stretch part{static_cast<double>(from_), static_cast<double>(to_)};
    ball_.keep(part, start - middle_);
    if (!(part.lo < part.hi)) return {0, 0};
    tube_.keep(part, start - axis_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double lo = lo_[axis] - start[axis], hi = hi_[axis] - start[axis];
      if (per_step_[axis] != 0.0) {
        const double a = lo * per_step_[axis], b = hi * per_step_[axis];
        part.keep(std::min(a, b), std::max(a, b));
      } else if (lo > 0.0 || hi < 0.0) {
        return {0, 0};
      }
    }
    if (!(part.lo < part.hi)) return {0, 0};
    return {std::max(from_, static_cast<std::int32_t>(std::ceil(part.lo))),
            std::min(to_, static_cast<std::int32_t>(std::floor(part.hi)) + 1)};
  }

 private:
  RoundCut ball_, tube_;
  Vec3 middle_, axis_, lo_, hi_, per_step_{0.0};
  std::int32_t from_, to_;
};

namespace {

/// Nodes of one axis that a point reaches, and for each the share of its cube inside a voxel centred there.
struct Reach {
  int first = 0;
  std::array<double, 64> share{};
  int count = 0;
};

}  // namespace

StrengthField::StrengthField(const ErosionPoints& points, std::span<const double> weights, double voxel_edge)
    : spacing_(voxel_edge / kNodesPerVoxel), voxel_edge_(voxel_edge) {
  if (points.size() == 0) return;
  Vec3 lo = points.positions.front(), hi = lo;
  for (const Vec3& p : points.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const double margin = 0.5 * (voxel_edge + points.pitch) + 2.0 * spacing_;
  // A coarser lattice if the table would exceed 64 million nodes.
  const auto nodes = [&] { return glm::ceil((hi - lo + 2.0 * margin) / spacing_) + 1.0; };
  while (nodes().x * nodes().y * nodes().z > 0x1p26 || points.pitch + voxel_edge > 60.0 * spacing_) spacing_ *= 2.0;
  size_ = Vec3i(nodes());
  origin_ = lo - margin;
  std::vector<double> sums(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z), 0.0);
  const double reach = 0.5 * (voxel_edge + points.pitch);
  for (std::size_t n = 0; n < points.size(); ++n) {
    std::array<Reach, 3> near;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = points.positions[n][axis] - origin_[axis];
      Reach& r = near[axis];
      r.first = static_cast<int>(std::ceil((at - reach) / spacing_));
      const int last = static_cast<int>(std::floor((at + reach) / spacing_));
      for (int node = r.first; node <= last; ++node) {
        const double apart = std::abs(node * spacing_ - at);
        r.share[static_cast<std::size_t>(r.count++)] =
            std::clamp((reach - apart) / points.pitch, 0.0, std::min(1.0, voxel_edge / points.pitch));
      }
    }
    for (int k = 0; k < near[2].count; ++k)
      for (int j = 0; j < near[1].count; ++j) {
        const double across = weights[n] * near[2].share[static_cast<std::size_t>(k)] * near[1].share[static_cast<std::size_t>(j)];
        double* row = &sums[(static_cast<std::size_t>(near[2].first + k) * static_cast<std::size_t>(size_.y) +
                             static_cast<std::size_t>(near[1].first + j)) *
                                static_cast<std::size_t>(size_.x) +
                            static_cast<std::size_t>(near[0].first)];
        for (int i = 0; i < near[0].count; ++i) row[i] += across * near[0].share[static_cast<std::size_t>(i)];
      }
  }
  const double most = *std::ranges::max_element(sums);
  unit_ = most > 0.0 ? most * 0x1p-30 : 1.0;
  table_.reserve(sums.size());
  for (const double sum : sums) table_.push_back(static_cast<std::int32_t>(sum / unit_ + 0.5));
  measure_extent();
}

void StrengthField::measure_extent() {
  const VoxelBox all{Vec3i(0), size_};
  lo_ = size_;
  hi_ = Vec3i(0);
  for_each_voxel(all, [&](const Vec3i& v) {
    if (table_[all.offset_of(v)] == 0) return;
    lo_ = glm::min(lo_, v);
    hi_ = glm::max(hi_, v + 1);
  });
  middle_ = 0.5 * Vec3(lo_ + hi_ - 1);
  const Vec3 axis = -origin_ / spacing_;
  for_each_voxel(all, [&](const Vec3i& v) {
    if (table_[all.offset_of(v)] == 0) return;
    ball_ = std::max(ball_, glm::length(Vec3(v) - middle_));
    tube_ = std::max(tube_, std::hypot(v.x - axis.x, v.y - axis.y));
  });
  // A position uses the nearest node, at most half a node away on each axis.
  ball_ += 0.5 * std::sqrt(3.0) + kRounding;
  tube_ += 0.5 * std::sqrt(2.0) + kRounding;
}

void StrengthField::look_up(const MasterWindow& window, const Affine& index_from_tool, ExposureField& field) const {
  field.unit = unit_;
  field.box = {};
  if (table_.empty()) return;
  const Vec3 least_node = origin_ + spacing_ * (Vec3(lo_) - 1.0), most_node = origin_ + spacing_ * Vec3(hi_);
  auto [lo, hi] = bounds_under(index_from_tool, {least_node, most_node});
  // A ball is a box no wider than itself, however it is turned.
  const Vec3 middle = index_from_tool * (origin_ + spacing_ * middle_);
  const Mat3 rows = glm::transpose(index_from_tool.linear);
  const Vec3 wide = (ball_ + 1.0) * spacing_ * Vec3(glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2]));
  lo = glm::max(lo, middle - wide);
  hi = glm::min(hi, middle + wide);
  const VoxelBox allowed = window.erodible_box();
  const Vec3 least = glm::max(lo, Vec3(allowed.lo)), most = glm::min(hi + 1.0, Vec3(allowed.hi));
  if (!glm::all(glm::lessThan(least, most))) return;
  const VoxelBox part{floor_int(least), glm::min(floor_int(most), allowed.hi)};
  if (part.empty()) return;
  field.place(window, part);

  const Affine tool_from_index = index_from_tool.inverse();
  const Vec3 step = tool_from_index.linear[0] / spacing_;
  const Vec3i size = field.box.size();
  const std::int32_t from = part.lo.x - field.box.lo.x, to = part.hi.x - field.box.lo.x;
  const StrengthTable table{table_.data(), size_, floor_int(step * kOne + 0.5)};
  const RowCut cut(*this, step, from, to);
  std::array<StrengthRow, 64> found;
  std::size_t count = 0;
  std::int64_t* sums = field.sums.data();
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j, sums += size.x) {
      const Vec3 at = (tool_from_index * Vec3(field.box.lo + Vec3i(0, j, k)) - origin_) / spacing_;
      StrengthRow& row = found[count];
      std::tie(row.from, row.to) = cut(at);
      if (row.from >= row.to) continue;
      row.start = floor_int((at + 0.5) * kOne);  // floor is the nearest node
      row.sums = sums;
      if (++count < found.size()) continue;
      HWY_DYNAMIC_DISPATCH(LookUpRows)(table, found);
      count = 0;
    }
  HWY_DYNAMIC_DISPATCH(LookUpRows)(table, std::span(found).first(count));
}

}  // namespace burrhole
#endif  // HWY_ONCE
