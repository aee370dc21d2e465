/// core/base/matrix6.h: systems of six unknowns, translation first and then rotation.
#pragma once

#include <array>
#include <cstddef>

namespace burrhole {

using Six = std::array<double, 6>;
using Matrix6 = std::array<Six, 6>;

/// Solves A x = b by L D L^T. @param a symmetric positive definite; its lower half is read.
[[nodiscard]] inline Six solved(Matrix6 a, Six b) noexcept {
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
