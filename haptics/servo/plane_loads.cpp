#include "haptics/servo/plane_loads.h"

#include <algorithm>
#include <cmath>

namespace burrhole {
namespace {

// A pivot below this part of its own diagonal is rounding: the plane is alike one before it and its load would be any number.
constexpr double kOwnPart = 1e-12;

/// How a unit force on plane b moves the gap of plane a [m/N]; the hold solver's, for a tool on its coupling.
double compliance(const LocalContact& local, const HoldPlane& a, const HoldPlane& b) noexcept {
  const double along = glm::dot(a.normal, b.normal);
  const double turned = glm::dot(glm::cross(a.arm, a.normal), glm::cross(b.arm, b.normal));
  const double engaging = a.cutting && b.cutting ? along / local.cutting_stiffness : 0.0;
  return along / local.coupling_stiffness + turned / local.turn_stiffness + engaging;
}

/// The planes that carry load, and how their loads change as the hand moves.
struct LoadedPlanes {
  std::array<const HoldPlane*, kMaxLocalPlanes> planes{};
  std::array<std::array<double, kMaxLocalPlanes>, kMaxLocalPlanes> l;  // Cholesky of the compliance, lower
  std::size_t count = 0;

  /// Takes the plane in unless it is alike those before it.
  void add(const LocalContact& local, const HoldPlane& plane) noexcept {
    planes[count] = &plane;
    std::array<double, kMaxLocalPlanes>& row = l[count];
    for (std::size_t c = 0; c <= count; ++c) {
      const double whole = compliance(local, plane, *planes[c]) + (c == count ? plane.yield : 0.0);
      double left = whole;
      for (std::size_t k = 0; k < c; ++k) left -= row[k] * l[c][k];
      if (c < count)
        row[c] = left / l[c][c];
      else if (left > kOwnPart * whole)
        row[c] = std::sqrt(left);
      else
        return;
    }
    ++count;
  }

  /// Rows of -A^-1 N^T.
  void slopes(std::array<Vec3, kMaxLocalPlanes>& out) const noexcept {
    for (std::size_t r = 0; r < count; ++r) {
      out[r] = -planes[r]->normal;
      for (std::size_t k = 0; k < r; ++k) out[r] -= l[r][k] * out[k];
      out[r] /= l[r][r];
    }
    for (std::size_t r = count; r-- > 0;) {
      for (std::size_t k = r + 1; k < count; ++k) out[r] -= l[k][r] * out[k];
      out[r] /= l[r][r];
    }
  }
};

}  // namespace

void PlaneLoads::add(const HoldPlane& plane, double at_rest, const Vec3& slope) noexcept {
  loads_[count_++] = {plane.normal, plane.arm, slope, at_rest, plane.both_ways};
}

void PlaneLoads::set_penalty(const LocalContact& local, bool with_untouched) noexcept {
  count_ = 0;
  for (const HoldPlane& plane : local.list())
    if (with_untouched || plane.gap < 0.0) add(plane, -plane.gap / plane.yield, -plane.normal / plane.yield);
  sampled_ = sum(Vec3(0.0));
}

void PlaneLoads::set_coupled(const LocalContact& local) noexcept {
  LoadedPlanes loaded;
  for (const HoldPlane& plane : local.list())
    if (plane.both_ways || plane.force > 0.0) loaded.add(local, plane);
  std::array<Vec3, kMaxLocalPlanes> slopes;
  loaded.slopes(slopes);
  count_ = 0;
  for (std::size_t n = 0; n < loaded.count; ++n) add(*loaded.planes[n], loaded.planes[n]->force, slopes[n]);
  sampled_ = sum(Vec3(0.0));
}

PlaneLoads::Sum PlaneLoads::sum(const Vec3& d) const noexcept {
  Sum out;
  Wrench springs;  // planes that hold both ways
  double pushing_sampled = 0.0;
  for (std::size_t n = 0; n < count_; ++n) {
    const Load& plane = loads_[n];
    const double line = plane.at_rest + glm::dot(plane.slope, d);
    const double load = plane.both_ways ? line : std::max(0.0, line);
    Wrench& to = plane.both_ways ? springs : out.wrench;
    to.force += plane.normal * load;
    to.torque += glm::cross(plane.arm, plane.normal * load);
    if (plane.both_ways) continue;
    out.pushing += load;
    pushing_sampled += std::max(0.0, plane.at_rest);
  }
  // What holds sideways is engaged by the push and goes with it.
  const double engaged = out.pushing < pushing_sampled ? out.pushing / pushing_sampled : 1.0;
  if (out.pushing > 0.0) {
    out.wrench.force += springs.force * engaged;
    out.wrench.torque += springs.torque * engaged;
  }
  return out;
}

Wrench PlaneLoads::extrapolate(const Wrench& sampled, const Vec3& d) const noexcept {
  const Sum now = sum(d);
  const double share = now.pushing < sampled_.pushing ? now.pushing / sampled_.pushing : 1.0;
  if (now.pushing == 0.0) return {};
  // In this order of operations the last bracket is exactly zero at d = 0.
  return {sampled.force * share + (now.wrench.force - sampled_.wrench.force * share),
          sampled.torque * share + (now.wrench.torque - sampled_.wrench.torque * share)};
}

Mat3 PlaneLoads::gradient() const noexcept {
  Mat3 out(0.0);
  for (std::size_t n = 0; n < count_; ++n) out += glm::outerProduct(loads_[n].normal, loads_[n].slope);
  return out;
}

}  // namespace burrhole
