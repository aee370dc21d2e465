/// core/sheet/sheet_solver.h: the linear equations A x = b of a step of ElasticSheet, by conjugate gradients with the inverse blocks of the
///   diagonal as preconditioner. Each result goes downhill.
///   A      on the free nodes: all + up along z + bending + edges. On the rim, which is clamped, right sides and results are 0.
///   Bits   equal at every SIMD level, and to the same sums taken node by node: lanes are nodes, and each node's sum and each scalar
///          product has its terms in one order. Values that are not finite may give other bits.
///   Frame  of the sheet.   Units  SI.   Errors  none.   Thread  one. Allocates in the constructor only.   Source  own derivation.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/geometry.h"
#include "core/sheet/sheet_kernels.h"
#include "core/sheet/sheet_lattice.h"

namespace burrhole {

/// A symmetric matrix of 3 x 3.
struct SheetBlock {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;  ///< [N/m], or [m/N] of an inverse one
  [[nodiscard]] Vec3 operator*(const Vec3& v) const noexcept {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

/// Rows of a matrix that is the same along x, y and z: row n has the columns [first[n], first[n + 1]), in the order of their sum.
struct SheetRows {
  std::vector<std::uint32_t> first{}, column{};  ///< [-]
  std::vector<double> value{};                   ///< [N/m]
};

/// What else A has. All are over nodes but `edges`.
struct SheetCurve {
  std::span<const double> all, up;         ///< [N/m] in all directions; along z
  std::span<const SheetBlock> edges;       ///< [N/m] of each edge; 0: it is broken
  std::span<const SheetBlock> diagonal{};  ///< [m/N] inverse blocks
};

class SheetSolver {
 public:
  /// @param bending rows of the free nodes, with columns of free nodes up to two steps away; those on the rim are empty.
  SheetSolver(const SheetLattice& lattice, SheetRows bending);

  [[nodiscard]] const SheetRows& bending() const noexcept { return rows_; }

  static constexpr int kMost = 400;  ///< steps of the method
  /// @param right 0 on the rim. @param out where to start, 0 on the rim; receives the solution. @param rest receives right - A out, as the
  /// method has it. @param tolerance of the rest over `right`, as the preconditioner measures both. @returns the steps made.
  int solve(const SheetCurve& curve, std::span<const Vec3> right, std::span<Vec3> out, std::span<Vec3> rest, double tolerance) noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  [[nodiscard]] double* array(std::size_t which) noexcept { return arrays_.data() + which * stride_ + lead_; }
  void find_spans(const SheetLattice& lattice, const std::vector<std::size_t>& terms);
  void place_rows(const SheetLattice& lattice, const std::vector<std::size_t>& terms);

  SheetRows rows_;
  std::vector<SheetSpan> spans_;
  std::vector<std::uint32_t> odd_;   // nodes whose row has another order
  std::vector<std::uint64_t> free_;  // all bits: not on the rim
  std::vector<std::size_t> place_;   // of an edge, in the arrays
  std::size_t nodes_, lead_ = 0, stride_ = 0;
  std::vector<double> arrays_;
};

}  // namespace burrhole
