/// core/tool/buried_cutters.h: cutting regions of a bit that its passive regions cover, so that they meet no bone.
///   Frame  tool frame.   Units  SI.   Errors  none.   Thread  any.   Source  own definition:
///   The surface of a region is sampled by the faces of cells of a 96th of its largest side. A face is covered if a passive region owns the
///   material behind it, or lies in front of it; faces towards another cutting region do not count. Covers thinner than a cell are not
///   noticed, and meshes are not examined.
#pragma once

#include <string>
#include <vector>

#include "core/tool/tool_spec.h"

namespace burrhole {

struct BuriedCutter {
  std::string region;  ///< name of the cutting region
  std::string body;    ///< name of the passive region that covers most of it
  double share = 0.0;  ///< [-] of its surface that is covered, kBuried..1
};

/// [-] Share from which a region is listed. A cutter that is fixed in a body shows its working end.
inline constexpr double kBuried = 0.9;

/// @returns the cutting regions that are covered, in the order of the file.
[[nodiscard]] std::vector<BuriedCutter> find_buried_cutters(const ToolSpec& spec);
/// @returns one line on it, for a user.
[[nodiscard]] std::string buried_text(const BuriedCutter& cutter);

}  // namespace burrhole
