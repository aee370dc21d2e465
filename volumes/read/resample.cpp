#include "volumes/read/resample.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "core/base/assert.h"
#include "core/base/parallel.h"

namespace burrhole {
namespace {

/// In the outer half of a border voxel there still is a value.
bool is_outside(double at, int size) { return at < -0.5 || at > size - 0.5; }

bool has_parallel_axes(const Mat3& linear) {
  for (std::size_t column = 0; column < 3; ++column)
    for (std::size_t row = 0; row < 3; ++row)
      if (column != row && linear[column][row] != 0.0) return false;
  return true;
}

}  // namespace

std::uint64_t resampler_bytes(const Scan& scan, int factor, const Affine& scan_from_grid) noexcept {
  const std::uint64_t planes = refined_bytes(scan, factor);
  if (has_parallel_axes(scan_from_grid.linear)) return planes;
  const Vec3i dims(scan.dims.x, scan.dims.y, (scan.dims.z - 1) * factor + 1);
  return planes + (factor > 1 ? sizeof(float) * VoxelBox{Vec3i(0), dims}.count() : 0) + QuietValues::bytes(dims);
}

Resampler::Resampler(const Scan& scan, const ResampleRule& rule, const Affine& scan_from_grid, const Vec3i& dims)
    : slices_(scan, rule.slices),
      scan_(&scan),
      scan_from_grid_(scan_from_grid),
      padded_(dims + 2),
      rule_(rule),
      aligned_(has_parallel_axes(scan_from_grid.linear)) {
  if (!aligned_) {
    prepare_any_axes();
    return;
  }
  // Offsets within a row, in rows of a layer, and in layers: a refined slice is interpolated on x, then y, then z.
  x_ = axis_of(0, 1);
  y_ = axis_of(1, padded_.x);
  z_ = axis_of(2, 1);
}

Resampler::Axis Resampler::axis_of(std::size_t axis, std::ptrdiff_t stride) const {
  Axis out;
  const int factor = axis == 2 ? slices_.factor() : 1, size = axis == 2 ? slices_.count() : scan_->dims[axis];
  for (int n = 0; n < padded_[axis]; ++n) {
    Vec3 place(0.0);
    place[axis] = n - 1;
    const double at = (scan_from_grid_ * place)[axis];
    out.at.emplace_back(factor * at, size, stride);
    out.outside.push_back(is_outside(at, scan_->dims[axis]) ? 1 : 0);
  }
  return out;
}

void Resampler::fill(int k_lo, int k_hi, std::span<float> out) {
  const int layers = k_hi - k_lo + 2;
  BH_ASSERT(out.size() == VoxelBox({Vec3i(0), {padded_.x, padded_.y, layers}}).count());
  if (aligned_)
    fill_aligned(k_lo, layers, out);
  else
    fill_each(k_lo, layers, out);
}

// ---- any axes: voxel by voxel ----

void Resampler::prepare_any_axes() {
  if (slices_.factor() > 1) {
    all_.reserve(VoxelBox{Vec3i(0), {scan_->dims.x, scan_->dims.y, slices_.count()}}.count());
    for (int n = 0; n < slices_.count(); ++n) {
      const std::span<const float> slice = slices_.slice(n);
      all_.insert(all_.end(), slice.begin(), slice.end());
    }
  }
  // A weight of the kernel changes so that a sum of values that differ by at most 1 changes by at most 1.5 per voxel; the sum across slices may
  // add 1.375 times what the others differ by.
  constexpr double kSlope = 1.5, kWeights = 1.375;
  Vec3 farthest(0.0);  // [voxels] step of the grid on the axes of the refined scan
  double steps = 0.0;
  for (std::size_t column = 0; column < 3; ++column) {
    const Vec3 step = glm::abs(scan_from_grid_.linear[column]) * Vec3(1.0, 1.0, slices_.factor());
    farthest = glm::max(farthest, step);
    steps += std::min(kSlope * (kWeights * (step.x + step.y) + step.z), kWeights);
  }
  // Six samples reach three voxels; a voxel of the grid is compared with the next, whose occupancy depends on that after the next.
  quiet_.emplace(values(), Vec3i(scan_->dims.x, scan_->dims.y, slices_.count()), Vec3i(glm::ceil(3.5 + 2.0 * farthest)),
                 QuietRule{rule_.middle, rule_.half_band, static_cast<double>(rule_.nothing), steps});
}

float Resampler::value_at(const Vec3& index) const {
  const Vec3i& dims = scan_->dims;
  if (is_outside(index.x, dims.x) || is_outside(index.y, dims.y) || is_outside(index.z, dims.z)) return rule_.nothing;
  const std::ptrdiff_t row = dims.x, layer = row * dims.y;
  const Vec3 place(index.x, index.y, slices_.factor() * index.z);
  const std::span<const float> from = values();
  const Vec3i nearest = glm::clamp(Vec3i(glm::floor(place + 0.5)), Vec3i(0), Vec3i(dims.x, dims.y, slices_.count()) - 1);
  if (quiet_->at(nearest)) return std::numeric_limits<float>::quiet_NaN();
  const CubicAxis x(place.x, dims.x, 1), y(place.y, dims.y, row), z(place.z, slices_.count(), layer);
  // The six slices side by side, in lanes.
  constexpr std::size_t kLanes = 8;
  std::array<float, kCubicTaps * kCubicTaps * kLanes> samples{};
  std::array<float, kCubicTaps * kLanes> lines;
  std::array<float, kLanes> planes;
  for (std::size_t j = 0; j < kCubicTaps; ++j)
    for (std::size_t k = 0; k < kCubicTaps; ++k) {
      const float* v = from.data() + z.offset[k] + y.offset[j];
      for (std::size_t i = 0; i < kCubicTaps; ++i) samples[(j * kCubicTaps + i) * kLanes + k] = v[x.offset[i]];
    }
  for (std::size_t j = 0; j < kCubicTaps; ++j)
    limited_sums<kLanes>(x.weight, samples.data() + j * kCubicTaps * kLanes, lines.data() + j * kLanes);
  limited_sums<kLanes>(y.weight, lines.data(), planes.data());
  float sum = 0.0f;
  for (std::size_t k = 0; k < kCubicTaps; ++k) sum += z.weight[k] * planes[k];
  return sum;
}

void Resampler::fill_each(int k_lo, int layers, std::span<float> out) const {
  for_each_number(layers * padded_.y, [&](int n) {
    const int j = n % padded_.y, k = n / padded_.y;
    float* row = out.data() + static_cast<std::size_t>(n) * static_cast<std::size_t>(padded_.x);
    for (int i = 0; i < padded_.x; ++i) row[i] = value_at(scan_from_grid_ * Vec3(i - 1, j - 1, k_lo + k - 1));
  });
}

// ---- parallel axes: axis by axis ----

void Resampler::make_layer(int index, Layer& layer) {
  const auto width = static_cast<std::size_t>(padded_.x);
  layer.index = index;
  layer.values.resize(width * static_cast<std::size_t>(padded_.y));
  std::vector<float> rows(width * static_cast<std::size_t>(scan_->dims.y));
  const float* slice = slices_.slice(index).data();
  for_each_number(scan_->dims.y, [&](int j) {
    const float* from = slice + static_cast<std::ptrdiff_t>(j) * scan_->dims.x;
    float* to = rows.data() + static_cast<std::size_t>(j) * width;
    for (std::size_t i = 0; i < width; ++i) {
      const CubicAxis& x = x_.at[i];
      to[i] = limited_sum(x.weight, [&](std::size_t n) { return from[x.offset[n]]; });
    }
  });
  for_each_number(padded_.y, [&](int j) {
    const CubicAxis& y = y_.at[static_cast<std::size_t>(j)];
    float* to = layer.values.data() + static_cast<std::size_t>(j) * width;
    std::array<const float*, kCubicTaps> from;
    for (std::size_t n = 0; n < kCubicTaps; ++n) from[n] = rows.data() + y.offset[n];
    for (std::size_t i = 0; i < width; ++i) to[i] = limited_sum(y.weight, [&](std::size_t n) { return from[n][i]; });
  });
}

const Resampler::Layer& Resampler::layer_of(int index) const {
  return *std::find_if(layers_.begin(), layers_.end(), [&](const Layer& layer) { return layer.index == index; });
}

void Resampler::fill_aligned(int k_lo, int layers, std::span<float> out) {
  std::vector<int> needed;
  for (int k = 0; k < layers; ++k) {
    const auto n = static_cast<std::size_t>(k_lo + k);
    if (z_.outside[n] == 0)
      for (const std::ptrdiff_t offset : z_.at[n].offset) needed.push_back(static_cast<int>(offset));
  }
  const auto is_needed = [&](int index) { return std::find(needed.begin(), needed.end(), index) != needed.end(); };
  std::erase_if(layers_, [&](const Layer& layer) { return !is_needed(layer.index); });
  for (const int index : needed)
    if (std::none_of(layers_.begin(), layers_.end(), [&](const Layer& layer) { return layer.index == index; }))
      make_layer(index, layers_.emplace_back());

  const auto width = static_cast<std::size_t>(padded_.x);
  for_each_number(layers * padded_.y, [&](int n) {
    const auto j = static_cast<std::size_t>(n % padded_.y), k = static_cast<std::size_t>(k_lo + n / padded_.y);
    float* row = out.data() + static_cast<std::size_t>(n) * width;
    if (y_.outside[j] != 0 || z_.outside[k] != 0) {
      std::fill_n(row, width, rule_.nothing);
      return;
    }
    const CubicAxis& z = z_.at[k];
    std::array<const float*, kCubicTaps> from;
    for (std::size_t m = 0; m < kCubicTaps; ++m) from[m] = layer_of(static_cast<int>(z.offset[m])).values.data() + j * width;
    for (std::size_t i = 0; i < width; ++i) {
      float sum = 0.0f;
      for (std::size_t m = 0; m < kCubicTaps; ++m) sum += z.weight[m] * from[m][i];
      row[i] = sum;
    }
    for (std::size_t i = 0; i < width; ++i)
      if (x_.outside[i] != 0) row[i] = rule_.nothing;
  });
}

}  // namespace burrhole
