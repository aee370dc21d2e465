/// core/contact/contact_model.h: the stepping interface of all contact models. A model keeps its own state (a constrained tool, a virtual
///   tool with mass, or none) and computes one result per contact period from one hand motion.
///   Frame  world.   Units  SI.   Thread  contact; no allocation after creation.
///   Forms  surface_contact.h (the constrained tool), penalty_contact.h (gradient-plane or voxmap, tool pose = device pose),
///          coupled_contact.h (a penalty model on a virtual coupling).
#pragma once

#include <cstddef>
#include <memory>

#include "core/base/assert.h"
#include "core/contact/bone_view.h"
#include "core/contact/contact_additions.h"
#include "core/contact/contact_state.h"
#include "core/contact/hand_motion.h"

namespace burrhole {

struct CuttingField;
class ToolSurface;

/// Parameters of a model that are fixed at creation.
struct ContactOptions {
  double voxel_edge = 0.0;                        ///< [m] > 0, mean edge of the bone's voxels
  std::shared_ptr<const CuttingField> cutting{};  ///< the tool's cutting part, where bone is cut at sub-voxel resolution; null otherwise
  std::shared_ptr<const ToolSurface> surface{};   ///< the tool's surface between the points of its shell; null: its points only
  bool planes = false;                            ///< whether ContactState::local is filled; false saves the cost
  double foresight = 0.0;  ///< [s] time for which `local` must be valid: a contact period plus the latency of its result
};

struct ContactInput {
  const BoneView& bone;
  const HandMotion& hand;
  double dt = 0.0;  ///< [s] > 0, the contact period
  ToolSpin spin{};
  ContactAdditions added{};
};

class ContactModel {
 public:
  virtual ~ContactModel() = default;
  /// Moves the tool to a pose without a query of bone: at the start, after a tool change, an undo or a reset.
  virtual void place(const Pose& world_from_tool) noexcept = 0;
  /// One contact period. Writes all members of `out` except bone, hand_velocity, tick, number, spin, cutting_sum and position_sum, which the caller
  /// sets. Where bone near the tool has not been read, the tool is held in place by a spring, and flags has kContactOutsideWindow.
  virtual void step(const ContactInput& in, ContactState& out) noexcept BH_REALTIME = 0;
  /// Number of points of the shell.
  [[nodiscard]] virtual std::size_t points() const noexcept = 0;
};

}  // namespace burrhole
