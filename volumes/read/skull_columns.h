/// volumes/read/skull_columns.h: columns through the wall of a skull in a scan, from its outer surface to the cavity, and averages along it.
///   Frame  bone frame.   Units  SI; values in the unit of the scan.   Errors  none.   Thread  any; uses all cores.
#pragma once

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "core/base/geometry.h"
#include "volumes/read/scan.h"
#include "volumes/read/skull_cavity.h"

namespace burrhole {

/// @returns the value of the scan by trilinear interpolation; beyond its border that of the border.
[[nodiscard]] double scan_value(const Scan& scan, const Vec3& scan_index) noexcept;

struct WallColumn {
  Vec3 entry{0.0}, inward{0.0};  ///< [m], [-] unit
  double thickness = 0.0;        ///< [m] to the last bone before the cavity
};

/// The neighbours of places on a surface.
class Neighbours {
 public:
  /// @param reach [m] of the largest distance that is asked for.
  Neighbours(const std::vector<WallColumn>& columns, double reach);
  /// Calls f(number, distance) for all columns within `reach` of a column whose normals differ from its own by less than 45 degrees.
  void visit(std::size_t number, const std::function<void(std::size_t, double)>& f) const;

 private:
  [[nodiscard]] std::uint64_t key_of(const Vec3i& cell) const noexcept;
  const std::vector<WallColumn>* columns_;
  double reach_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

/// Finds columns about `pitch` [m] apart. @param smoothing [m] of the normals, standard deviation along the surface.
[[nodiscard]] std::vector<WallColumn> find_columns(const Scan& scan, const TissueLevels& levels, const SkullCavity& cavity, double pitch,
                                                   double smoothing);

}  // namespace burrhole
