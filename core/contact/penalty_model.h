/// core/contact/penalty_model.h: the interface of penalty models: computes the force of bone on the tool from a point shell, bone and a
///   pose.
///   Frame  world.   Units  SI.   Thread  that of the caller; no state. penalty_contact.h and coupled_contact.h make a ContactModel of one.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/geometry.h"
#include "core/contact/contact_flag.h"
#include "core/contact/contact_view.h"
#include "core/tool/tool.h"

namespace burrhole {

/// One colliding shell point and its tangent plane, world frame.
struct Contact {
  std::uint32_t point = 0;  ///< index into the shell
  Vec3 position{0.0};       ///< [m] of the shell point (P_h in the paper)
  Vec3 plane_point{0.0};    ///< [m] a point of the plane (P_i)
  Vec3 normal{0.0};         ///< [-] outward unit normal of bone (N)
  double depth = 0.0;       ///< [m] below the plane by the model's own law, >= 0
};

/// Reserve once and reuse: evaluate() does not allocate when contacts.capacity() covers the shell.
struct ContactResult {
  Wrench wrench;             ///< [N], [N m] on the tool, about the tool origin, world frame
  Mat3 force_gradient{0.0};  ///< [N/m] d force / d position of the tool, world frame (for [AcostaLiu07] eq. 3)
  std::vector<Contact> contacts;
  std::size_t touching = 0;  ///< number of colliding points with a plane: the number of contacts, listed or not
  double deepest = 0.0;      ///< [m] greatest depth of a contact
  std::uint32_t flags = 0;
  bool list_contacts = true;  ///< in: false leaves `contacts` empty where a model need not list them (saves a fifth of the time)
};

/// Clears `out` except list_contacts. @returns whether the pose is finite; if it is not, kContactNotFinite is set.
[[nodiscard]] inline bool begin_evaluation(const Pose& world_from_tool, ContactResult& out) noexcept {
  out.wrench = {};
  out.force_gradient = Mat3(0.0);
  out.contacts.clear();
  out.touching = 0;
  out.deepest = 0.0;
  const Quat& turn = world_from_tool.rotation;
  const bool finite = is_finite(world_from_tool.translation) && std::isfinite(turn.w + turn.x + turn.y + turn.z);
  out.flags = 0;
  if (!finite) out.flags = kContactNotFinite;
  return finite;
}

class PenaltyModel {
 public:
  virtual ~PenaltyModel() = default;
  /// Overwrites `out` except list_contacts; zero without contact. The cost is bounded by shell size times the march limits of the model.
  virtual void evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept BH_REALTIME = 0;
  [[nodiscard]] virtual const PointShell& shell() const noexcept = 0;
  [[nodiscard]] virtual double stiffness() const noexcept = 0;  ///< [N/m] > 0, of one point
};

}  // namespace burrhole
