#include "tests/core/voxel/surface_cases.h"

#include <limits>
#include <numbers>

namespace burrhole::test {

Shape plane(const Vec3& through, const Vec3& outward) {
  return [=](const Vec3& p) { return Truth{glm::dot(p - through, outward), outward}; };
}

Shape ball(const Vec3& centre, double radius, bool cavity) {
  return [=](const Vec3& p) {
    const Vec3 out = p - centre;
    const double length = glm::length(out), side = cavity ? -1.0 : 1.0;
    return Truth{side * (length - radius), length > 0.0 ? side * out / length : Vec3(0.0)};
  };
}

Shape hole(const Vec3& centre, const Vec3& axis, double radius) {
  return [=](const Vec3& p) {
    const Vec3 off = p - centre, out = off - axis * glm::dot(off, axis);
    const double length = glm::length(out);
    return Truth{radius - length, length > 0.0 ? -out / length : Vec3(0.0)};
  };
}

Shape wedge(const Shape& a, const Shape& b) {
  return [=](const Vec3& p) {
    const Truth ta = a(p), tb = b(p);
    return ta.distance > tb.distance ? ta : tb;
  };
}

namespace {

double wide(const Mat3& metric, const Truth& t) {
  double reach = 0.0;  // of a cell's corners from its middle plane, along the normal
  for (std::size_t c = 0; c < 3; ++c) reach += std::abs(glm::dot(metric[c], t.normal));
  return reach > 0.0 ? std::clamp(0.5 - t.distance / (2.0 * reach), 0.0, 1.0) : (t.distance > 0.0 ? 0.0 : 1.0);
}

double coverage(const Mat3& metric, const Shape& shape, const Vec3& v) {
  const double at = shape(metric * v).distance, far = glm::length(metric[0]) + glm::length(metric[1]) + glm::length(metric[2]);
  if (std::abs(at) > far) return at > 0.0 ? 0.0 : 1.0;
  int inside = 0;
  for (int n = 0; n < 8 * 8 * 8; ++n) {
    const Vec3 part((n & 7) - 3.5, ((n >> 3) & 7) - 3.5, (n >> 6) - 3.5);
    inside += shape(metric * (v + part / 8.0)).distance <= 0.0 ? 1 : 0;
  }
  return inside / 512.0;
}

}  // namespace

MasterWindow window_of(const VoxelBox& box, const Mat3& metric, const Shape& shape, Ramp ramp) {
  MasterWindow window;
  window.box = box;
  for_each_voxel(box, [&](const Vec3i& v) {
    const double d = ramp == Ramp::wide ? wide(metric, shape(metric * Vec3(v))) : coverage(metric, shape, Vec3(v));
    window.density.push_back(static_cast<float>(d));
  });
  return window;
}

MasterWindow cut_out(const MasterWindow& window, const VoxelBox& box) {
  MasterWindow out;
  out.box = box;
  for_each_voxel(box, [&](const Vec3i& v) { out.density.push_back(window.density[window.box.offset_of(v)]); });
  return out;
}

SurfaceSample read_records(const SurfaceRecords& records, const Vec3& at) {
  const Vec3i base = floor_int(at);
  const Vec3 w = at - Vec3(base);
  SurfaceSample out{0.0, Vec3(0.0)};
  std::visit(
      [&](const auto& all) {
        for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& c) {
          const SurfaceSample one = decode(all[records.box().offset_of(base + c)]);
          const double weight = (c.x ? w.x : 1.0 - w.x) * (c.y ? w.y : 1.0 - w.y) * (c.z ? w.z : 1.0 - w.z);
          out.distance += weight * one.distance;
          out.normal += weight * one.normal;
        });
      },
      records.records());
  const double length = glm::length(out.normal);
  if (length > 0.0) out.normal /= length;
  return out;
}

PlainSurface::PlainSurface(const MasterWindow& window, const Mat3& metric) : window_(&window), metric_(metric), cells_(window.box.count()) {
  constexpr int kLines = 6;  // an axis of a cell
  const Mat3 covector = glm::transpose(glm::inverse(metric));
  const auto add_line = [&](const Vec3i& cell, std::size_t axis, double u, double w) {
    Vec3 from(0.0);
    from[(axis + 1) % 3] = u;
    from[(axis + 2) % 3] = w;
    Vec3 to = from;
    to[axis] = 1.0;
    const Vec3 corner(cell);
    // Along a line of the grid the trilinear field is linear.
    const double a = density(corner + from), b = density(corner + to);
    if ((a >= 0.5) == (b >= 0.5)) return;
    from[axis] = (0.5 - a) / (b - a);
    const Vec3 p = corner + from;
    Vec3 slope;
    for (std::size_t x = 0; x < 3; ++x) {
      Vec3 step(0.0);
      step[x] = 1e-5;
      const Vec3 inner = glm::clamp(p, corner + 2e-5, corner + (1.0 - 2e-5));
      slope[x] = density(inner + step) - density(inner - step);
    }
    const Vec3 normal = -(covector * slope);
    const double length = glm::length(normal);
    cells_[window_->box.offset_of(cell)].push_back({metric_ * p, length > 0.0 ? normal / length : Vec3(0.0)});
  };
  for_each_voxel({window.box.lo, window.box.hi - 1}, [&](const Vec3i& cell) {
    float least = 1.0f, most = 0.0f;
    for_each_voxel({cell, cell + 2}, [&](const Vec3i& v) {
      least = std::min(least, window.density[window.box.offset_of(v)]);
      most = std::max(most, window.density[window.box.offset_of(v)]);
    });
    if (least >= 0.5f || most < 0.5f) return;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int n = 0; n <= kLines; ++n)
        for (int m = 0; m <= kLines; ++m) add_line(cell, axis, static_cast<double>(n) / kLines, static_cast<double>(m) / kLines);
  });
}

double PlainSurface::density(const Vec3& at) const {
  const Vec3i base = glm::clamp(floor_int(at), window_->box.lo, window_->box.hi - 2);
  const Vec3 w = at - Vec3(base);
  double sum = 0.0;
  for_each_voxel({Vec3i(0), Vec3i(2)}, [&](const Vec3i& c) {
    const double weight = (c.x ? w.x : 1.0 - w.x) * (c.y ? w.y : 1.0 - w.y) * (c.z ? w.z : 1.0 - w.z);
    sum += weight * static_cast<double>(window_->density[window_->box.offset_of(base + c)]);
  });
  return sum;
}

double PlainSurface::distance(const Vec3& at) const {
  const Vec3 p = metric_ * at;
  const Vec3i middle = floor_int(at);
  double least = std::numeric_limits<double>::max();
  const Point* nearest = nullptr;
  for_each_voxel(VoxelBox{middle - 4, middle + 5}.intersect({window_->box.lo, window_->box.hi - 1}), [&](const Vec3i& cell) {
    for (const Point& point : cells_[window_->box.offset_of(cell)])
      if (const double d = glm::length(p - point.position); d < least) least = d, nearest = &point;
  });
  if (nearest == nullptr) return std::numeric_limits<double>::max();
  // Between the points, which are up to 0.12 apart from any place on it, the surface is as flat as its tangent.
  const Vec3 r = p - nearest->position;
  const double height = std::abs(glm::dot(r, nearest->normal));
  if (std::sqrt(std::max(0.0, glm::dot(r, r) - height * height)) < 0.15) least = height;
  return density(at) >= 0.5 ? -least : least;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}
double largest(const std::vector<double>& values) { return values.empty() ? 0.0 : *std::ranges::max_element(values); }
double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

}  // namespace burrhole::test
