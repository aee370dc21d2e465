/// core/drill/stress_strain.h: the stress-strain curve of a material, the work that it takes to deform and to break it, and how far a stress
///   gets. The curve runs from (0, 0) in straight lines through its points and ends where the material breaks.
///   Units  SI.   Errors  out_of_range from create().   Thread  any.
///   Source [TellesONeill10] section 7, future work: a material's full stress-strain curve should say what force removes it. The rest is our
///          own derivation: under a stress the strain rises to where the curve reaches that stress. The work done on a volume is the area
///          under the curve up to there; what of it is elastic, stress^2 / (2 E), comes back with the stress. E is the slope of the first line.
#pragma once

#include <vector>

#include "core/base/result.h"

namespace burrhole {

struct StressStrainPoint {
  double strain = 0.0;  ///< [-] > 0, rising
  double stress = 0.0;  ///< [Pa] > 0
};

class StressStrainCurve {
 public:
  /// Cortical bone in tension along the long axis: 17 GPa, yield at 115 MPa, fracture at 133 MPa and a strain of 3.1 % ([ReillyBurstein75],
  /// from memory, not verified).
  StressStrainCurve();
  /// out_of_range: fewer than two points, a strain that does not rise, a number that is not above 0 or not finite, or a curve that rises
  /// above its first line, which would give back more work than it took.
  [[nodiscard]] static Result<StressStrainCurve> create(std::vector<StressStrainPoint> points);

  /// [J/m^3] Work that breaks the material: the area under the whole curve.
  [[nodiscard]] double toughness() const noexcept { return toughness_; }
  /// [Pa] The largest stress of the curve; it breaks the material.
  [[nodiscard]] double strength() const noexcept { return strength_; }
  /// @returns the damage [-] that a stress [Pa] leaves, 0..1: the work that does not come back over the toughness; 0 on the first line, 1 from
  /// the strength on. Rises with the stress.
  [[nodiscard]] double damage_at(double stress) const noexcept;
  [[nodiscard]] const std::vector<StressStrainPoint>& points() const noexcept { return points_; }

 private:
  explicit StressStrainCurve(std::vector<StressStrainPoint> points);
  std::vector<StressStrainPoint> points_;
  double toughness_ = 0.0, strength_ = 0.0;
};

}  // namespace burrhole
