#include "volumes/read/resample.h"

#include <algorithm>

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

CubicAxis::CubicAxis(double at, int size, std::ptrdiff_t stride) {
  const double p = std::clamp(at, 0.0, static_cast<double>(size - 1));
  const int base = std::min(static_cast<int>(p), std::max(size - 2, 0));
  const double t = p - base, t2 = t * t, t3 = t2 * t;
  weight = {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t), 0.5 * (t3 - t2)};
  for (std::size_t n = 0; n < 4; ++n) offset[n] = stride * std::clamp(base + static_cast<int>(n) - 1, 0, size - 1);
}

Resampler::Resampler(const Scan& scan, const Affine& scan_from_grid, const Vec3i& dims, float nothing)
    : scan_(&scan),
      scan_from_grid_(scan_from_grid),
      padded_(dims + 2),
      nothing_(nothing),
      aligned_(has_parallel_axes(scan_from_grid.linear)) {
  if (!aligned_) return;
  // Offsets within a row, in rows of a layer, and in layers: a layer is interpolated on x, then y, then z.
  x_ = axis_of(0, 1);
  y_ = axis_of(1, padded_.x);
  z_ = axis_of(2, 1);
}

Resampler::Axis Resampler::axis_of(std::size_t axis, std::ptrdiff_t stride) const {
  Axis out;
  for (int n = 0; n < padded_[axis]; ++n) {
    Vec3 place(0.0);
    place[axis] = n - 1;
    const double at = (scan_from_grid_ * place)[axis];
    out.at.emplace_back(at, scan_->dims[axis], stride);
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

float Resampler::value_at(const Vec3& index) const {
  const Vec3i& dims = scan_->dims;
  if (is_outside(index.x, dims.x) || is_outside(index.y, dims.y) || is_outside(index.z, dims.z)) return nothing_;
  const std::ptrdiff_t row = dims.x, layer = row * dims.y;
  const CubicAxis x(index.x, dims.x, 1), y(index.y, dims.y, row), z(index.z, dims.z, layer);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    double plane = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
      const float* v = scan_->values.data() + z.offset[k] + y.offset[j];
      double line = 0.0;
      for (std::size_t i = 0; i < 4; ++i) line += x.weight[i] * static_cast<double>(v[x.offset[i]]);
      plane += y.weight[j] * line;
    }
    sum += z.weight[k] * plane;
  }
  return static_cast<float>(sum);
}

void Resampler::fill_each(int k_lo, int layers, std::span<float> out) const {
  for_each_number(layers * padded_.y, [&](int n) {
    const int j = n % padded_.y, k = n / padded_.y;
    float* row = out.data() + static_cast<std::size_t>(n) * static_cast<std::size_t>(padded_.x);
    for (int i = 0; i < padded_.x; ++i) row[i] = value_at(scan_from_grid_ * Vec3(i - 1, j - 1, k_lo + k - 1));
  });
}

// ---- parallel axes: axis by axis ----

void Resampler::make_layer(int index, Layer& layer) const {
  const auto width = static_cast<std::size_t>(padded_.x);
  layer.index = index;
  layer.values.resize(width * static_cast<std::size_t>(padded_.y));
  std::vector<double> rows(width * static_cast<std::size_t>(scan_->dims.y));
  for_each_number(scan_->dims.y, [&](int j) {
    const float* from = scan_->values.data() + VoxelBox{Vec3i(0), scan_->dims}.offset_of({0, j, index});
    double* to = rows.data() + static_cast<std::size_t>(j) * width;
    for (std::size_t i = 0; i < width; ++i) {
      const CubicAxis& x = x_.at[i];
      double line = 0.0;
      for (std::size_t n = 0; n < 4; ++n) line += x.weight[n] * static_cast<double>(from[x.offset[n]]);
      to[i] = line;
    }
  });
  for_each_number(padded_.y, [&](int j) {
    const CubicAxis& y = y_.at[static_cast<std::size_t>(j)];
    double* to = layer.values.data() + static_cast<std::size_t>(j) * width;
    for (std::size_t i = 0; i < width; ++i) {
      double plane = 0.0;
      for (std::size_t n = 0; n < 4; ++n) plane += y.weight[n] * rows[static_cast<std::size_t>(y.offset[n]) + i];
      to[i] = plane;
    }
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
      std::fill_n(row, width, nothing_);
      return;
    }
    const CubicAxis& z = z_.at[k];
    std::array<const double*, 4> from;
    for (std::size_t m = 0; m < 4; ++m) from[m] = layer_of(static_cast<int>(z.offset[m])).values.data() + j * width;
    for (std::size_t i = 0; i < width; ++i) {
      double sum = 0.0;
      for (std::size_t m = 0; m < 4; ++m) sum += z.weight[m] * from[m][i];
      row[i] = static_cast<float>(sum);
    }
    for (std::size_t i = 0; i < width; ++i)
      if (x_.outside[i] != 0) row[i] = nothing_;
  });
}

}  // namespace burrhole
