/// core/tool/finest_feature.h: the thinnest cutting feature of a bit: a rim, a wall, a blade, a lip or a skin that a bone grid must resolve.
///   Frame  tool frame.   Units  SI.   Errors  none.   Thread  any.   Source  own definition:
///   A feature is the material between two opposite faces of a region of which both cut, or across an exposed lower face that cuts. An edge
///   that tapers to a point counts by its widest place, and regions that cut one above the other count as one along the shaft. Meshes are
///   not examined: their thickness is not known without a medial axis.
#pragma once

#include <optional>
#include <string>

#include "core/tool/tool_spec.h"

namespace burrhole {

struct CuttingFeature {
  double thickness = 0.0;  ///< [m] > 0
  std::string region;      ///< name of the region
  const char* kind = "";   ///< "width", "depth", "height", "diameter", "wall", "step" or "skin"
};

/// @returns the thinnest one; nothing for a bit that does not cut.
[[nodiscard]] std::optional<CuttingFeature> finest_cutting_feature(const ToolSpec& spec);

}  // namespace burrhole
