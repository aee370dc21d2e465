/// core/contact/local_contact.h: contact in a small neighbourhood of one pose, as plain values: what the servo needs to go on by itself
///   between two evaluations of a contact model.
///   Frame  world.   Units SI.   Thread  filled by contact, read by the servo; trivially copyable.
///   Two kinds, as the models are of two kinds:
///   penalty   the tool is where the hand is: a hand moved by d feels  sum over planes of N max(0, -(gap + N . d)) / yield.
///   coupled   the tool is a body of its own, held back by the planes and tied to the hand by springs: hold_solver.h with these planes as
///             the candidates says where it is, and K (tool - hand) what the hand feels. Planes that are near but not touched are there
///             too, so that the next contact is felt before the next evaluation.
///   Source  [AcostaLiu07] eq. (3) extrapolates with the gradient of the same sum; clamping each plane to pushing and planes not yet
///           touched are our own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/contact/contact_model.h"
#include "core/contact/hold_solver.h"

namespace burrhole {

inline constexpr std::size_t kMaxLocalPlanes = 32;

enum class LocalKind : std::uint32_t { none, penalty, coupled };

struct LocalContact {
  LocalKind kind = LocalKind::none;
  std::uint32_t count = 0;
  /// Gaps and arms at `world_from_tool` of the state that carries this; of cutting planes the gap is that of the tool moved back by
  /// `engaged`, as in hold_solver.h. `point` tells planes apart.
  std::array<HoldPlane, kMaxLocalPlanes> planes{};
  // coupled only
  Vec3 engaged{0.0};                ///< [m]
  double coupling_stiffness = 0.0;  ///< [N/m]
  double coupling_damping = 0.0;    ///< [N s/m]
  double turn_stiffness = 0.0;      ///< [N m/rad]
  double cutting_stiffness = 0.0;   ///< [N/m] of the engagement shared by all cutting planes (HoldProblem)

  [[nodiscard]] std::span<const HoldPlane> list() const noexcept { return {planes.data(), count}; }
};
static_assert(std::is_trivially_copyable_v<LocalContact>);

/// The planes of a penalty model's contacts, each of `point_stiffness` [N/m] (contacts averaged: the model's k over their number). More
/// than kMaxLocalPlanes are merged by direction: the force at the pose stays, and each merged plane has the stiffness of all that it stands
/// for.
void list_penalty(std::span<const Contact> contacts, const Vec3& tool_origin, double point_stiffness,
                  LocalContact& out) noexcept BH_REALTIME;

/// d force on hand / d position of the hand [N/m], world frame, symmetric and negative semidefinite, for a small motion in which the planes
/// that carry load now stay the ones that do. Coupled: -N (N^T N / K + turns + Y)^-1 N^T; penalty: -sum of N N^T / yield.
[[nodiscard]] Mat3 force_gradient(const LocalContact& local) noexcept BH_REALTIME;

}  // namespace burrhole
