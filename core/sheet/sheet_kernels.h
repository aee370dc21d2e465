/// core/sheet/sheet_kernels.h: SIMD kernel of the conjugate gradients of an elastic sheet. Internal to sheet_solver.cpp.
///   Frame  of the sheet; one array of each component, by node.   Units  SI.   Errors  none.
///   Bits   equal at every SIMD level: lanes are nodes, and scalar products are summed node by node.
///   Arrays are read and written in whole vectors: each needs kSheetPad entries beyond its last node, and those read beside a span memory before it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace burrhole {

inline constexpr std::size_t kSheetPad = 8;
inline constexpr std::size_t kBendTerms = 19;  ///< a node and those within two steps

/// Nodes in a row of the lattice, numbered one after another, whose neighbours are at the same distance in numbers.
struct SheetSpan {
  std::uint32_t first = 0, count = 0;
  std::array<std::int32_t, kBendTerms> bend{};  ///< [nodes] to the terms of bending, in the order of their sum
  std::array<std::int32_t, 3> onward{};         ///< [nodes] to the ends of the edges that begin at a node
  std::array<std::int32_t, 3> back{};           ///< [nodes] to the starts of those that end at it, in the order of the edges
};

struct SheetField {
  double *x, *y, *z;  ///< [m] or [N]
};
struct SheetBlocks {
  double *xx, *xy, *xz, *yy, *yz, *zz;  ///< [N/m], or [m/N] of inverse ones
};

struct SheetJob {
  std::size_t nodes;
  std::span<const SheetSpan> spans;
  std::array<const double *, kBendTerms> bend;  ///< [N/m] of each term
  std::span<const std::uint32_t> odd;           ///< nodes whose bending is taken from the rows
  const std::uint32_t *first, *column;          ///< rows of bending
  const double *value;                          ///< [N/m]
  const std::uint64_t *free;                    ///< all bits: not on the rim
  const double *all, *up;                       ///< [N/m]
  std::array<SheetBlocks, 3> edges;             ///< [N/m] by first node
  SheetBlocks diagonal;                         ///< [m/N]
  SheetField right, out, rest, search, product, conditioned;
  SheetField bent;                  ///< of the nodes of `odd`; 0 at the others
  std::array<SheetField, 3> pulls;  ///< of the edges that begin at a node
  double tolerance;                 ///< [-]
  int most;                         ///< [-] steps
};

/// @returns the steps made.
int conjugate_gradients(const SheetJob &job) noexcept;

}  // namespace burrhole
