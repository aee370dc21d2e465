#include "core/contact/packed_plane.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/contact/gradient_plane.h"
#include "core/contact/packed_plane_kernel.h"

namespace burrhole {
namespace {

std::uint32_t spread_bits(std::uint32_t x) noexcept {
  std::uint32_t out = 0;
  for (std::uint32_t bit = 0; bit < 10; ++bit) out |= ((x >> bit) & 1u) << (3 * bit);
  return out;
}

template <class T>
void set_rows(T (&rows)[3][3], const Mat3& m) noexcept {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) rows[r][c] = static_cast<T>(m[c][r]);
}
void set_rows(double (&rows)[3][4], const Affine& map) noexcept {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) rows[r][c] = map.linear[c][r];
    rows[r][3] = map.offset[r];
  }
}

/// Adds the upper half to the lower half until one element remains.
double total(double (&part)[kSums]) noexcept {
  for (int half = kSums / 2; half > 0; half /= 2)
    for (int n = 0; n < half; ++n) part[n] += part[n + half];
  return part[0];
}

}  // namespace

std::vector<std::uint32_t> morton_order(const std::vector<Vec3>& positions) {
  Vec3 lo(0.0), hi(0.0);
  if (!positions.empty()) lo = hi = positions.front();
  for (const Vec3& p : positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const Vec3 size = hi - lo;
  const double longest = std::max({size.x, size.y, size.z}), cells = longest > 0.0 ? 1023.0 / longest : 0.0;
  std::vector<std::uint32_t> code;
  for (const Vec3& p : positions) {
    const Vec3 cell = (p - lo) * cells;
    code.push_back(spread_bits(static_cast<std::uint32_t>(cell.x)) | spread_bits(static_cast<std::uint32_t>(cell.y)) << 1 |
                   spread_bits(static_cast<std::uint32_t>(cell.z)) << 2);
  }
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t n) { return code[n]; });
  return order;
}

PackedPlane::PackedPlane(const PointShell& shell) : count_(shell.size()), point_(morton_order(shell.positions)) {
  const std::size_t padded = (count_ + kPlanePad - 1) / kPlanePad * kPlanePad;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    position_[axis].assign(padded, 0.0);
    inward_[axis].assign(padded, 0.0f);
    for (std::size_t n = 0; n < count_; ++n) {
      position_[axis][n] = shell.positions[point_[n]][axis];
      inward_[axis][n] = static_cast<float>(shell.inward_normals[point_[n]][axis]);
    }
  }
}

void PackedPlane::evaluate(const GradientPlaneConfig& config, const ContactView& bone, const Pose& world_from_tool,
                           ContactResult& out) const noexcept {
  static_assert(kMaxShellPoints < (std::size_t{1} << kPointBits));
  const Affine tool = Affine::from_pose(world_from_tool);
  const Affine from_corner{Mat3(1.0), Vec3(bone.box().lo)};
  const Affine world_from_index = bone.world_from_index() * from_corner;
  Affine index_from_tool = bone.index_from_world() * tool;
  index_from_tool.offset -= Vec3(bone.box().lo);
  const Vec3i size = bone.box().size();
  PackedJob job{.words = reinterpret_cast<const std::int32_t*>(bone.words()),
                .size = {size.x, size.y, size.z},
                .row = size.x,
                .slab = size.x * size.y,
                .count = static_cast<int>(count_),
                .solid = config.paper_mode ? 1 : static_cast<std::int32_t>(kWordSolid),
                .trilinear = !config.paper_mode,
                .max_march = config.max_march,
                .max_ascent = config.max_ascent,
                .point = point_.data(),
                .listed = out.list_contacts};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    job.position[axis] = position_[axis].data();
    job.inward[axis] = inward_[axis].data();
    job.origin[axis] = world_from_tool.translation[axis];
  }
  set_rows(job.index_from_tool, index_from_tool);
  set_rows(job.world_from_index, world_from_index);
  set_rows(job.steps_from_tool, index_from_tool.linear);
  set_rows(job.way_from_index, world_from_index.linear);
  set_rows(job.normal_from_gradient, glm::transpose(bone.index_from_world().linear));
  set_rows(job.world_from_tool, tool.linear);

  PackedSums sums;
  evaluate_packed(job, sums, out);
  out.touching = sums.touching;
  out.deepest = static_cast<double>(*std::ranges::max_element(sums.deepest));
  if (out.touching == 0) return;
  // The average over colliding points, d = 0 included; eq. 2.
  const double share = config.stiffness / static_cast<double>(out.touching);
  double sum[12];
  for (int n = 0; n < 12; ++n) sum[n] = total(sums.part[n]) * share;
  out.wrench.force = {sum[0], sum[1], sum[2]};
  out.wrench.torque = {sum[3], sum[4], sum[5]};
  out.force_gradient = -Mat3(sum[6], sum[7], sum[8], sum[7], sum[9], sum[10], sum[8], sum[10], sum[11]);
}

}  // namespace burrhole
