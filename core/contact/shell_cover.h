/// core/contact/shell_cover.h: a few spheres that hold all points of a shell, for bounds of the tool's distance from bone.
///   Frame  tool frame.   Units  SI.   Errors none.   Thread  built once, then read by any thread.
#pragma once

#include <vector>

#include "core/base/assert.h"
#include "core/contact/contact_view.h"
#include "core/tool/tool.h"
#include "core/voxel/coarse_distance.h"

namespace burrhole {

class ShellCover {
 public:
  ShellCover() = default;
  explicit ShellCover(const std::vector<Vec3>& points);

  /// @returns a lower bound [m] of the distance from any point of the shell to bone as loaded; negative or 0: bone may be near.
  [[nodiscard]] double clearance(const CoarseDistance& bone, const Affine& index_from_tool) const noexcept BH_REALTIME;
  /// @returns whether some point may be near bone outside the known part of `view`.
  [[nodiscard]] bool reaches_unread(const ContactView& view, const CoarseDistance& bone,
                                    const Pose& world_from_tool) const noexcept BH_REALTIME;

 private:
  struct Sphere {
    Vec3 centre{0.0};     // [m]
    double radius = 0.0;  // [m]
  };
  std::vector<Sphere> spheres_;
};

}  // namespace burrhole
