/// app/lab/stability_parts.h: what hard cases are made of: tools, scenes, ways of the hand, and the bounds that most of them share.
///   Units  lengths of the makers in mm, as in scene files; times in s.
#pragma once

#include <string>
#include <vector>

#include "app/lab/stability_case.h"

namespace burrhole::stability {

// The loop that all cases are run with: a generic 8 N device in a nominal hand, told 8/28 of the force, so that its 8 N are a thrust of 28
// N.
inline constexpr double kForceLimit = 28.0;                         ///< [N] force_N of the servo
inline constexpr double kForceBound = kForceLimit * (1.0 + 1e-12);  ///< [N] a vector shortened to a length is off by a few roundings
// Bounds, each with its reason.
inline constexpr double kPull = 0.05;      ///< [N] the device's own friction over its scale is 0.175 N: a third of what could be noticed
inline constexpr double kEnergy = 0.05;    ///< [mJ] one step of position, 0.05 mm, at 1 N of the grip: what a device cannot tell from rest
inline constexpr double kCycle = 0.1;      ///< [mm] two steps of position
inline constexpr double kRipple = 10.0;    ///< [%] the smallest difference of a force that is noticed at 2 to 5 N
inline constexpr double kRestSpeed = 1.0;  ///< [mm/s] one step of position in 50 ms
inline constexpr double kPenetration = 0.1;  ///< [voxel] at spin 0, whatever the push; of the 0.5 surface
inline constexpr double kCurved =
    kPenetration + 0.25 / (4.0 * 2.0);       ///< [voxel] in a hollow of 2 mm, whose 0.5 surface is off by edge / (4 R)
inline constexpr double kSlideStep = 0.3;    ///< [N] a tenth of the 3 N with which slides press, on a device of exact positions
inline constexpr double kDeviceStep = 0.42;  ///< [N] one step of position over the coupling: 5000 N/m x 0.05 mm + 10 N s/m x 0.05 mm / 3 ms
/// [mJ] Bone that is felt again under a hand 3 mm in it stretches the hand's spring of 300 N/m and the wall's own of 1429 N/m (the
/// coupling's 5000, as the device shows it) by 3 mm between them: in series 248 N/m, and half of that times 3 mm squared must come from the
/// wall, however slowly.
inline constexpr double kLifted = 1.116 + kEnergy;
/// [mm/s] As fast as that hand goes with the balance of the two springs, fastest at first: 3 mm x 1429 / 300 over the 0.2 s of the soft
/// start.
inline constexpr double kLiftSpeed = 71.5;
inline constexpr double kDrag = 0.03;  ///< [mJ/mm] 1 % of those 3 N: bone of this version has no friction

/// A ball of 4 mm that cuts where it spins, its points `pitch_mm` apart.
[[nodiscard]] std::string ball(double pitch_mm = 0.5);
/// A flat cylinder.
[[nodiscard]] std::string pin(double diameter_mm, double pitch_mm);

struct SceneParts {
  std::string volume;       ///< keys of [volume]
  double entry_x_mm = 0.0;  ///< where the way in is
  double entry_y_mm = 0.0;
  bool exact = false;   ///< a device of exact positions, without friction: what is left is the model's own
  bool drills = false;  ///< spins at 1000 rpm and cuts
};
[[nodiscard]] std::string scene(const SceneParts& parts);
/// A level plate of 7 mm.
[[nodiscard]] std::string plate(const std::string& more = {});

/// Down onto bone from 1 mm above within half a second, `depth_mm` under its surface, and from 1.5 s to 1.8 s up to 3 mm above.
[[nodiscard]] std::vector<Waypoint> press(double depth_mm, double x_mm = 0.0);
inline constexpr TimeSpan kPressed{1.1, 1.5};  ///< at rest on bone, by press()
inline constexpr TimeSpan kLeft{2.2, 2.4};     ///< at rest above it
inline constexpr double kPressTime = 2.4;      ///< [s]

/// What holds in any case: finite, within the limit, no force that outlives its bone, no energy from nowhere.
[[nodiscard]] std::vector<StabilityCheck> always();
/// always(), and a press(): at rest on bone, no pull on the way out, at rest above.
[[nodiscard]] std::vector<StabilityCheck> pressed();
/// The same list with more at its end.
[[nodiscard]] std::vector<StabilityCheck> with(std::vector<StabilityCheck> checks, std::vector<StabilityCheck> more);
/// The held tool's own: at spin 0 no point enters bone, and none comes to the far side.
[[nodiscard]] std::vector<StabilityCheck> held_back(double penetration = kPenetration);

// The cases, by kind.
void add_shapes(std::vector<StabilityCase>& out);
void add_motions(std::vector<StabilityCase>& out);
void add_drilling(std::vector<StabilityCase>& out);
void add_troubles(std::vector<StabilityCase>& out, bool long_runs);

}  // namespace burrhole::stability
