/// core/sheet/sheet_lattice.h: a disc of nodes on a triangular lattice, with its edges and its rim.
///   Frame  x, y in the plane of the lattice, origin in the middle.   Units  m.   Errors  out_of_range.   Thread  any; constant.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

struct SheetEdge {
  std::uint32_t a = 0, b = 0;
};

class SheetLattice {
 public:
  static constexpr std::size_t kMostNodes = 20'000;
  static constexpr std::uint32_t kNoNode = 0xffffffff;
  using Neighbours = std::array<std::uint32_t, 6>;  ///< anticlockwise; kNoNode: beyond the rim
  /// A point in a triangle of the lattice: three nodes and their weights.
  struct Place {
    std::array<std::uint32_t, 3> nodes{};
    std::array<double, 3> weights{};  ///< [-]
  };

  /// @param has whether the sheet has a node at a place; null: everywhere. out_of_range: radius or spacing not finite or above 0, less than
  /// two spacings in the radius, no node with all its neighbours, or more than kMostNodes.
  [[nodiscard]] static Result<SheetLattice> create(double radius, double spacing,
                                                   const std::function<bool(double x, double y)>& has = nullptr);

  [[nodiscard]] std::size_t nodes() const noexcept { return x_.size(); }
  [[nodiscard]] double spacing() const noexcept { return spacing_; }
  [[nodiscard]] double area() const noexcept;  ///< [m^2] of a node's cell
  [[nodiscard]] double x(std::size_t node) const noexcept { return x_[node]; }
  [[nodiscard]] double y(std::size_t node) const noexcept { return y_[node]; }
  [[nodiscard]] const Neighbours& neighbours(std::size_t node) const noexcept { return neighbours_[node]; }
  [[nodiscard]] bool on_rim(std::size_t node) const noexcept { return rim_[node] != 0; }  ///< a neighbour is missing
  [[nodiscard]] const std::vector<SheetEdge>& edges() const noexcept { return edges_; }
  /// @returns the triangle under a point of the plane; nothing beside the sheet.
  [[nodiscard]] std::optional<Place> find(double x, double y) const noexcept;
  /// @returns the edge between two nodes that are neighbours.
  [[nodiscard]] std::uint32_t edge(std::uint32_t a, std::uint32_t b) const noexcept;

 private:
  [[nodiscard]] std::uint32_t node_at(int i, int j) const noexcept;
  double spacing_ = 0.0;
  int reach_ = 0;                     // lattice coordinates are in [-reach_, reach_]
  std::vector<std::uint32_t> index_;  // by lattice coordinates
  std::vector<double> x_, y_;
  std::vector<Neighbours> neighbours_;
  std::vector<std::array<std::uint32_t, 6>> edge_of_;  // by node and neighbour
  std::vector<std::uint8_t> rim_;
  std::vector<SheetEdge> edges_;
};

}  // namespace burrhole
