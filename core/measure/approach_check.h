/// core/measure/approach_check.h: where an approach that cannot be used should start, found on the bone as loaded.
///   Frame  bone frame.   Units  SI; millimetres in texts.   Errors  none.   Thread  any; reads the bone only.   Source  own definition.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/measure/approach.h"

namespace burrhole {

/// The start of an approach.
struct ApproachStart {
  Vec3 entry{0.0};  ///< [m] on the outer surface
  Vec3 axis{0.0};   ///< [-] unit vector into bone
};

/// @returns the keys entry_mm and axis of [approach] with these values, as written in a scene.
[[nodiscard]] std::string start_text(const ApproachStart& start);

/// @returns where the bone nearest to a point is: its distance, and the way to it along the patient's axes, those of at least 1 mm. Empty if
/// there is no bone.
[[nodiscard]] std::string way_to_bone(const BoneModel& bone, const Vec3& point);

/// For an approach that begins in bone or meets none: where bone is, best first. The surface above the entry, the first bone on the whole axis
/// within 0.3 m, and the bone nearest to the entry, with the axis of the scene and with that from the entry to it. None is checked.
[[nodiscard]] std::vector<ApproachStart> possible_starts(const BoneModel& bone, const ApproachScene& scene);

/// @returns what is wrong with an approach whose axis leaves the skull, with the start of the opposite approach; nothing for a valid one. The
/// axis leaves the skull if dura or brain lies above the entry; or if both surfaces of the bone are hollow towards the start of the axis,
/// measured 12 mm round it; or if bone as loaded lies on the axis more than 20 mm above the entry and none beyond its inner surface, unless
/// both surfaces bulge towards the start, as they do from outside. The last rule needs a volume that holds both sides of the skull.
[[nodiscard]] std::optional<std::string> leaves_skull(const BoneModel& bone, const Approach& approach);

}  // namespace burrhole
