/// app/lab/oracle/solid_depth.h: how deep bone is inside a tool, as an oracle: the tool is the solid of its file, bone the points of the
///   trilinear 0.5 surface of its voxels.
///   Frame  tool frame, bone frame as named.   Units  SI.   Errors  none.   Thread  any; create() allocates.
///   Source  own derivation; shares no code with contact: it reads voxels and the closed forms of the solids, no record and no shell point.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/tool/outline.h"
#include "core/voxel/bone_model.h"

namespace burrhole {

class SolidDepth {
 public:
  /// @param tool_text a tool file of regions.
  [[nodiscard]] static Result<SolidDepth> create(const std::string& tool_text, const BoneModel& bone);
  /// @returns [m] the largest depth of a point of bone's surface inside the tool; 0: none is inside. The points lie on lines along the axes
  /// of the grid, half a voxel apart.
  [[nodiscard]] double deepest(const Pose& bone_from_tool) const;
  /// Points of the tool's surface [m], tool frame, half a voxel apart.
  [[nodiscard]] const std::vector<Vec3>& tool_points() const noexcept { return tool_points_; }

 private:
  std::vector<Solid> solids_;
  std::vector<OutlinePiece> outline_;
  Bounds box_;
  std::vector<Vec3> tool_points_;
  std::vector<Vec3> points_;  // [m] bone frame, sorted along x
};

}  // namespace burrhole
