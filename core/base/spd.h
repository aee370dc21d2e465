/// core/base/spd.h: small linear systems with a symmetric positive definite matrix, by L D L^T.
#pragma once

#include <array>
#include <cstddef>

namespace burrhole {

template <std::size_t n>
using VectorN = std::array<double, n>;
template <std::size_t n>
using MatrixN = std::array<VectorN<n>, n>;  ///< a[row][column]; only the lower triangle is used

using Vector6 = VectorN<6>;
using Matrix6 = MatrixN<6>;

/// Replaces a matrix by its factors. Positive definiteness is not checked: other matrices give wrong, infinite or NaN results.
template <std::size_t n>
inline void factor_spd(MatrixN<n>& a) noexcept {
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k] * a[k][k];
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k] * a[k][k];
      a[i][j] /= a[j][j];
    }
  }
}

/// @returns x with A x = b. @param factors of A, by factor_spd().
template <std::size_t n>
[[nodiscard]] inline VectorN<n> solve_factored(const MatrixN<n>& factors, VectorN<n> b) noexcept {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < i; ++k) b[i] -= factors[i][k] * b[k];
  for (std::size_t i = 0; i < n; ++i) b[i] /= factors[i][i];
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= factors[k][i] * b[k];
  return b;
}

/// @returns x with A x = b, as above.
template <std::size_t n>
[[nodiscard]] inline VectorN<n> solve_spd(MatrixN<n> a, const VectorN<n>& b) noexcept {
  factor_spd(a);
  return solve_factored(a, b);
}

}  // namespace burrhole
