#include "core/drill/stress_strain.h"

#include <algorithm>
#include <cmath>

namespace burrhole {

StressStrainCurve::StressStrainCurve() : StressStrainCurve({{115e6 / 17e9, 115e6}, {0.031, 133e6}}) {}

StressStrainCurve::StressStrainCurve(std::vector<StressStrainPoint> points) : points_(std::move(points)) {
  StressStrainPoint before;
  for (const StressStrainPoint& point : points_) {
    toughness_ += 0.5 * (before.stress + point.stress) * (point.strain - before.strain);
    strength_ = std::max(strength_, point.stress);
    before = point;
  }
}

Result<StressStrainCurve> StressStrainCurve::create(std::vector<StressStrainPoint> points) {
  const auto refuse = [](const char* why) { return Error{ErrorCode::out_of_range, why, {}}; };
  if (points.size() < 2) return refuse("a stress-strain curve has two points or more: where the material yields, and where it breaks");
  double strain = 0.0;
  for (const StressStrainPoint& point : points) {
    if (!(std::isfinite(point.strain) && point.strain > strain))
      return refuse("the strains of a stress-strain curve must rise from above 0");
    if (!(std::isfinite(point.stress) && point.stress > 0.0)) return refuse("the stresses of a stress-strain curve must be above 0");
    if (point.stress * points.front().strain > points.front().stress * point.strain * (1.0 + 1e-9))
      return refuse("a stress-strain curve must not rise above its first line, which is elastic");
    strain = point.strain;
  }
  return StressStrainCurve(std::move(points));
}

double StressStrainCurve::damage_at(double stress) const noexcept {
  if (!(stress < strength_)) return 1.0;
  const double modulus = points_.front().stress / points_.front().strain;
  if (!(stress > points_.front().stress)) return 0.0;
  double work = 0.0;
  StressStrainPoint before;
  for (const StressStrainPoint& point : points_) {
    if (point.stress >= stress) {  // the stress lies on this line, which rises: before.stress < stress
      const double strain = (point.strain - before.strain) * (stress - before.stress) / (point.stress - before.stress);
      work += 0.5 * (before.stress + stress) * strain;
      break;
    }
    work += 0.5 * (before.stress + point.stress) * (point.strain - before.strain);
    before = point;
  }
  return std::clamp((work - 0.5 * stress * stress / modulus) / toughness_, 0.0, 1.0);
}

}  // namespace burrhole
