/// core/drill/tip_support.h: which share of the thrust on a drill its inner tip carries, from the bone in front of it.
///   Frame  tool frame; poses are index from tool.   Units  SI.   Errors  none.   Thread  simulation; measure() does not allocate.
///   Source own derivation. A place of the face of the bit carries load where bone of density 0.5 is at the place itself, half a voxel ahead of
///          it, or within the engaged depth behind it. Faces of bone recede at e s / h times their overlap with the tool, and the pressure is
///          in proportion to the overlap (core/drill/cut_face.h). All faces of a bit that feeds recede at one speed, so the load of a place is
///          in proportion to its area x h / e, with h = max(hardness, 0.1) and e the erosion factor there:
///            share of the tip = sum over supported places of the tip of h / e  /  the same sum over all supported places.
///          Places are the lowest erosion point of each column along the axis, one per voxel.
///   Limits The share is that of a bit that feeds at a steady speed. It is used for one that starts to engage, and for one at rest, too. Load
///          on the flank of the bit counts as on its face. Contact forces are not used: contact presses single points, whose forces change from
///          tick to tick, and has no force that bone of a hardness could not carry.
#pragma once

#include <vector>

#include "core/drill/region_spin.h"
#include "core/tool/tool.h"
#include "core/voxel/voxmap.h"

namespace burrhole {

struct TipLoad {
  double supported = 0.0;  ///< [-] share of the area of the tip that has bone
  double share = 0.0;      ///< [-] of the thrust that the tip carries; 0 if nothing is supported
};

class TipSupport {
 public:
  /// @param spacing [m] > 0 of the places; the pitch of the erosion points where that is larger.
  TipSupport(const Tool& tool, const DrillRegions& regions, double spacing);

  /// @param engaged [m] depth. @param soft [-] places on bone of less hardness have no support. Bone outside the window counts as none.
  [[nodiscard]] TipLoad measure(const MasterWindow& window, const Affine& index_from_tool, double engaged, float soft) const noexcept;
  [[nodiscard]] std::size_t places() const noexcept { return places_.size(); }
  [[nodiscard]] double tip_area() const noexcept { return tip_area_; }  ///< [m^2] of the places of the tip

 private:
  struct Place {
    Vec3 at;           // [m]
    double per_e;      // [rev] 1 / e
    bool tip = false;  // of the inner drill
  };
  std::vector<Place> places_;
  double tip_area_ = 0.0;
  std::size_t tip_count_ = 0;
};

}  // namespace burrhole
