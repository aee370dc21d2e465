#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/drill/strength_field.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/drill/strength_field.h"

// The plain twin of the look-up is in tests/core/drill/strength_field_test.cpp; TSan does not see gathers.

HWY_BEFORE_NAMESPACE();
namespace burrhole {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void LookUpRow(const StrengthRow& a) {
  const hn::CappedTag<std::int32_t, 8> d;
  const hn::CappedTag<std::int64_t, 8> dw;
  const hn::Rebind<std::int32_t, decltype(dw)> half;
  const auto zero = hn::Zero(d);
  std::int32_t found[8];
  for (std::int32_t i = a.from / 8 * 8; i < a.to; i += static_cast<std::int32_t>(hn::Lanes(d))) {
    const auto n = hn::Iota(d, i);
    const auto node = [&](std::size_t axis) {
      const auto at = hn::ShiftRight<16>(hn::Add(hn::Set(d, a.start[axis]), hn::Mul(n, hn::Set(d, a.step[axis]))));
      return hn::Min(hn::Max(at, zero), hn::Set(d, a.size[axis] - 1));
    };
    const auto at = hn::Add(hn::Mul(hn::Add(hn::Mul(node(2), hn::Set(d, a.size.y)), node(1)), hn::Set(d, a.size.x)), node(0));
    const auto inside = hn::And(hn::Gt(n, hn::Set(d, a.from - 1)), hn::Lt(n, hn::Set(d, a.to)));
    hn::StoreU(hn::IfThenElseZero(inside, hn::GatherIndex(d, a.table, at)), d, found);
    for (std::size_t p = 0; p < hn::Lanes(d); p += hn::Lanes(dw))
      hn::StoreU(hn::PromoteTo(dw, hn::LoadU(half, found + p)), dw, a.sums + static_cast<std::size_t>(i) + p);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burrhole
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burrhole {
HWY_EXPORT(LookUpRow);
namespace {

constexpr double kNodesPerVoxel = 3.0;
constexpr double kOne = 65536.0;  // of the fixed point

/// Voxels [from, to) of a row, start + n x step in nodes, that lie inside the table; one more on each side, since the kernel rounds otherwise.
std::pair<std::int32_t, std::int32_t> cut_row(const Vec3& start, const Vec3& step, const Vec3i& size, std::int32_t from, std::int32_t to) {
  double lo = from, hi = to;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double end = static_cast<double>(size[axis]);
    if (step[axis] == 0.0) {
      if (start[axis] < 0.0 || start[axis] >= end) return {from, from};
      continue;
    }
    const double a = -start[axis] / step[axis], b = (end - start[axis]) / step[axis];
    lo = std::max(lo, std::min(a, b));
    hi = std::min(hi, std::max(a, b));
  }
  if (!(lo < hi)) return {from, from};
  return {std::max(from, static_cast<std::int32_t>(lo) - 1), std::min(to, static_cast<std::int32_t>(hi) + 2)};
}

/// Nodes of one axis that a point reaches, and the share of its cube that a voxel centred there holds.
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
  // A coarser lattice where the tool is so large that the table would not fit: 64 million nodes.
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
}

void StrengthField::look_up(const MasterWindow& window, const Affine& index_from_tool, ExposureField& field) const {
  field.unit = unit_;
  field.box = {};
  if (table_.empty()) return;
  const Vec3 far = origin_ + spacing_ * Vec3(size_ - 1);
  Vec3 lo(1e300), hi(-1e300);
  for (int n = 0; n < 8; ++n) {
    const Vec3 p =
        index_from_tool * Vec3((n & 1) != 0 ? far.x : origin_.x, (n & 2) != 0 ? far.y : origin_.y, (n & 4) != 0 ? far.z : origin_.z);
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
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
  StrengthRow row{table_.data(), size_, Vec3i(0), floor_int(step * kOne + 0.5), 0, 0, field.sums.data()};
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j, row.sums += size.x) {
      const Vec3 at = (tool_from_index * Vec3(field.box.lo + Vec3i(0, j, k)) - origin_) / spacing_ + 0.5;  // floor is the nearest node
      std::tie(row.from, row.to) = cut_row(at, step, size_, from, to);
      row.start = floor_int(at * kOne);
      if (row.from < row.to) HWY_DYNAMIC_DISPATCH(LookUpRow)(row);
    }
}

}  // namespace burrhole
#endif  // HWY_ONCE
