// The oracle of drilled holes, against sums over fine cells.

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "app/lab/oracle/drilled_volume.h"

using namespace burrhole;

namespace {

constexpr SweptBit kBall{3e-3, 0.0}, kCrown{6e-3, 5e-3};
constexpr double kThickness = 4e-3;  // [m]

/// Volume [m^3] of the bit's cross-section, times the height [m] of bone over each place, in 600 x 600 cells: the rim of a circle passes 2400
/// of them or fewer, each wrong by half at most and with either sign.
double summed(const SweptBit& bit, const std::function<double(double x, double y)>& height) {
  constexpr int kCells = 600;
  const double edge = 2.0 * bit.radius / kCells;
  double sum = 0.0;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const double x = (i + 0.5) * edge - bit.radius, y = (j + 0.5) * edge - bit.radius, r = std::hypot(x, y);
      if (r < bit.radius && r >= bit.bore) sum += height(x, y);
    }
  return sum * edge * edge;
}

}  // namespace

TEST_CASE("drilled volume: a plate, a block edge and a shell match sums over cells, for a solid bit and a crown") {
  for (const SweptBit& bit : {kBall, kCrown}) {
    CHECK(through_plate(bit, kThickness) == doctest::Approx(summed(bit, [](double, double) { return kThickness; })).epsilon(2e-3));
    for (const double inset : {-1.5e-3, 0.0, 1.5e-3, 5.5e-3, 7e-3}) {
      const double reference = summed(bit, [&](double x, double) { return x < inset ? kThickness : 0.0; });
      CHECK(through_edge(bit, kThickness, inset) == doctest::Approx(reference).epsilon(4e-3));
    }
    const double outer = 80e-3, inner = outer - kThickness;
    const double shell = summed(
        bit, [&](double x, double y) { return std::sqrt(outer * outer - x * x - y * y) - std::sqrt(inner * inner - x * x - y * y); });
    CHECK(through_shell(bit, kThickness, outer) == doctest::Approx(shell).epsilon(2e-3));
  }
}

TEST_CASE("drilled volume: limits") {
  CHECK(through_edge(kBall, kThickness, 3e-3) == doctest::Approx(through_plate(kBall, kThickness)));
  CHECK(through_edge(kBall, kThickness, -3e-3) == 0.0);
  CHECK(through_edge(kBall, kThickness, 0.0) == doctest::Approx(0.5 * through_plate(kBall, kThickness)));
  // A shell of large curvature is a plate.
  CHECK(through_shell(kBall, kThickness, 10.0) == doctest::Approx(through_plate(kBall, kThickness)).epsilon(1e-4));
}
