/// tests/core/contact/tool_solid.h: a tool as an exact solid, and the 0.5 surface of voxels as dense points: what contact is judged by.
///   Shares no code with core/tool/tool_surface: signed distances of the primitives, from the numbers of the tool file.
///   Units  SI.
#pragma once

#include <cmath>

#include "shipped_bone.h"
#include "tests/support/shipped_spec.h"

namespace burrhole::contact_test {

/// Signed distance and outward normal of a union of the tool file's regions; exact outside.
class ToolSolid {
 public:
  explicit ToolSolid(const std::string& name) {
    const ToolSpec spec = test::shipped_spec(name);
    for (const RegionSpec& region : spec.regions) solids_.push_back(region.solid);
  }
  [[nodiscard]] double distance(const Vec3& p) const {
    double least = 1e9;
    for (const Solid& solid : solids_) least = std::min(least, of(solid, p));
    return least;
  }
  /// Gradient of the distance by central differences of 10 nm.
  [[nodiscard]] Vec3 normal(const Vec3& p) const {
    Vec3 out(0.0);
    for (std::size_t a = 0; a < 3; ++a) {
      Vec3 step(0.0);
      step[a] = 1e-8;
      out[a] = distance(p + step) - distance(p - step);
    }
    return glm::normalize(out);
  }
  [[nodiscard]] bool near(const Vec3& p, double margin) const {
    for (const Solid& s : solids_) {
      const Bounds b = s.bounds();
      if (glm::all(glm::greaterThan(p, b.lo - margin)) && glm::all(glm::lessThan(p, b.hi + margin))) return true;
    }
    return false;
  }

 private:
  static double of_box(const Bounds& box, const Vec3& p) {
    const Vec3 q = glm::abs(p - 0.5 * (box.lo + box.hi)) - 0.5 * (box.hi - box.lo);
    return glm::length(glm::max(q, Vec3(0.0))) + std::min(0.0, std::max({q.x, q.y, q.z}));
  }
  static double to_segment(double r, double z, double r0, double z0, double r1, double z1) {
    const double dr = r1 - r0, dz = z1 - z0, len2 = dr * dr + dz * dz;
    const double t = len2 > 0.0 ? std::clamp(((r - r0) * dr + (z - z0) * dz) / len2, 0.0, 1.0) : 0.0;
    return std::hypot(r - r0 - t * dr, z - z0 - t * dz);
  }
  static double of(const Solid& s, const Vec3& p) {
    if (s.kind == SolidKind::box) return of_box(s.bounds(), p);
    const double r = std::hypot(p.x, p.y), z = p.z;
    const bool inside = s.contains(p);
    if (s.kind == SolidKind::ellipsoid) {
      const double a = s.low_radius, b = 0.5 * s.height(), y = z - s.z_low - b;
      if (a == b) return std::hypot(r, y) - a;
      double lo = -0.5 * 3.14159265358979, hi = -lo;  // golden section of the angle
      const auto off = [&](double t) { return std::hypot(r - a * std::cos(t), y - b * std::sin(t)); };
      if (y > 0.0)
        lo = 0.0;
      else
        hi = 0.0;
      for (int n = 0; n < 60; ++n) {
        const double u = lo + 0.381966 * (hi - lo), v = hi - 0.381966 * (hi - lo);
        (off(u) < off(v) ? hi : lo) = off(u) < off(v) ? v : u;
      }
      return inside ? -off(lo) : off(lo);
    }
    double least = std::min({to_segment(r, z, s.low_bore, s.z_low, s.low_radius, s.z_low),
                             to_segment(r, z, s.low_radius, s.z_low, s.high_radius, s.z_high),
                             to_segment(r, z, s.high_radius, s.z_high, s.high_bore, s.z_high)});
    if (s.bored()) least = std::min(least, to_segment(r, z, s.high_bore, s.z_high, s.low_bore, s.z_low));
    return inside ? -least : least;
  }
  std::vector<Solid> solids_;
};

/// Points of the trilinear 0.5 surface on lines along the three axes, a quarter of a voxel apart: by the density alone, no record. On a crest
/// of a radius of 0.4 voxel the highest is 0.02 voxel below it at most.
inline std::vector<Vec3> surface_points(const Phantom& phantom, const Vec3& lo, const Vec3& hi, int per_voxel = 4) {
  const DenseBone& bone = phantom.bone;
  const Affine& map = bone.bone_from_index;
  const VoxelBox all{Vec3i(0), bone.dims};
  const auto density = [&](const Vec3& index) {
    return test::plain_trilinear(index, [&](const Vec3i& v) { return all.contains(v) ? bone.occupancy[all.offset_of(v)] : 0.0f; });
  };
  const Vec3 first = glm::floor(map.inverse() * lo), last = glm::ceil(map.inverse() * hi);
  std::vector<Vec3> out;
  const double step = 1.0 / per_voxel;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (double a = first[u]; a <= last[u]; a += step)
      for (double b = first[v]; b <= last[v]; b += step) {
        Vec3 at(0.0);
        at[u] = a, at[v] = b, at[axis] = first[axis];
        double before = density(at);
        for (double c = first[axis] + 0.5; c <= last[axis]; c += 0.5) {
          at[axis] = c;
          const double now = density(at);
          if ((before >= 0.5) != (now >= 0.5)) {
            double in = c - 0.5, till = c;
            for (int n = 0; n < 20; ++n) {
              at[axis] = 0.5 * (in + till);
              ((density(at) >= 0.5) == (before >= 0.5) ? in : till) = at[axis];
            }
            out.push_back(map * at);
          }
          before = now;
        }
      }
  }
  return out;
}

}  // namespace burrhole::contact_test
