/// core/contact/contact_model.h: the interface every contact model answers. A model knows a point shell and turns bone and a pose into
/// what bone exerts on the tool.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/geometry.h"
#include "core/contact/contact_view.h"
#include "core/tool/tool.h"

namespace burrhole {

/// One colliding shell point and its tangent plane, world frame.
struct Contact {
  std::uint32_t point = 0;  ///< index into the shell
  Vec3 position{0.0};       ///< [m] of the shell point (the paper's P_h)
  Vec3 plane_point{0.0};    ///< [m] a point of the plane (P_i)
  Vec3 normal{0.0};         ///< outward unit normal of bone (N)
  double depth = 0.0;       ///< [m] under the plane by the model's own law, >= 0
};

/// What went other than planned in one evaluation; degrade, go on, tell.
enum ContactFlag : std::uint32_t {
  kContactOutsideWindow = 1u << 0,  ///< a shell point lay outside what the window knows
  kContactNoSurface = 1u << 1,      ///< a march met its bound without finding a surface; that point gave no force
  kContactZeroGradient = 1u << 2,   ///< a surface voxel without gradient; the tool vector stood in
  kContactNotFinite = 1u << 3,      ///< the pose was not finite; the result is zero
  kContactUnsettled = 1u << 4,  ///< the held tool met its bound on moves or planes before it came to rest; it is on its way, on bone's side
};

/// Reserve once, reuse every tick: evaluate() never allocates when contacts.capacity() covers the shell.
struct ContactResult {
  Wrench wrench;             ///< on the tool, about the tool origin, world frame
  Mat3 force_gradient{0.0};  ///< d force / d position of the tool [N/m], world frame (for [AcostaLiu07] eq. 3)
  std::vector<Contact> contacts;
  std::size_t touching = 0;  ///< colliding points that found their plane: as many as there are contacts, listed or not
  double deepest = 0.0;      ///< [m] greatest depth of a contact
  std::uint32_t flags = 0;
  bool list_contacts = true;  ///< in: false leaves `contacts` empty where a model need not list them (a fifth of its time)
};

class ContactModel {
 public:
  virtual ~ContactModel() = default;
  /// Overwrites `out` but for what it is asked for; zero when apart. Cost bounded by shell size times the march limits of the model.
  virtual void evaluate(const ContactView& bone, const Pose& world_from_tool, ContactResult& out) const noexcept BH_REALTIME = 0;
  [[nodiscard]] virtual const PointShell& shell() const noexcept = 0;
};

}  // namespace burrhole
