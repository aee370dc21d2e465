/// core/base/matrix6.h: 6 x 6 linear systems. Callers order components as translation, then rotation.
#pragma once

#include <array>
#include <cstddef>

namespace burrhole {

using Vector6 = std::array<double, 6>;
using Matrix6 = std::array<Vector6, 6>;

/// @returns x with A x = b, by L D L^T. @param a a[row][column], symmetric positive definite; only the lower triangle is read. Not checked:
/// other matrices give wrong, infinite or NaN results.
[[nodiscard]] inline Vector6 solve_spd(Matrix6 a, Vector6 b) noexcept {
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k] * a[k][k];
    for (std::size_t i = j + 1; i < 6; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k] * a[k][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
  for (std::size_t i = 0; i < 6; ++i) b[i] /= a[i][i];
  for (std::size_t i = 6; i-- > 0;)
    for (std::size_t k = i + 1; k < 6; ++k) b[i] -= a[k][i] * b[k];
  return b;
}

}  // namespace burrhole
