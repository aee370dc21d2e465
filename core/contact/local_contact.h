/// core/contact/local_contact.h: contact in a small neighbourhood of one pose, as plain values: the data with which the servo continues
///   between two evaluations of a contact model.
///   Frame  world.   Units SI.   Thread  written by contact, read by the servo; trivially copyable.
///   Kinds:
///   penalty   the tool pose is the hand pose. At a displacement d of the hand the force is  sum over planes of N max(0, -(gap + N . d)) /
///             yield.
///   coupled   the tool has its own pose, constrained by the planes and coupled to the hand by springs. The problem of hold_solver.h with
///             these planes as candidates gives its pose; the force on the hand is K (tool - hand). Near planes without load are included,
///             so that a new contact acts before the next evaluation.
///   Source  [AcostaLiu07] eq. (3) extrapolates with the gradient of the same sum; the clamp per plane and the planes without load are our
///           own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/contact/hold_solver.h"
#include "core/contact/penalty_model.h"

namespace burrhole {

/// All planes that carry load, and one of each region of the tool where others are near, as far as there is room. With friction a plane that is left out is a force that is missing.
inline constexpr std::size_t kMaxLocalPlanes = kMaxHoldPlanes + 16;

enum class LocalKind : std::uint32_t { none, penalty, coupled };

struct LocalContact {
  LocalKind kind = LocalKind::none;
  std::uint32_t count = 0;
  /// Gaps and arms are at `world_from_tool` of the enclosing state. The gap of a cutting plane is that of the tool moved back by `engaged`,
  /// as in hold_solver.h. `point` identifies a plane.
  std::array<HoldPlane, kMaxLocalPlanes> planes{};
  // For coupled only.
  Vec3 engaged{0.0};                ///< [m]
  double coupling_stiffness = 0.0;  ///< [N/m]
  double coupling_damping = 0.0;    ///< [N s/m]
  double turn_stiffness = 0.0;      ///< [N m/rad]
  double cutting_stiffness = 0.0;   ///< [N/m] of the engagement that all cutting planes share (HoldProblem)
  // Tangential law (tangential_law.h); zero without one.
  Wrench tangential;                       ///< [N], [N m] load of the law on the tool at the sample; for a penalty contact part of on_hand
  Vec3 spin{0.0};                          ///< [rad/s] of the tool's surface
  double tangential_stiffness = 0.0;       ///< [N/m] penalty only: of the spring to the slider (tangential_spring.h)
  double tangential_turn_stiffness = 0.0;  ///< [N m/rad] penalty only, likewise

  [[nodiscard]] std::span<const HoldPlane> list() const noexcept { return {planes.data(), count}; }
};
static_assert(std::is_trivially_copyable_v<LocalContact>);

/// Sets the planes of a penalty model's contacts, each of `point_stiffness` [N/m] (for averaged contacts: the model's k over their number).
/// More than 32 are merged by direction: the force at the pose is kept, and a merged plane has the total stiffness of its
/// contacts.
/// @param by_place merges by the side of a cube and the quarter of that side's face instead, which preserves the rim speed of a spinning
/// tool.
void list_penalty(std::span<const Contact> contacts, const Vec3& tool_origin, double point_stiffness, LocalContact& out,
                  bool by_place = false) noexcept BH_REALTIME;

/// @returns d force on hand / d position of the hand [N/m], world frame, symmetric and negative semidefinite, for a small motion with a
/// constant set of loaded planes. Coupled: K (K + Kp)^-1 K - K, Kp the stiffness of the planes (stiffness_of()), of which it is the part of
/// the translation; penalty: -sum of N N^T / yield.
[[nodiscard]] Mat3 force_gradient(const LocalContact& local) noexcept BH_REALTIME;

}  // namespace burrhole
