#include "core/debris/debris_site.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/random.h"
#include "core/base/rounded.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr double kStep = 0.5;   // [voxels] between places that are tested on a way
constexpr int kHalvings = 3;    // of the last step: to 1/16 of a voxel
constexpr double kLower = 0.5;  // [cells] by which a neighbour must be lower

}  // namespace

VoxelBox DebrisSite::voxels_in(const Bounds& box, const Affine& bone_from_index, const VoxelBox& grid) noexcept {
  const auto [lo, hi] = bounds_under(bone_from_index.inverse(), box);
  return VoxelBox{floor_int(lo), floor_int(hi) + 2}.intersect(grid);
}

Result<DebrisSite> DebrisSite::create(const Bounds& box, const Affine& bone_from_index, const VoxelBox& grid, double cell,
                                      const Vec3& down) {
  const Vec3 size = (box.hi - box.lo) / cell;
  const bool has_size = std::isfinite(size.x + size.y + size.z) && cell > 0.0 && std::min({size.x, size.y, size.z}) > 0.0;
  if (!has_size || size.x * size.y * size.z > static_cast<double>(kMostCells))
    return Error{ErrorCode::out_of_range, "the site of the chips has no size, or too many cells", {}};
  DebrisSite out;
  out.box_ = box;
  out.bone_from_index_ = bone_from_index;
  out.index_from_bone_ = bone_from_index.inverse();
  out.voxels_ = voxels_in(box, bone_from_index, grid);
  out.cell_ = cell;
  out.per_cell_ = 1.0 / cell;
  out.capacity_ = static_cast<float>(out.cell_volume());
  const Mat3& edges = bone_from_index.linear;
  out.shortest_ = std::min({glm::length(edges[0]), glm::length(edges[1]), glm::length(edges[2])});
  out.down_ = glm::normalize(down);
  out.cell_box_ = {Vec3i(0), floor_int(size) + 1};
  out.solid_.assign(out.voxels_.count(), 0);
  out.fill_.assign(out.cell_box_.count(), 0.0f);
  return out;
}

void DebrisSite::set_floor(const VoxelBox& part, std::span<const std::uint8_t> soft) noexcept {
  const VoxelBox inside = part.intersect(voxels_);
  for_each_voxel(inside, [&](const Vec3i& v) {
    if (soft[part.offset_of(v)] != 0) solid_[voxels_.offset_of(v)] = kSoft;
  });
  changed_ = changed_.unite(inside);
}

double DebrisSite::loss_of(const VoxelBox& part, std::span<const float> density) const noexcept {
  std::int64_t sum = 0;
  for_each_row(part, solid_.data(), density, [&](const Vec3i&, std::span<const std::uint8_t> solid, std::span<const float> row) {
    int lost = 0;
    for (std::size_t n = 0; n < row.size(); ++n) {
      const int before = solid[n], now = rounded(kWhole * row[n]);
      lost += before != kSoft && now < before ? before - now : 0;
    }
    sum += lost;
  });
  return static_cast<double>(sum);
}

void DebrisSite::set_bone(const VoxelBox& part, std::span<const float> density, LossSampler* sampler) noexcept {
  for_each_row(part, solid_.data(), density, [&](const Vec3i& first, std::span<std::uint8_t> solid, std::span<const float> row) {
    int differ = 0;
    for (std::size_t n = 0; n < row.size(); ++n) differ += solid[n] != kSoft && rounded(kWhole * row[n]) != solid[n] ? 1 : 0;
    if (differ == 0) return;
    changed_ = changed_.unite({first, first + Vec3i(static_cast<int>(row.size()), 1, 1)});
    for (std::size_t n = 0; n < row.size(); ++n) {
      const auto now = static_cast<std::uint8_t>(rounded(kWhole * row[n]));
      if (solid[n] == kSoft) continue;
      if (sampler != nullptr && now < solid[n]) sampler->add(first + Vec3i(static_cast<int>(n), 0, 0), solid[n] - now, now);
      solid[n] = now;
    }
  });
}

std::optional<Bounds> DebrisSite::take_changed() noexcept {
  const VoxelBox changed = std::exchange(changed_, VoxelBox{});
  if (changed.empty()) return std::nullopt;
  // A voxel counts in the cells beside it; one more for rounding.
  return bounds_under(bone_from_index_, {Vec3(changed.lo) - 2.0, Vec3(changed.hi) + 1.0});
}

std::uint8_t DebrisSite::bone_at(const Vec3i& voxel) const noexcept {
  if (!voxels_.contains(voxel)) return 0;
  const std::uint8_t value = solid_[voxels_.offset_of(voxel)];
  return value == kSoft ? std::uint8_t{0} : value;
}

double DebrisSite::level(const Vec3& p) const noexcept {
  const Vec3 index = index_from_bone_ * p;
  const Vec3i base = floor_int(index);
  if (base.x < voxels_.lo.x - 1 || base.y < voxels_.lo.y - 1 || base.z < voxels_.lo.z - 1 || base.x >= voxels_.hi.x ||
      base.y >= voxels_.hi.y || base.z >= voxels_.hi.z)
    return 0.0;
  const Vec3 t = index - Vec3(base);
  if (!voxels_.contains(base) || !voxels_.contains(base + 1))
    return trilinear(t, [&](unsigned n) { return value(base + cell_corner(n)); }) / static_cast<double>(kWhole);
  const Vec3i size = voxels_.size();
  const std::uint8_t* const first = solid_.data() + voxels_.offset_of(base);
  const std::ptrdiff_t row = size.x, slab = row * size.y;
  return trilinear(t, [&](unsigned n) { return static_cast<double>(first[corner_offset(n, row, slab)]); }) / static_cast<double>(kWhole);
}

double DebrisSite::free_share(const Vec3& from, const Vec3& to) const noexcept {
  if (is_blocked(from)) return 0.0;
  const Vec3 way = to - from;
  const double steps = std::ceil(glm::length(way) / (kStep * shortest_));
  if (!(steps > 0.0)) return 1.0;
  for (std::uint64_t n = 1; static_cast<double>(n) <= steps; ++n) {
    double free = static_cast<double>(n - 1) / steps, blocked = static_cast<double>(n) / steps;
    const Vec3 place = from + way * blocked;
    if (!contains(place)) return 1.0;  // beyond the site nothing blocks
    if (!is_blocked(place)) continue;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (free + blocked);
      (is_blocked(from + way * middle) ? blocked : free) = middle;
    }
    return free;
  }
  return 1.0;
}

std::optional<Vec3> DebrisSite::slide_from(const Vec3& p, std::uint64_t salt) const noexcept {
  const Vec3i here = cell_place(p);
  std::optional<Vec3> best;
  double lowest = kLower;
  std::uint64_t alike = 0;
  for_each_voxel({here - 1, here + 2}, [&](const Vec3i& there) {
    const double lower = glm::dot(Vec3(there - here), down_);
    if (lower < lowest || !cell_box_.contains(there) || is_full(cell_box_.offset_of(there))) return;
    const Vec3 centre = box_.lo + (Vec3(there) + 0.5) * cell_;
    if (is_in_bit(centre) || free_share(p, centre) < 1.0) return;
    // Of n alike, the last is chosen with the chance 1/n: each has the same chance in the end.
    alike = lower > lowest ? 1 : alike + 1;
    lowest = lower;
    if (!best || mix64(salt + alike) % alike == 0) best = centre;
  });
  return best;
}

void DebrisSite::change_pile(const Vec3& p, std::size_t cell, double volume, float sign) noexcept {
  const double whole = static_cast<double>(capacity_);
  double left = volume;
  for (int n = 0; left > 0.0 && cell != kNowhere;) {
    fill_[cell] = sign == 0.0f ? 0.0f : fill_[cell] + sign * static_cast<float>(std::min(left, whole));
    left -= whole;
    if (++n == kMostPiled || !(left > 0.0)) return;
    cell = cell_of(p - static_cast<double>(n) * cell_ * down_);
  }
}

std::size_t DebrisSite::cell_of(const Vec3& p) const noexcept {
  const Vec3i cell = cell_place(p);
  return cell_box_.contains(cell) ? cell_box_.offset_of(cell) : kNowhere;
}

}  // namespace burrhole
