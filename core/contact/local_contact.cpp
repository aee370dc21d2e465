#include "core/contact/local_contact.h"

#include <algorithm>
#include <cmath>

#include "core/contact/tangential_law.h"

namespace burrhole {
namespace {

constexpr std::size_t kDirections = 24;         // faces of a cube, four sectors each
constexpr double kLargestTurnStiffness = 1e12;  // [N m/rad] replaces infinity
constexpr std::size_t kMostContacts = 32;       // of a penalty model that are listed one by one
static_assert(kDirections <= kMaxLocalPlanes && kMostContacts <= kMaxPressedPoints);

/// Index, below kDirections, of a unit vector's sector.
std::size_t direction_of(const Vec3& n) noexcept {
  const Vec3 size = glm::abs(n);
  const std::size_t axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  const auto positive = [&](std::size_t a) -> std::size_t { return n[a] >= 0.0 ? 1 : 0; };
  return axis * 8 + positive(axis) * 4 + positive((axis + 1) % 3) * 2 + positive((axis + 2) % 3);
}

/// Index, below kDirections: axis and side of the normal, and the quadrant of the contact about the centre.
std::size_t place_of(const Contact& contact, const Vec3& middle) noexcept {
  const Vec3 size = glm::abs(contact.normal);
  const std::size_t axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  const auto beyond = [&](std::size_t a) -> std::size_t { return contact.position[a] >= middle[a] ? 1 : 0; };
  return axis * 8 + (contact.normal[axis] >= 0.0 ? 4 : 0) + beyond((axis + 1) % 3) * 2 + beyond((axis + 2) % 3);
}

/// [m] Mean weighted with depth; the first contact's position where all depths are 0.
Vec3 middle_of(std::span<const Contact> contacts) noexcept {
  Vec3 sum(0.0);
  double depth = 0.0;
  for (const Contact& contact : contacts) {
    sum += contact.depth * contact.position;
    depth += contact.depth;
  }
  return depth > 0.0 ? sum / depth : contacts.front().position;
}

HoldPlane plane_of(const Vec3& normal, const Vec3& arm, double depth, double stiffness, std::uint32_t point) noexcept {
  HoldPlane plane;
  plane.normal = normal;
  plane.arm = arm;
  plane.gap = -depth;
  plane.yield = 1.0 / stiffness;
  plane.point = point;
  plane.force = depth * stiffness;
  return plane;
}

/// Sums over the contacts of one direction.
struct Bundle {
  Vec3 pull{0.0};  // sum of depth * normal
  Vec3 arm{0.0};   // weighted with the depth
  double depth = 0.0;
  std::size_t count = 0;
};

/// @returns whether a plane resists a small motion through its own compliance.
bool carries(const HoldPlane& plane) noexcept { return plane.both_ways || plane.force > 0.0; }

Mat3 coupled_gradient(const LocalContact& local) noexcept {
  std::array<HoldPlane, kMaxLocalPlanes> loaded;
  std::size_t count = 0;
  for (const HoldPlane& plane : local.list())
    if (carries(plane)) loaded[count++] = plane;
  if (count == 0) return Mat3(0.0);
  const double spring = local.coupling_stiffness, turn_spring = std::min(local.turn_stiffness, kLargestTurnStiffness);
  const HoldProblem problem{.stiffness = spring,
                            .turn_stiffness = turn_spring,
                            .cutting_stiffness = local.cutting_stiffness > 0.0 ? local.cutting_stiffness : spring};
  Matrix6 whole = stiffness_of(problem, {loaded.data(), count});
  for (std::size_t n = 0; n < 6; ++n) whole[n][n] += n < 3 ? spring : turn_spring;
  factor_spd(whole);
  Mat3 out(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector6 pull{};
    pull[axis] = spring;
    const Vector6 moved = solve_factored(whole, pull);  // of the tool, for a hand that moves by 1 m
    out[static_cast<int>(axis)] = spring * Vec3(moved[0], moved[1], moved[2]);
    out[static_cast<int>(axis)][static_cast<int>(axis)] -= spring;
  }
  return 0.5 * (out + glm::transpose(out));
}

}  // namespace

void list_penalty(std::span<const Contact> contacts, const Vec3& tool_origin, double point_stiffness, LocalContact& out,
                  bool by_place) noexcept {
  out.kind = LocalKind::penalty;
  out.count = 0;
  if (!(point_stiffness > 0.0)) return;
  if (contacts.size() <= kMostContacts) {
    for (const Contact& contact : contacts)
      out.planes[out.count++] = plane_of(contact.normal, contact.position - tool_origin, contact.depth, point_stiffness, contact.point);
    return;
  }
  std::array<Bundle, kDirections> bundles{};
  const Vec3 middle = by_place ? middle_of(contacts) : Vec3(0.0);
  for (const Contact& contact : contacts) {
    Bundle& bundle = bundles[by_place ? place_of(contact, middle) : direction_of(contact.normal)];
    bundle.pull += contact.depth * contact.normal;
    bundle.arm += contact.depth * (contact.position - tool_origin);
    bundle.depth += contact.depth;
    ++bundle.count;
  }
  for (std::size_t n = 0; n < kDirections; ++n) {
    const Bundle& bundle = bundles[n];
    const double pull = glm::length(bundle.pull);
    if (pull == 0.0) continue;  // all points are at depth 0: no force yet
    const double count = static_cast<double>(bundle.count);
    out.planes[out.count++] =
        plane_of(bundle.pull / pull, bundle.arm / bundle.depth, pull / count, count * point_stiffness, static_cast<std::uint32_t>(n));
  }
}

Mat3 force_gradient(const LocalContact& local) noexcept {
  switch (local.kind) {
    case LocalKind::none:
      break;
    case LocalKind::penalty: {
      Mat3 out(0.0);
      for (const HoldPlane& plane : local.list())
        if (plane.gap < 0.0) out -= glm::outerProduct(plane.normal, plane.normal) / plane.yield;
      return out;
    }
    case LocalKind::coupled:
      return coupled_gradient(local);
  }
  return Mat3(0.0);
}

}  // namespace burrhole
