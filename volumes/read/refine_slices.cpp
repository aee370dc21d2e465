#include "volumes/read/refine_slices.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/base/portable_math.h"
#include "volumes/read/cubic_kernel.h"

namespace burrhole {
namespace {

constexpr int kMostSlices = 8;
constexpr double kThick = 1.5;      // [pixels] slices nearer to each other are not refined
constexpr double kReach = 4.0;      // S: twice the largest displacement in distances of slices
constexpr double kSigmas = 2.5;     // reach of the Gaussian
constexpr std::size_t kPlanes = 6;  // floats per pixel

Vec3 spacing_of(const Scan& scan) {
  const Mat3& m = scan.bone_from_index.linear;
  return {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])};
}

}  // namespace

int slice_factor(const Scan& scan, double pitch) noexcept {
  const Vec3 spacing = spacing_of(scan);
  const double pixels = spacing.z / std::max(spacing.x, spacing.y);
  if (pixels < kThick || scan.dims.z < 2) return 1;
  return std::max(std::min({static_cast<int>(std::lround(pixels)), static_cast<int>(std::ceil(spacing.z / pitch)), kMostSlices}), 1);
}

std::size_t refined_bytes(const Scan& scan, int factor) noexcept {
  return factor == 1 ? 0 : kPlanes * sizeof(float) * VoxelBox{Vec3i(0), {scan.dims.x, scan.dims.y, 1}}.count();
}

RefinedSlices::RefinedSlices(const Scan& scan, const RefineRule& rule) : scan_(&scan), rule_(rule), spacing_(spacing_of(scan)) {
  if (rule.factor == 1) return;
  const auto across = [&](double edge) {
    const double sigma = spacing_.z / edge;
    const double reach = std::ceil(kSigmas * sigma);
    return make_taps(-reach, 2 * static_cast<std::size_t>(reach) + 1, sigma);
  };
  x_ = across(spacing_.x);
  y_ = across(spacing_.y);
  const std::size_t pixels = VoxelBox{Vec3i(0), {scan.dims.x, scan.dims.y, 1}}.count();
  for (std::vector<float>* plane : {&smooth_, &slope_, &rise_, &shift_x_, &shift_y_, &out_}) plane->resize(pixels);
}

RefinedSlices::Taps RefinedSlices::make_taps(double first, std::size_t count, double sigma) {
  std::vector<double> weight;
  double sum = 0.0, mean = 0.0, square = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    const double d = (first + static_cast<double>(n)) / sigma;
    weight.push_back(portable_exp(-0.5 * d * d));
    sum += weight[n];
    mean += weight[n] * (first + static_cast<double>(n));
  }
  mean /= sum;
  for (std::size_t n = 0; n < count; ++n) {
    const double d = first + static_cast<double>(n) - mean;
    square += weight[n] * d * d;
  }
  Taps out;
  for (std::size_t n = 0; n < count; ++n) {
    out.smooth.push_back(static_cast<float>(weight[n] / sum));
    out.slope.push_back(static_cast<float>(weight[n] * (first + static_cast<double>(n) - mean) / square));
  }
  return out;
}

const float* RefinedSlices::row(int j, int k) const noexcept {
  const Vec3i at(0, j, std::clamp(k, 0, scan_->dims.z - 1));
  return scan_->values.data() + VoxelBox{Vec3i(0), scan_->dims}.offset_of(at);
}

/// Row j of slices k - 2 to k + 3, smoothed across the slices and then along the row: smooth_ and slope_ along x, rise_ the slope across.
void RefinedSlices::smooth_across(int k, const Taps& z, int j) {
  const auto width = static_cast<std::size_t>(scan_->dims.x);
  const std::size_t reach = x_.smooth.size() / 2, padded = width + 2 * reach;
  std::vector<float> sum(padded, 0.0f), difference(padded, 0.0f);
  const auto low = static_cast<float>(rule_.low);
  for (std::size_t n = 0; n < z.smooth.size(); ++n) {
    const float* from = row(j, k + static_cast<int>(n) - 2);
    for (std::size_t i = 0; i < width; ++i) {
      const float v = std::max(from[i], low);
      sum[i + reach] += z.smooth[n] * v;
      difference[i + reach] += z.slope[n] * v;
    }
  }
  for (std::vector<float>* line : {&sum, &difference}) {
    std::fill_n(line->begin(), reach, (*line)[reach]);
    std::fill(line->begin() + static_cast<std::ptrdiff_t>(reach + width), line->end(), (*line)[reach + width - 1]);
  }
  const std::size_t at = static_cast<std::size_t>(j) * width;
  const auto convolve = [&](const std::vector<float>& line, const std::vector<float>& weight, std::vector<float>& plane) {
    float* to = plane.data() + at;
    std::fill_n(to, width, 0.0f);
    for (std::size_t n = 0; n < weight.size(); ++n)
      for (std::size_t i = 0; i < width; ++i) to[i] += weight[n] * line[n + i];
  };
  convolve(sum, x_.smooth, smooth_);
  convolve(sum, x_.slope, slope_);
  convolve(difference, x_.smooth, rise_);
}

/// Row j of the displacements: the Gaussian along y, and the formula of the header.
void RefinedSlices::finish_shifts(int j) {
  const auto width = static_cast<std::size_t>(scan_->dims.x);
  std::vector<float> gx(width, 0.0f), gy(width, 0.0f), gz(width, 0.0f);
  const int reach = static_cast<int>(y_.smooth.size() / 2);
  for (std::size_t n = 0; n < y_.smooth.size(); ++n) {
    const auto from = static_cast<std::size_t>(std::clamp(j + static_cast<int>(n) - reach, 0, scan_->dims.y - 1)) * width;
    const float *smooth = smooth_.data() + from, *slope = slope_.data() + from, *rise = rise_.data() + from;
    for (std::size_t i = 0; i < width; ++i) {
      gx[i] += y_.smooth[n] * slope[i];
      gy[i] += y_.slope[n] * smooth[i];
      gz[i] += y_.smooth[n] * rise[i];
    }
  }
  const auto px = static_cast<float>(1.0 / (spacing_.x * spacing_.x)), py = static_cast<float>(1.0 / (spacing_.y * spacing_.y)),
             pz = static_cast<float>(1.0 / (spacing_.z * spacing_.z)), flat = static_cast<float>(rule_.flat * rule_.flat);
  constexpr auto kLimit = static_cast<float>(1.0 / (kReach * kReach));
  float *sx = shift_x_.data() + static_cast<std::size_t>(j) * width, *sy = shift_y_.data() + static_cast<std::size_t>(j) * width;
  for (std::size_t i = 0; i < width; ++i) {
    const float across = gx[i] * gx[i] * px + gy[i] * gy[i] * py, along = gz[i] * gz[i] * pz;
    const float scale = across + along < flat ? 0.0f : -gz[i] / (across + kLimit * along + flat);
    sx[i] = scale * gx[i] * px;
    sy[i] = scale * gy[i] * py;
  }
}

void RefinedSlices::find_shifts(int k) {
  if (interval_ == k) return;
  interval_ = k;
  const Taps z = make_taps(-2.5, kCubicTaps, 1.0);
  for_each_number(scan_->dims.y, [&](int j) { smooth_across(k, z, j); });
  for_each_number(scan_->dims.y, [&](int j) { finish_shifts(j); });
}

void RefinedSlices::interpolate_row(int k, double t, int j) {
  const Vec3i& dims = scan_->dims;
  const std::array<float, kCubicTaps> weight = cubic_weights(t);
  std::array<const float*, kCubicTaps> layer;
  for (std::size_t n = 0; n < kCubicTaps; ++n) layer[n] = row(0, k + static_cast<int>(n) - 2);
  const std::size_t at = static_cast<std::size_t>(j) * static_cast<std::size_t>(dims.x);
  for (int i = 0; i < dims.x; ++i) {
    const std::size_t here = at + static_cast<std::size_t>(i);
    const auto sx = static_cast<double>(shift_x_[here]), sy = static_cast<double>(shift_y_[here]);
    if (sx == 0.0 && sy == 0.0) {
      out_[here] = limited_sum(weight, [&](std::size_t n) { return layer[n][here]; });
      continue;
    }
    std::array<float, kCubicTaps> sample;
    for (std::size_t n = 0; n < kCubicTaps; ++n) {
      const double slices = static_cast<double>(n) - 2.0 - t;
      const CubicAxis x(i + sx * slices, dims.x, 1), y(j + sy * slices, dims.y, dims.x);
      sample[n] = limited_sum(y.weight, [&](std::size_t q) {
        const float* from = layer[n] + y.offset[q];
        return limited_sum(x.weight, [&](std::size_t p) { return from[x.offset[p]]; });
      });
    }
    out_[here] = limited_sum(weight, [&](std::size_t n) { return sample[n]; });
  }
}

std::span<const float> RefinedSlices::slice(int n) {
  const int k = n / rule_.factor, part = n % rule_.factor;
  const std::size_t pixels = VoxelBox{Vec3i(0), {scan_->dims.x, scan_->dims.y, 1}}.count();
  if (part == 0) return {row(0, k), pixels};
  find_shifts(k);
  for_each_number(scan_->dims.y, [&](int j) { interpolate_row(k, static_cast<double>(part) / rule_.factor, j); });
  return out_;
}

}  // namespace burrhole
