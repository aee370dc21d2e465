/// core/measure/cross_section.h: the cross-section of a bit's leading cutter, and the share of it that is drilled through bone.
///   The cross-section is the projection of the cutting part along the axis, from the tip up to the first shoulder: a disc for a drill or a
///   burr, a ring for a trephine, a rectangle for a saw blade; of a 14/11 perforator the inner drill alone. A shoulder is where the cutting
///   part widens by more than 0.25 mm after it has not widened over 0.5 mm of its length.
///   A column is the bone before the run beside the axis, parallel to it, over one cell of the cross-section: from its first bone to its last, a
///   gap of less than 2 mm being bone. It is clear if none of that bone is left.
///   Frame  tool frame (cells); the tool stands in the approach frame without rotation.   Units  SI.   Errors  none.
///   Thread  simulation (reads the voxmap).   Source  own definition.
#pragma once

#include <optional>
#include <vector>

#include "core/measure/approach.h"
#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

/// A cell of the cross-section, a square of edge CrossSection::pitch.
struct SectionCell {
  double x = 0.0, y = 0.0;  ///< [m] of its centre
  double lowest = 0.0;      ///< [m] height above the tip of the lowest cutting point over it
};

struct CrossSection {
  double pitch = 0.0;  ///< [m]
  std::vector<SectionCell> cells;
  double radius = 0.0;   ///< [m] largest distance of a cell from the axis
  bool on_axis = false;  ///< false: the bit leaves bone on its axis, as a crown does
  [[nodiscard]] double area() const noexcept { return pitch * pitch * static_cast<double>(cells.size()); }  ///< [m^2]
};

/// @returns the cross-section of the leading cutter; without cells if the bit has no erosion point.
[[nodiscard]] CrossSection leading_section(const ErosionPoints& points);

struct SectionMeasure {
  double cleared = 0.0;  ///< [-] share of the columns with bone as loaded that are clear, 0..1
  std::optional<double>
      uncut{};  ///< [-] share that is not clear, of the columns that the bit has passed; nothing if it has passed less than half of them
};

/// @param deepest [m] greatest depth of the tip. The bit has passed a column if its lowest cutting point over it was more than 0.5 mm and a
/// voxel deeper than the column's last bone. @returns nothing if no column has bone; of bone that was drilled before the run, if
/// less than half of them have: the bit follows a hole that was there.
[[nodiscard]] std::optional<SectionMeasure> measure_section(const Voxmap& voxmap, const Approach& approach, const CrossSection& section,
                                                            double deepest);

}  // namespace burrhole
