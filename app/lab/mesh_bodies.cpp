#include "app/lab/mesh_bodies.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/base/trilinear.h"
#include "volumes/phantom/phantom.h"

namespace burrhole {
namespace {

constexpr double kBurrRadius = 8.0;        // [voxel]
constexpr Vec3 kAside(0.31, -0.17, 0.43);  // [voxel] of a centre from a voxel
constexpr int kMargin = 4;                 // [voxels] round a body
constexpr double kPi = std::numbers::pi;

float ramp(double distance, const Vec3& normal) {
  const Vec3 size = glm::abs(normal);
  return static_cast<float>(std::clamp(0.5 - distance / (2.0 * (size.x + size.y + size.z)), 0.0, 1.0));
}

Vec3 normal_of(const std::function<double(const Vec3&)>& distance, const Vec3& p) {
  constexpr double kStep = 1e-4;
  Vec3 out(0.0);
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    Vec3 step(0.0);
    step[axis] = kStep;
    out[axis] = distance(p + step) - distance(p - step);
  }
  const double length = glm::length(out);
  return length > 0.0 ? out / length : Vec3(0.0, 0.0, 1.0);
}

VoxelBox box_round(const Vec3& centre) { return {floor_int(centre) - kRemovedEdge / 2, floor_int(centre) + kRemovedEdge / 2}; }

/// @param half [voxels] of the grid's edge. @param place where the middle of the removed box lies
MeshBody closed_form(const std::string& name, int half, const Vec3& place, double volume, std::function<double(const Vec3&)> distance) {
  MeshBody out{
      .name = name, .truth = "closed form", .box = {Vec3i(-half), Vec3i(half)}, .before = {}, .after = {}, .changed = box_round(place)};
  out.after.reserve(out.box.count());
  for_each_voxel(out.box, [&](const Vec3i& v) {
    const double d = distance(Vec3(v));
    out.after.push_back(std::abs(d) > 2.0 ? (d < 0.0 ? 1.0f : 0.0f) : ramp(d, normal_of(distance, Vec3(v))));
  });
  out.before = out.after;
  for_each_voxel(out.changed.intersect(out.box), [&](const Vec3i& v) { out.before[out.box.offset_of(v)] = 1.0f; });
  out.surface = {.value = std::move(distance), .is_distance = true, .bounds = {Vec3(1 - half), Vec3(half - 2)}};
  out.volume = volume;
  return out;
}

MeshBody make_ball() {
  constexpr double kRadius = 15.0;
  return closed_form("ball", 15 + kMargin, kAside + Vec3(9.0, 8.0, 9.0), 4.0 / 3.0 * kPi * kRadius * kRadius * kRadius,
                     [](const Vec3& p) { return glm::length(p - kAside) - kRadius; });
}

MeshBody make_cavity() {
  constexpr double kInner = 10.0, kOuter = 20.0;
  return closed_form("cavity", 20 + kMargin, kAside + Vec3(6.0, 5.0, 6.0),
                     4.0 / 3.0 * kPi * (kOuter * kOuter * kOuter - kInner * kInner * kInner), [](const Vec3& p) {
                       const double r = glm::length(p - kAside);
                       return std::max(r - kOuter, kInner - r);
                     });
}

/// Distance to a slab with a hole, by the nearer of its outer faces and the quarter plane round the rim.
double distance_to_slab(const Vec3& p, const Vec3& half, double hole) {
  const Vec3 q = glm::abs(p) - half;
  const double away = std::hypot(p.x, p.y);
  const double in_box = std::max({q.x, q.y, q.z});
  if (away >= hole) {
    if (in_box > 0.0) return glm::length(glm::max(q, Vec3(0.0)));
    return std::max(in_box, hole - away);
  }
  return q.z > 0.0 ? std::hypot(hole - away, q.z) : hole - away;
}

MeshBody make_slab() {
  constexpr Vec3 kHalf(22.5, 22.5, 8.2);
  constexpr double kHole = 8.4;
  const Vec3 tilt = glm::normalize(Vec3(0.31, 0.22, 1.0)), across = glm::normalize(glm::cross(Vec3(0.17, 1.0, 0.0), tilt));
  const Vec3 third = glm::cross(tilt, across);
  const double volume = 8.0 * kHalf.x * kHalf.y * kHalf.z - kPi * kHole * kHole * 2.0 * kHalf.z;
  return closed_form("slab", 34, kAside + 8.0 * tilt + 9.0 * across, volume, [=](const Vec3& p) {
    const Vec3 d = p - kAside;
    return distance_to_slab({glm::dot(d, across), glm::dot(d, third), glm::dot(d, tilt)}, kHalf, kHole);
  });
}

/// The 0.5 level of the trilinear density; 0 outside of the box.
KnownSurface level_of(const VoxelBox& box, const std::vector<float>& density) {
  const auto kept = std::make_shared<const std::vector<float>>(density);
  return {.value =
              [box, kept](const Vec3& p) {
                const Vec3i base = floor_int(p);
                return 0.5 - trilinear(p - Vec3(base), [&](unsigned n) {
                         const Vec3i v = base + cell_corner(n);
                         return box.contains(v) ? static_cast<double>((*kept)[box.offset_of(v)]) : 0.0;
                       });
              },
          .is_distance = false,
          .bounds = {Vec3(box.lo) - 1.0, Vec3(box.hi)}};
}

Result<MeshBody> make_patch() {
  PhantomSpec spec;
  spec.pitch = 0.5e-3;
  const auto phantom = make_phantom(spec);
  if (!phantom) return phantom.error();
  MeshBody out{.name = "patch",
               .truth = "0.5 level of the trilinear density",
               .box = {Vec3i(0), phantom->bone.dims},
               .before = phantom->bone.occupancy,
               .after = {},
               .changed = {}};
  const Vec3i middle = out.box.size() / 2;
  int top = out.box.hi.z - 1;
  while (top > 0 && out.before[out.box.offset_of({middle.x, middle.y, top})] < 0.5f) --top;
  const Vec3 burr = Vec3(middle.x, middle.y, top) + kAside;
  out.changed = box_round(burr);
  out.after = out.before;
  for_each_voxel(out.changed.intersect(out.box), [&](const Vec3i& v) {
    const Vec3 away = Vec3(v) - burr;
    float& left = out.after[out.box.offset_of(v)];
    left = std::min(left, ramp(kBurrRadius - glm::length(away), away / glm::length(away)));
  });
  out.surface = level_of(out.box, out.after);
  out.volume = volume_of(out.surface);
  return out;
}

}  // namespace

std::vector<std::string> mesh_body_names() { return {"ball", "slab", "cavity", "patch"}; }

Result<MeshBody> make_mesh_body(const std::string& name) {
  if (name == "ball") return make_ball();
  if (name == "slab") return make_slab();
  if (name == "cavity") return make_cavity();
  if (name == "patch") return make_patch();
  return bad_input("no body \"" + name + "\"; give ball, slab, cavity or patch");
}

void MeshModel::set(const std::vector<float>& values) {
  std::size_t n = 0;
  for_each_voxel(changed, [&](const Vec3i& v) { density[box.offset_of(v)] = values[n++]; });
}

MeshModel make_mesh_model(int edge) {
  MeshModel out{.box = {Vec3i(-edge / 2), Vec3i(edge - edge / 2)}, .density = {}, .changed = box_round(Vec3(0.0))};
  std::vector<double> wave_x, wave_y;
  for (int x = out.box.lo.x; x < out.box.hi.x; ++x) {
    wave_x.push_back(3.0 * std::sin(0.11 * x));
    wave_y.push_back(2.0 * std::cos(0.17 * x));
  }
  out.density.reserve(out.box.count());
  for_each_voxel(out.box, [&](const Vec3i& v) {
    const Vec3i d = v - out.box.lo;
    const double face = wave_x[static_cast<std::size_t>(d.x)] + wave_y[static_cast<std::size_t>(d.y)];
    const int side = std::min({d.x, d.y, edge - 1 - d.x, edge - 1 - d.y, d.z});
    out.density.push_back(static_cast<float>(std::clamp(0.5 - std::max(v.z - face, 4.0 - side), 0.0, 1.0)));
  });
  for_each_voxel(out.changed, [&](const Vec3i& v) {
    const float before = out.density[out.box.offset_of(v)];
    out.box_before.push_back(before);
    // With its ramp a ball of radius 8.5 reaches the faces of the box.
    out.box_after.push_back(std::min(before, static_cast<float>(std::clamp(0.5 + glm::length(Vec3(v) + 0.5) - 8.5, 0.0, 1.0))));
  });
  return out;
}

}  // namespace burrhole
