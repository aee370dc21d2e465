/// app/effect/dura_rent.h: where a torn sheet is open: a smooth edge round the triangles that are gone, instead of their zigzag.
///   The opening at a point is the share of torn triangles round it, weighted by a normal distribution of kBlur spacings; the sheet ends where it
///   exceeds kEdge, less a little where its fibres fray. What no whole edge joins to the rim any more is gone.
///   Frame  sheet frame.   Units  m.   Errors  none.   Thread  any.   Source  own.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/sheet/elastic_sheet.h"

namespace burrhole {

class DuraRent {
 public:
  static constexpr double kEdge = 0.38, kBlur = 0.42;  ///< [-], [spacings]
  using Nodes = std::array<std::uint32_t, 3>;          ///< of a triangle

  /// @param lattice must outlive this. @param broken of each edge of the lattice, not 0: it is.
  DuraRent(const SheetLattice& lattice, const std::vector<std::uint8_t>& broken);

  [[nodiscard]] bool empty() const noexcept { return torn_.empty(); }
  [[nodiscard]] bool is_held(std::uint32_t node) const noexcept { return held_[node] != 0; }
  /// @returns whether a torn triangle is within reach of a node, so that the opening may differ from 0 beside it.
  [[nodiscard]] bool is_near(std::uint32_t node) const noexcept { return near_[node] != 0; }
  struct Opening {
    double share = 0.0;     ///< [-] 0..1
    glm::dvec2 slope{0.0};  ///< [1/m] its gradient along x and y
  };
  /// @param p [m] at rest.
  [[nodiscard]] Opening at(const glm::dvec2& p) const noexcept;
  /// Replaces the vectors of nodes that are not held, which lie anywhere, by means of their neighbours'.
  void fill_lost(std::vector<Vec3>& moved) const;

 private:
  [[nodiscard]] std::pair<double, double> order(const glm::dvec2& p) const noexcept;
  template <class F>
  void for_each_torn(const glm::dvec2& p, F&& f) const;

  const SheetLattice* lattice_;
  double spacing_;
  std::vector<std::uint8_t> held_, near_;  // nodes
  std::vector<glm::dvec2> torn_;           // [m] middles of torn triangles, by rows, so that those round a point are found
};

/// Calls f for the three nodes of each triangle of a lattice, anticlockwise.
template <class F>
void for_each_triangle(const SheetLattice& lattice, F&& f) {
  for (std::uint32_t n = 0; n < lattice.nodes(); ++n) {
    const SheetLattice::Neighbours& beside = lattice.neighbours(n);
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t b = beside[k], c = beside[k + 1];
      if (b != SheetLattice::kNoNode && c != SheetLattice::kNoNode) f(DuraRent::Nodes{n, b, c});
    }
  }
}

}  // namespace burrhole
