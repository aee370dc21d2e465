/// app/stage/force_loop.h: the loop of hand, device and coupling of a scene: its stability, and thresholds of the servo's detectors.
///   Units SI.   Errors  none.   Thread any, before a run.
#pragma once

#include <optional>
#include <string>

#include "app/stage/effect.h"

namespace burrhole {

/// @returns the loop of a scene. Its stiffness is 0 where the contact model has no coupling.
[[nodiscard]] ForceLoop force_loop(const StageConfig& config, const Needs& needs);
/// @returns a warning if that loop is unstable: the limit, and settings of which each alone makes it stable. Nothing for a loop that is
/// stable, that has no coupling, or whose hand receives no force.
[[nodiscard]] std::optional<std::string> loop_warning(const StageConfig& config, const Needs& needs);
/// @returns the thresholds of the detector of limit cycles; off where the hand receives no force. Own derivation, docs/servo.md.
[[nodiscard]] SwingConfig swing_config(const StageConfig& config, const Needs& needs);

/// @returns the energy detector of a scene. With a device its damping and, where the contact model has a coupling, its tolerance are set
/// unless the scene sets them; without a device it is the scene's.
[[nodiscard]] EnergyObserverConfig energy_config(const StageConfig& config, const Needs& needs);

}  // namespace burrhole
