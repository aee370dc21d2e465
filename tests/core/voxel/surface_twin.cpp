#include "tests/core/voxel/surface_twin.h"

namespace burrhole::test {
namespace {

double weight(const Vec3i& corner, const Vec3& within) {
  double w = 1.0;
  for (std::size_t a = 0; a < 3; ++a) w *= corner[a] != 0 ? within[a] : 1.0 - within[a];
  return w;
}
Vec3 unit(const Vec3& v) { return glm::length(v) > 1e-6 ? glm::normalize(v) : Vec3(0.0); }

}  // namespace

SurfaceTwin::SurfaceTwin(const MasterWindow& window, const Mat3& metric, Leave leave)
    : window_(&window), metric_(metric), index_(glm::inverse(metric)), leave_(leave), surfel_at_(window.box.count(), -1) {
  for_each_voxel(window.box.grown(1), [&](const Vec3i& v) { gradients_.push_back(gradient(v)); });
  for_each_voxel({window.box.lo, window.box.hi - 1}, [&](const Vec3i& cell) { add_surfel(cell); });
}

double SurfaceTwin::density(const Vec3i& v) const {
  return static_cast<double>(window_->density[window_->box.offset_of(glm::clamp(v, window_->box.lo, window_->box.hi - 1))]);
}

double SurfaceTwin::trilinear(const Vec3& at) const {
  const Vec3i base = floor_int(at);
  double sum = 0.0;
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& c) { sum += weight(c, at - Vec3(base)) * density(base + c); });
  return sum;
}

Vec3 SurfaceTwin::gradient(const Vec3i& v) const {
  Vec3 g(0.0);
  if (leave_.smoothing) {
    for (std::size_t a = 0; a < 3; ++a) {
      Vec3i step(0);
      step[a] = 1;
      g[a] = 0.5 * (density(v + step) - density(v - step));
    }
    return g;
  }
  const double smooth[5] = {0.035, 0.26, 0.41, 0.26, 0.035}, slope[5] = {-0.117021, -0.265957, 0.0, 0.265957, 0.117021};
  for_each_voxel({Vec3i(-2), Vec3i(3)}, [&](const Vec3i& o) {
    const Vec3i n = o + 2;
    const double d = density(v + o);
    g.x += d * slope[n.x] * smooth[n.y] * smooth[n.z];
    g.y += d * smooth[n.x] * slope[n.y] * smooth[n.z];
    g.z += d * smooth[n.x] * smooth[n.y] * slope[n.z];
  });
  return g;
}

Vec3 SurfaceTwin::normal_of(const Vec3& at) const {
  const VoxelBox known = window_->box.grown(1);
  const Vec3i base = floor_int(at);
  Vec3 g(0.0);
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& c) {
    g += weight(c, at - Vec3(base)) * gradients_[known.offset_of(glm::clamp(base + c, known.lo, known.hi - 1))];
  });
  return unit(-(glm::transpose(index_) * g));
}

Vec3 SurfaceTwin::surfel_normal(const Vec3i& cell, const Vec3& at) const {
  const Vec3 smooth = normal_of(at), within = at - Vec3(cell);
  Vec3 g(0.0);
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& c) {
    for (std::size_t a = 0; a < 3; ++a) {
      Vec3 on_face = within;
      on_face[a] = c[a];
      g[a] += (c[a] != 0 ? 1.0 : -1.0) * weight(c, on_face) * density(cell + c);
    }
  });
  const Vec3 sharp = unit(-(glm::transpose(index_) * g));
  return sharp == Vec3(0.0) || glm::dot(smooth, sharp) > 0.97 ? smooth : sharp;
}

void SurfaceTwin::add_surfel(const Vec3i& cell) {
  Vec3 sum(0.0);
  int count = 0;
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& from) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (from[a] != 0) continue;
      Vec3i to = from;
      to[a] = 1;
      const double d0 = density(cell + from), d1 = density(cell + to);
      if ((d0 >= 0.5) == (d1 >= 0.5)) continue;
      Vec3 p(from);
      p[a] = (0.5 - d0) / (d1 - d0);
      sum += p;
      ++count;
    }
  });
  if (count == 0) return;
  const Vec3 corner(cell), start = corner + sum / static_cast<double>(count);
  // The nearest place along the normal, by halving, inside the cell.
  const Vec3 along = index_ * surfel_normal(cell, start);
  const auto off = [&](double t) { return trilinear(glm::clamp(start + t * along, corner + 1e-9, corner + 1.0 - 1e-9)) - 0.5; };
  double least = 0.0;
  for (double lo = -0.6, hi = 0.6; off(lo) * off(hi) < 0.0;) {
    const double middle = 0.5 * (lo + hi);
    least = middle;
    if (hi - lo < 1e-12) break;
    (off(lo) * off(middle) <= 0.0 ? hi : lo) = middle;
  }
  const Vec3 s = glm::clamp(start + least * along, corner, corner + 1.0);
  surfel_at_[window_->box.offset_of(cell)] = static_cast<int>(surfels_.size());
  surfels_.push_back({s, surfel_normal(cell, s)});
}

SurfaceSample SurfaceTwin::record(const Vec3i& v) const {
  const Surfel* nearest = nullptr;
  double least = kRecordBand;
  for_each_voxel(VoxelBox{v - 6, v + 6}.intersect({window_->box.lo, window_->box.hi - 1}), [&](const Vec3i& cell) {
    const int n = surfel_at_[window_->box.offset_of(cell)];
    if (n < 0) return;
    const double d = glm::length(metric_ * (Vec3(v) - surfels_[static_cast<std::size_t>(n)].index));
    if (d < least) least = d, nearest = &surfels_[static_cast<std::size_t>(n)];
  });
  const double side = density(v) >= 0.5 ? -1.0 : 1.0;
  if (nearest == nullptr) return {side * kRecordBand, Vec3(0.0)};
  const Vec3 r = metric_ * (Vec3(v) - nearest->index), ns = nearest->normal;
  if (leave_.plane) return {side * least, ns};
  const double height = glm::dot(ns, r);
  if (leave_.second_order) return {side * std::max(0.0, side * height), ns};
  double fan = 0.0;
  for (std::size_t c = 0; c < 3; ++c) fan = std::max(fan, glm::length(metric_[c]));
  const Vec3 across = r - height * ns, foot = across * std::min(1.0, fan / std::max(1e-12, glm::length(across)));
  const Vec3 rest = across - foot, nc = normal_of(nearest->index + index_ * foot);
  const bool one_face = glm::length(rest) >= 1e-9 || glm::dot(nc, ns) > 0.94;
  const double d = std::max(0.0, side * 0.5 * glm::dot(ns + (one_face ? nc : ns), foot + height * ns));
  if (glm::length(rest) < 1e-9) return {side * d, nc};
  return {side * std::hypot(d, glm::length(rest)), unit(d * nc + side * rest)};
}

SurfaceSample SurfaceTwin::read(const Vec3& at) const {
  const Vec3i base = floor_int(at);
  SurfaceSample out{0.0, Vec3(0.0)};
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& c) {
    const SurfaceSample one = record(base + c);
    out.distance += weight(c, at - Vec3(base)) * one.distance;
    out.normal += weight(c, at - Vec3(base)) * one.normal;
  });
  out.normal = unit(out.normal);
  return out;
}

}  // namespace burrhole::test
