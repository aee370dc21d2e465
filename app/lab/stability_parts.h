/// app/lab/stability_parts.h: components of the hard cases: tools, scenes, paths of the hand, and common bounds.
///   Frame  approach frame for paths.   Units  arguments in mm, as in scene files; times in s.   Errors  none.
#pragma once

#include <string>
#include <vector>

#include "app/lab/stability_case.h"

namespace burrhole::stability {

// The loop of all cases: a generic 8 N device in a nominal hand with a force scale of 8/28, so that its 8 N correspond to a thrust of 28 N.
inline constexpr double kForceLimit = 28.0;                         ///< [N] force_N of the servo
inline constexpr double kForceBound = kForceLimit * (1.0 + 1e-12);  ///< [N] tolerance for rounding when a vector is scaled to a length
// Bounds and their reasons.
inline constexpr double kAttractiveForce = 0.05;  ///< [N] a third of the friction of the device over its force scale, 0.175 N
inline constexpr double kEnergy =
    0.05;  ///< [mJ] one quantum of position, 0.05 mm, at 1 N of the grip: the device cannot distinguish it from rest
inline constexpr double kCycle = 0.1;        ///< [mm] two quanta of position
inline constexpr double kRipple = 10.0;      ///< [%] just noticeable difference of a force of 2 to 5 N
inline constexpr double kRestSpeed = 1.0;    ///< [mm/s] one quantum of position in 50 ms
inline constexpr double kPenetration = 0.1;  ///< [voxel] below the 0.5 surface, at spin 0, for any force
inline constexpr double kCurved =
    kPenetration + 0.25 / (4.0 * 2.0);     ///< [voxel] in a concave surface of radius 2 mm, whose 0.5 surface deviates by edge / (4 R)
inline constexpr double kSlideStep = 0.3;  ///< [N] a tenth of the 3 N of sliding, on a device with exact positions
inline constexpr double kDeviceStep =
    0.42;  ///< [N] one quantum of position times the coupling: 5000 N/m x 0.05 mm + 10 N s/m x 0.05 mm / 3 ms
/// [mJ] If contact returns while the hand is 3 mm inside bone, the hand's spring of 300 N/m and the wall's spring of 1429 N/m (the
/// coupling's 5000 N/m at the grip) are stretched by 3 mm together: 248 N/m in series, and half of that times 3 mm squared must come from
/// the wall at any speed.
inline constexpr double kLifted = 1.116 + kEnergy;
/// [mm/s] Speed of that hand at the equilibrium of the two springs, largest at the start: 3 mm x 1429 / 300 over the 0.2 s of the soft
/// start.
inline constexpr double kLiftSpeed = 71.5;
inline constexpr double kDrag = 0.03;  ///< [mJ/mm] 1 % of those 3 N: bone has no friction in this version

/// A ball of 4 mm that cuts where it spins, with points `pitch_mm` apart.
[[nodiscard]] std::string ball(double pitch_mm = 0.5);
/// A flat cylinder.
[[nodiscard]] std::string pin(double diameter_mm, double pitch_mm);
/// A cone with its tip down, on a cylinder.
[[nodiscard]] std::string cone(double diameter_mm, double height_mm, double pitch_mm);
/// A box along x, its narrow face down.
[[nodiscard]] std::string blade(double width_mm, double depth_mm, double pitch_mm);

struct SceneParts {
  std::string volume;       ///< keys of [volume]
  double entry_x_mm = 0.0;  ///< [mm] entry of the approach
  double entry_y_mm = 0.0;  ///< [mm]
  bool exact = false;       ///< a device with exact positions and without friction: only effects of the model remain
  bool drills = false;      ///< spins at 1000 rpm and cuts
};
[[nodiscard]] std::string scene(const SceneParts& parts);
/// A level plate of 7 mm.
[[nodiscard]] std::string plate(const std::string& more = {});

/// From 1 mm above bone to `depth_mm` below its surface within half a second, and from 1.5 s to 1.8 s to 3 mm above.
[[nodiscard]] std::vector<Waypoint> press(double depth_mm, double x_mm = 0.0);
inline constexpr TimeSpan kPressed{1.1, 1.5};  ///< at rest on bone, by press()
inline constexpr TimeSpan kLeft{2.2, 2.4};     ///< at rest above bone
inline constexpr double kPressTime = 2.4;      ///< [s]

/// Bounds of every case: finite, within the force limit, no force that remains without bone, no generated energy.
[[nodiscard]] std::vector<StabilityCheck> always();
/// always() and the bounds of press(): at rest on bone, no attractive force while leaving, at rest above.
[[nodiscard]] std::vector<StabilityCheck> pressed();
/// @returns the list with further checks appended.
[[nodiscard]] std::vector<StabilityCheck> with(std::vector<StabilityCheck> checks, std::vector<StabilityCheck> more);
/// Bounds of the constrained tool: at spin 0 no point enters bone, and none reaches the far side.
[[nodiscard]] std::vector<StabilityCheck> held_back(double penetration = kPenetration);

// The cases, by kind.
void add_shapes(std::vector<StabilityCase>& out);
void add_motions(std::vector<StabilityCase>& out);
void add_drilling(std::vector<StabilityCase>& out);
void add_troubles(std::vector<StabilityCase>& out, bool long_runs);

}  // namespace burrhole::stability
