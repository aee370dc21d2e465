/// core/drill/chip_load.h: what a tooth of a bit cuts in a step.
///   Units  SI.   Errors  none.   Thread  any.   Source  own derivation from the geometry of milling:
///   In a revolution the z teeth of a bit pass the area A of its cutting part, seen along the shaft, z times. A volume V of bone removed in
///   k revolutions is V / (k z) per tooth and revolution, and V / (k z A) thick on average: the uncut chip thickness, feed per tooth.
#pragma once

#include "core/tool/tool.h"

namespace burrhole {

/// The teeth of a bit.
struct CuttingTeeth {
  int count = 0;      ///< [-] z; 0: the tool does not cut
  double area = 0.0;  ///< [m^2] A
};
/// @returns z and A of a tool. Linear in the number of its erosion points; allocates.
[[nodiscard]] CuttingTeeth cutting_teeth(const Tool& tool);

/// Mean values of a step; all zero in a step without a turning spindle.
struct ChipLoad {
  double volume = 0.0;     ///< [m^3] of solid bone that a tooth removes in a revolution
  double thickness = 0.0;  ///< [m] mean uncut chip thickness
  double hardness = 0.0;   ///< [-] of the removed bone, weighted by its volume; 0: none was removed
  double force = 0.0;      ///< [N] tangential, on a tooth
  double power = 0.0;      ///< [W] of cutting, 2 pi n M
  bool cuts = false;       ///< bone was removed
};

/// Removal of a step.
struct ChipInput {
  double mass = 0.0;        ///< [m^3] removed, in volume of solid bone
  double hardness = 0.0;    ///< [-] its mean
  double tangential = 0.0;  ///< [N] cutting force on all teeth
  double torque = 0.0;      ///< [N m] M
  double spin = 0.0;        ///< [rev/s] n
  double dt = 0.0;          ///< [s]
};
[[nodiscard]] ChipLoad chip_load(const CuttingTeeth& teeth, const ChipInput& step) noexcept;

}  // namespace burrhole
