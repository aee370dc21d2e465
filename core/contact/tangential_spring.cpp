#include "core/contact/tangential_spring.h"

#include <algorithm>

#include "core/base/rotation.h"

namespace burrhole {
namespace {

constexpr int kCells = 4;  // per axis
static_assert(kCells * kCells * kCells == kMaxPressedPoints);

struct Bounds {
  Vec3 lo, hi;
  [[nodiscard]] std::size_t cell_of(const Vec3& p) const noexcept {
    std::size_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const double extent = hi[axis] - lo[axis];
      const int n = extent > 0.0 ? std::min(kCells - 1, static_cast<int>(kCells * (p[axis] - lo[axis]) / extent)) : 0;
      cell = cell * kCells + static_cast<std::size_t>(n);
    }
    return cell;
  }
};

struct Cell {
  Vec3 normal{0.0}, arm{0.0};  // sums, weighted with the depth
  double depth = 0.0;
};

}  // namespace

void list_pressed(std::span<const Contact> contacts, const Vec3& force, const Pose& world_from_bone, const Vec3& tool_origin,
                  PressedPoints& out) noexcept {
  out.count = 0;
  const Quat bone_from_world = glm::conjugate(world_from_bone.rotation);
  Vec3 sum(0.0);
  std::size_t pressing = 0;
  Bounds bounds{Vec3(1e300), Vec3(-1e300)};
  for (const Contact& contact : contacts) {
    if (!(contact.depth > 0.0)) continue;
    sum += contact.depth * contact.normal;
    bounds.lo = glm::min(bounds.lo, contact.position);
    bounds.hi = glm::max(bounds.hi, contact.position);
    ++pressing;
  }
  const double length = glm::length(sum);
  if (!(length > 0.0)) return;
  const double load_per_depth = glm::length(force) / length;
  std::array<Cell, kMaxPressedPoints> cells{};
  for (const Contact& contact : contacts) {
    if (!(contact.depth > 0.0)) continue;
    const Vec3 arm = bone_from_world * (contact.position - tool_origin), normal = bone_from_world * contact.normal;
    if (pressing <= kMaxPressedPoints) {
      out.points[out.count++] = {.point = contact.point, .arm = arm, .normal = normal, .load = contact.depth * load_per_depth};
      continue;
    }
    Cell& cell = cells[bounds.cell_of(contact.position)];
    cell.normal += contact.depth * normal;
    cell.arm += contact.depth * arm;
    cell.depth += contact.depth;
  }
  if (pressing <= kMaxPressedPoints) return;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    const double along = glm::length(cells[n].normal);
    if (!(along > 0.0)) continue;
    out.points[out.count++] = {.point = static_cast<std::uint32_t>(n),
                               .arm = cells[n].arm / cells[n].depth,
                               .normal = cells[n].normal / along,
                               .load = along * load_per_depth};
  }
}

double mean_square_lever(const PointShell& shell) noexcept {
  double sum = 0.0;
  for (const Vec3& p : shell.positions) sum += glm::dot(p, p);
  constexpr double kLeast = 1e-6;  // [m^2] of a shell of one point at the origin
  return std::max(kLeast, sum / static_cast<double>(shell.size()));
}

Wrench TangentialSpring::step(TangentialLaw& law, const TangentialSpringConfig& config, std::span<const PressedPoint> points,
                              const Pose& bone_from_tool, const Vec3& spin, double dt) noexcept {
  if (points.empty()) {
    law.clear();
    placed_ = false;
    return {};
  }
  if (!placed_) {
    law.clear();
    before_ = bone_from_tool;
    stretch_ = {};
    placed_ = true;
  }
  const SmallMove free{stretch_.translation + (bone_from_tool.translation - before_.translation),
                       stretch_.turn + rotation_vector(bone_from_tool.rotation * glm::conjugate(before_.rotation))};
  const TangentialLoads found = law.loads(
      {.points = points, .free = free, .stiffness = config.stiffness, .turn_stiffness = config.turn_stiffness, .spin = spin, .dt = dt});
  stretch_ = {free.translation - found.move.translation, free.turn - found.move.turn};
  law.end_step(found.move);
  before_ = bone_from_tool;
  return found.on_tool;
}

}  // namespace burrhole
