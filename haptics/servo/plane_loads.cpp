#include "haptics/servo/plane_loads.h"

#include <algorithm>
#include <cmath>

#include "core/contact/contact_constraint.h"

namespace burrhole {
namespace {

// A pivot below this fraction of its diagonal is rounding: the plane repeats an earlier one and its load is undetermined.
constexpr double kOwnPart = 1e-12;

/// Change of the gap of plane a per unit force on plane b [m/N], as in the hold solver for a tool on its coupling.
double compliance(const LocalContact& local, const HoldPlane& a, const HoldPlane& b) noexcept {
  const double along = glm::dot(a.normal, b.normal);
  const double turned = glm::dot(glm::cross(a.arm, a.normal), glm::cross(b.arm, b.normal));
  const double engaging = a.cutting && b.cutting ? along / local.cutting_stiffness : 0.0;
  return along / local.coupling_stiffness + turned / local.turn_stiffness + engaging;
}

/// The loaded planes, and the derivatives of their loads with respect to the hand's position.
struct LoadedPlanes {
  std::array<const HoldPlane*, kMaxLocalPlanes> planes{};
  std::array<std::array<double, kMaxLocalPlanes>, kMaxLocalPlanes> l;  // Cholesky of the compliance, lower
  std::size_t count = 0;

  /// Adds the plane unless it is linearly dependent on earlier ones.
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

  /// Computes the rows of -A^-1 N^T.
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
  loads_[count_++] = {plane.normal, plane.arm, slope, at_rest, plane.both_ways, plane.cutting, plane.point};
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
  Wrench springs;  // planes with `both_ways`
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
  // The lateral stiffness exists through the push, so its load scales with the push.
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
  // This order of operations makes the last bracket exactly zero at d = 0.
  return {sampled.force * share + (now.wrench.force - sampled_.wrench.force * share),
          sampled.torque * share + (now.wrench.torque - sampled_.wrench.torque * share)};
}

std::size_t PlaneLoads::pressed(const Vec3& d, std::span<PressedPoint, kMaxLocalPlanes> out) const noexcept {
  const std::span<const Load> loads(loads_.data(), count_);
  const bool gripped = std::ranges::any_of(loads, &Load::both_ways);
  std::size_t count = 0;
  for (const Load& plane : loads) {
    const double load = plane.at_rest + glm::dot(plane.slope, d);
    if (plane.both_ways || !(load > 0.0) || plane.point >= kConstraintPoint) continue;
    out[count++] = {.point = plane.point, .arm = plane.arm, .normal = plane.normal, .load = load, .held = gripped && plane.cutting};
  }
  return count;
}

Mat3 PlaneLoads::gradient() const noexcept {
  Mat3 out(0.0);
  for (std::size_t n = 0; n < count_; ++n) out += glm::outerProduct(loads_[n].normal, loads_[n].slope);
  return out;
}

}  // namespace burrhole
