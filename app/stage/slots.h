/// app/stage/slots.h: the slots of the stage: those that it writes before a clock's steps, and those that effects write.
///   Frame  world unless stated.   Units  SI.   Errors  none: Status is a slot's type only.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/stage/step_graph.h"
#include "core/contact/bone_view.h"
#include "core/contact/contact_model.h"
#include "core/drill/chip_load.h"
#include "core/drill/erosion.h"
#include "haptics/hand/hand_source.h"

namespace burrhole {

/// Input of a contact model.
struct Touch {
  const BoneView* bone = nullptr;  ///< valid in this tick
  HandState hand;
};

/// Input of a simulation step: motion of the tool and cutting force.
struct Cut {
  /// Poses (index from tool) of the step, with their lead (tool_lead.h), without the first part, on which no bone can be near.
  ErosionPath path;
  bool far = false;              ///< no bone is near anywhere in the step: nothing is eroded, the window need not hold the path
  double thrust = 0.0;           ///< [N] mean cutting force since the previous step
  Vec3 reaction{0.0, 0.0, 1.0};  ///< [-] unit, tool frame: direction of the last force of bone on the tool
};

/// Result of erosion in a simulation step.
struct BoneRemoval {
  double mass = 0.0;          ///< [m^3] removed mass of this step, in volume of full bone
  double work = 0.0;          ///< [J] of the removal, law `energy`; 0: the law states none
  double torque = 0.0;        ///< [N m] load of cutting on the spindle
  bool cutting = false;       ///< a spin is commanded (spin_asked > 0); the spindle itself may still be at rest
  bool changed = false;       ///< bone was removed and committed to the voxmap
  std::uint32_t outside = 0;  ///< ErosionOutcome::outside of this step
};

/// A tangential contact law (friction), and the tool's rotation rate, from which the law has the speed of the rim.
struct Tangential {
  TangentialLaw* law = nullptr;  ///< not owned
  double rate = 0.0;             ///< [rad/s] about +z of the tool
};

/// Constraints that effects add to contact. Constraints beyond kMax are dropped and counted.
struct Constraints {
  static constexpr std::size_t kMax = kMaxConstraints;
  std::array<ContactConstraint, kMax> items{};
  std::uint32_t size = 0, dropped = 0;
  void add(const ContactConstraint& one) noexcept {
    if (size < kMax)
      items[size++] = one;
    else
      ++dropped;
  }
};

/// A requested picture.
struct Picture {
  const std::string* name = nullptr;
  std::optional<Pose> world_from_tool;  ///< absent: the tool is not drawn
  bool cut = false;                     ///< bone is clipped at a plane through the approach axis
  bool film = false;                    ///< a frame of the run's film; `name` is null then
};

namespace slots {
// servo clock
inline const SlotKey<HandState> kHand{"hand"};          ///< the stage's: the motion of this tick
inline const SlotKey<Vec3> kAddedForce{"added_force"};  ///< add: [N] on the hand, in addition to contact, before all limits
// contact clock
inline const SlotKey<Touch> kTouch{"touch"};                    ///< the stage's
inline const SlotKey<ContactState> kContact{"contact"};         ///< owned by [contact]; without it, the tool's pose is the hand's
inline const SlotKey<Tangential> kTangential{"tangential"};     ///< owned by one effect; contact's friction
inline const SlotKey<Constraints> kConstraints{"constraints"};  ///< add
// simulation clock
inline const SlotKey<Cut> kCut{"cut"};                  ///< the stage's
inline const SlotKey<BoneMotion> kBone{"bone"};         ///< the stage's: motion of the bone; at rest without [motion]
inline const SlotKey<double> kSpin{"spin"};             ///< [rev/s] owned by [spindle]; otherwise the stage's, equal to spin_asked
inline const SlotKey<double> kSpinAsked{"spin_asked"};  ///< [rev/s] the stage's: command times the scene's spin
inline const SlotKey<BoneRemoval> kRemoval{"removal"};  ///< owned by [erosion]
inline const SlotKey<ChipLoad> kChipLoad{"chip_load"};  ///< owned by [erosion], in a scene with Needs::chip_load
// frame clock
inline const SlotKey<Picture> kPicture{"picture"};             ///< the stage's
inline const SlotKey<Status*> kPictureError{"picture_error"};  ///< the stage's: receives the error of a picture
}  // namespace slots

}  // namespace burrhole
