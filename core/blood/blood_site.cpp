#include "core/blood/blood_site.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/assert.h"
#include "core/base/portable_math.h"
#include "core/base/rounded.h"

namespace burrhole {
namespace {

constexpr std::uint16_t kNone = 65535;
constexpr float kCut = 1e-3f;                  // [-] less density than this was not taken away by a tool
constexpr std::uint8_t kOwn = 1, kBeside = 2;  // of is_new_
constexpr std::uint8_t kNewWax = 2;            // of waxed_, while wax is applied: a source that it closes
constexpr float kFace = 0.5f;                  // [-] density at the face of bone
constexpr Vec3i kNeighbours[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

}  // namespace

BloodSite::BloodSite(SiteBone bone) : bone_(std::move(bone)) {
  const VoxelBox& box = bone_.box;
  const std::size_t count = box.count();
  BH_ASSERT(count > 0 && bone_.whole.size() == count && bone_.start.size() == count && bone_.pores.size() == count &&
            bone_.outside.size() == count);
  const Mat3& linear = bone_.bone_from_index.linear;
  bone_from_slope_ = glm::transpose(glm::inverse(linear));
  cell_ = bone_.bone_from_index.cell_volume();
  for (int axis = 0; axis < 3; ++axis) up_index_[axis] = -glm::dot(bone_.down, linear[axis]);
  up_offset_ = -glm::dot(bone_.down, bone_.bone_from_index.offset);
  height_ = std::max({std::abs(up_index_.x), std::abs(up_index_.y), std::abs(up_index_.z)});
  Vec3 low(box.lo), high(box.hi - 1);
  for (int axis = 0; axis < 3; ++axis)
    if (up_index_[axis] < 0.0) std::swap(low[axis], high[axis]);
  lowest_ = height_of(low) - 0.5 * height_;
  layers_.resize(static_cast<std::size_t>((height_of(high) - lowest_) / height_) + 2);
  layer_.resize(count);
  rim_.assign(count, kNone);
  removed_.assign(count, 0);
  area_.assign(count, 0.0f);
  opened_.assign(count, 0.0);
  cut_.assign(count, 0.0f);
  waxed_.assign(count, 0);
  seen_.assign(box.grown(1).count(), std::numeric_limits<float>::quiet_NaN());
  is_new_.assign(count, kOwn | kBeside);
  for_each_voxel(box, [&](const Vec3i& voxel) {
    layer_[box.offset_of(voxel)] = static_cast<std::uint16_t>((height_of(Vec3(voxel)) - lowest_) / height_);
  });
  for_each_voxel(box, [&](const Vec3i& voxel) {
    const std::size_t at = box.offset_of(voxel);
    for (const Vec3i& step : kNeighbours)
      if (box.contains(voxel + step) && bone_.outside[box.offset_of(voxel + step)] != 0)
        rim_[at] = std::min(rim_[at], std::max(layer_[at], layer_[box.offset_of(voxel + step)]));
  });
  has_pores_ = std::ranges::any_of(bone_.pores, [](float share) { return share > 0.0f; });
  measure();
}

void BloodSite::update(const VoxelBox& changed, std::span<const float> density, double now, double coagulation) noexcept {
  BH_ASSERT(bone_.box.contains(changed));
  const VoxelBox of = changed.grown(1);
  note_changes(of, density);
  const auto length = static_cast<std::size_t>(changed.hi.x - changed.lo.x);
  for (int k = changed.lo.z; k < changed.hi.z; ++k)
    for (int j = changed.lo.y; j < changed.hi.y; ++j) {
      const std::size_t first = bone_.box.offset_of({changed.lo.x, j, k});
      const auto row = std::span(is_new_).subspan(first, length);
      unsigned any = 0;
      for (const std::uint8_t one : row) any |= one;
      if (any == 0) continue;
      for (std::size_t n = 0; n < length; ++n) {
        const std::size_t at = first + n;
        const unsigned what = std::exchange(row[n], std::uint8_t{0});
        if (what == 0) continue;
        const Vec3i voxel(changed.lo.x + static_cast<int>(n), j, k);
        if ((what & kOwn) != 0) set_removed(at, density[of.offset_of(voxel)]);
        if (bone_.pores[at] > 0.0f) set_source(at, was_cut(of, density, voxel) ? cut_area(of, density, voxel) : 0.0, now, coagulation);
      }
    }
  measure();
}

void BloodSite::note_changes(const VoxelBox& of, std::span<const float> density) noexcept {
  const VoxelBox& box = bone_.box;
  const VoxelBox wide = box.grown(1), inner = box.grown(-1);
  const std::ptrdiff_t line = box.size().x, slab = line * box.size().y;
  const auto length = static_cast<std::size_t>(of.hi.x - of.lo.x);
  for (int k = of.lo.z; k < of.hi.z; ++k)
    for (int j = of.lo.y; j < of.hi.y; ++j) {
      const float* const row = density.data() + of.offset_of({of.lo.x, j, k});
      float* const seen = seen_.data() + wide.offset_of({of.lo.x, j, k});
      if (std::memcmp(row, seen, length * sizeof(float)) == 0) continue;
      for (std::size_t n = 0; n < length; ++n) {
        if (row[n] == seen[n]) continue;
        seen[n] = row[n];
        const Vec3i voxel(of.lo.x + static_cast<int>(n), j, k);
        if (inner.contains(voxel)) {
          std::uint8_t* const here = is_new_.data() + box.offset_of(voxel);
          *here |= kOwn;
          for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, line, slab}) {
            here[step] |= kBeside;
            here[-step] |= kBeside;
          }
          continue;
        }
        if (box.contains(voxel)) is_new_[box.offset_of(voxel)] |= kOwn;
        for (const Vec3i& step : kNeighbours)
          if (box.contains(voxel + step)) is_new_[box.offset_of(voxel + step)] |= kBeside;
      }
    }
}

void BloodSite::set_removed(std::size_t at, float density) noexcept {
  const float gone = std::clamp(bone_.whole[at] - density, 0.0f, 1.0f);
  const auto now = static_cast<std::uint16_t>(rounded(gone * static_cast<float>(kWhole)));
  if (now == removed_[at]) return;
  Layer& layer = layers_[layer_[at]];
  layer.removed += static_cast<std::int64_t>(now) - removed_[at];
  // A voxel is part of the hole where the larger half of its bone is gone.
  const auto of_hole = [&](std::uint16_t removed) {
    return bone_.whole[at] >= 0.5f && 2.0f * static_cast<float>(removed) > bone_.whole[at] * static_cast<float>(kWhole);
  };
  if (rim_[at] != kNone)
    layers_[rim_[at]].rim += static_cast<std::int64_t>(of_hole(now)) - static_cast<std::int64_t>(of_hole(removed_[at]));
  removed_[at] = now;
}

void BloodSite::set_source(std::size_t at, double area, double now, double coagulation) noexcept {
  const auto cut = static_cast<float>(area);
  if (cut == cut_[at]) return;
  Layer& layer = layers_[layer_[at]];
  const auto pores = static_cast<float>(area * static_cast<double>(bone_.pores[at]));
  const auto before = static_cast<double>(area_[at]);
  cut_spongy_ += static_cast<double>(cut) - static_cast<double>(cut_[at]);
  if (waxed_[at] != 0) {
    waxed_pores_ += static_cast<double>(pores) - before;
  } else {
    if (before > 0.0) layer.pores -= before * left_after((now - opened_[at]) / coagulation);
    opened_[at] = now;
    layer.pores += static_cast<double>(pores);
    layer.sources += static_cast<std::int64_t>(pores > 0.0f) - static_cast<std::int64_t>(before > 0.0);
    open_pores_ += static_cast<double>(pores) - before;
    if (layer.sources == 0) layer.pores = 0.0;
    layer.pores = std::max(layer.pores, 0.0);
  }
  cut_[at] = cut;
  area_[at] = pores;
}

double BloodSite::left_after(double age) noexcept {
  if (age != last_age_) {
    last_age_ = age;
    left_ = portable_exp(-age);
  }
  return left_;
}

double BloodSite::cut_area(const VoxelBox& of, std::span<const float> density, const Vec3i& voxel) const noexcept {
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i step(0);
    step[axis] = 1;
    slope[axis] =
        0.5 * (static_cast<double>(density[of.offset_of(voxel + step)]) - static_cast<double>(density[of.offset_of(voxel - step)]));
  }
  return glm::length(bone_from_slope_ * slope) * cell_;
}

bool BloodSite::was_cut(const VoxelBox& of, std::span<const float> density, const Vec3i& voxel) const noexcept {
  const auto gone = [&](const Vec3i& v) { return bone_.start[bone_.box.offset_of(v)] - density[of.offset_of(v)] > kCut; };
  if (gone(voxel)) return true;
  return std::ranges::any_of(kNeighbours, [&](const Vec3i& step) { return bone_.box.contains(voxel + step) && gone(voxel + step); });
}

void BloodSite::decay(double factor) noexcept {
  for (Layer& layer : layers_) layer.pores *= factor;
}

double BloodSite::wax(double depth) noexcept {
  const double closed = open_pores_;
  const VoxelBox& box = bone_.box;
  for_each_voxel(box, [&](const Vec3i& voxel) {
    const std::size_t at = box.offset_of(voxel);
    if (area_[at] > 0.0f && waxed_[at] == 0) waxed_[at] = kNewWax;
  });
  for_each_voxel(box, [&](const Vec3i& voxel) {
    if (waxed_[box.offset_of(voxel)] == kNewWax) fill_pores(voxel, depth);
  });
  for (std::uint8_t& one : waxed_) one = one != 0 ? 1 : 0;
  for (Layer& layer : layers_) {
    layer.pores = 0.0;
    layer.sources = 0;
  }
  waxed_pores_ += closed;
  open_pores_ = 0.0;
  return closed;
}

void BloodSite::fill_pores(const Vec3i& source, double depth) noexcept {
  const VoxelBox& box = bone_.box;
  const VoxelBox wide = box.grown(1);
  const Mat3& linear = bone_.bone_from_index.linear;
  Vec3i reach;
  for (int axis = 0; axis < 3; ++axis) reach[axis] = static_cast<int>(depth / glm::length(linear[axis])) + 1;
  const float here = seen_[wide.offset_of(source)];
  for (const Vec3i& step : kNeighbours) {
    const float there = seen_[wide.offset_of(source + step)];
    if (!(here >= kFace && there < kFace)) continue;
    const Vec3 face = Vec3(source) + Vec3(step) * static_cast<double>((here - kFace) / (here - there));
    for_each_voxel(VoxelBox{source - reach, source + reach + 1}.intersect(box), [&](const Vec3i& near) {
      const std::size_t at = box.offset_of(near);
      if (waxed_[at] == 0 && bone_.pores[at] > 0.0f && glm::length(linear * (Vec3(near) - face)) <= depth) waxed_[at] = 1;
    });
  }
}

void BloodSite::unwax(double now, double coagulation) noexcept {
  for (std::size_t at = 0; at < waxed_.size(); ++at) {
    if (waxed_[at] == 0) continue;
    waxed_[at] = 0;
    if (!(area_[at] > 0.0f)) continue;
    const auto pores = static_cast<double>(area_[at]);
    layers_[layer_[at]].pores += pores * portable_exp(-(now - opened_[at]) / coagulation);
    ++layers_[layer_[at]].sources;
    waxed_pores_ -= pores;
    open_pores_ += pores;
  }
}

double BloodSite::drive(double pressure, double level, double weight) const noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < layers_.size(); ++n) {
    if (layers_[n].sources == 0) continue;
    const double above = std::max(0.0, level - (bottom_of(n) + 0.5 * height_));
    sum += layers_[n].pores * std::max(0.0, pressure - weight * above);
  }
  return sum;
}

std::optional<double> BloodSite::lowest_source() const noexcept {
  for (std::size_t n = 0; n < layers_.size(); ++n)
    if (layers_[n].sources > 0) return bottom_of(n) + 0.5 * height_;
  return std::nullopt;
}

void BloodSite::measure() noexcept {
  const auto first = std::ranges::find_if(layers_, [](const Layer& layer) { return layer.removed > 0; });
  floor_ = first == layers_.end() ? lowest_ : bottom_of(static_cast<std::size_t>(first - layers_.begin()));
  const auto rim = std::ranges::find_if(layers_, [](const Layer& layer) { return layer.rim > 0; });
  spill_ = std::max(floor_, bottom_of(static_cast<std::size_t>(rim - layers_.begin())));
  capacity_ = volume_below(spill_);
}

double BloodSite::volume_below(double height) const noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < layers_.size() && bottom_of(n) < height; ++n)
    sum += static_cast<double>(layers_[n].removed) * std::min(1.0, (height - bottom_of(n)) / height_);
  return sum * cell_ / kWhole;
}

double BloodSite::level_of(double volume) const noexcept {
  double left = volume / cell_ * kWhole;
  if (!(left > 0.0)) return floor_;
  for (std::size_t n = 0; n < layers_.size() && bottom_of(n) < spill_; ++n) {
    const auto here = static_cast<double>(layers_[n].removed);
    if (left <= here) return std::min(spill_, bottom_of(n) + (here > 0.0 ? height_ * left / here : 0.0));
    left -= here;
  }
  return spill_;
}

double BloodSite::area_at(double height) const noexcept {
  const double place = (height - lowest_) / height_;
  if (place < 0.0) return 0.0;
  // A height on a border belongs to the layer below, which is full up to it.
  const auto n = static_cast<std::size_t>(std::max(0.0, std::ceil(place) - 1.0));
  return n < layers_.size() ? static_cast<double>(layers_[n].removed) * cell_ / kWhole / height_ : 0.0;
}

}  // namespace burrhole
