/// volumes/phantom/skull_layers.h: layers of a skull patch by depth: outer table, diploe, inner table, dura, brain.
///   Frame  bone frame.   Units  SI; depth is measured from the outer surface along the radius, positive into the skull.   Errors  none.
#pragma once

#include "core/voxel/bone_model.h"
#include "volumes/phantom/phantom_spec.h"
#include "volumes/phantom/pore_field.h"
#include "volumes/phantom/shapes.h"

namespace burrhole {

/// Position of a point relative to the patch.
struct SkullSite {
  double depth = 0.0;       ///< [m] below the outer surface
  double past_rim = 0.0;    ///< [m] beyond the rim; -infinity without a rim
  Vec3 up{0.0, 0.0, 1.0};   ///< [-] radial, outward, length 1
  Vec3 out{1.0, 0.0, 0.0};  ///< [-] away from the z axis, length 1
};
[[nodiscard]] SkullSite skull_site(const PhantomSpec& spec, const Vec3& p_bone) noexcept;

[[nodiscard]] VoxelLabel skull_label(const PhantomSpec& spec, const SkullSite& site) noexcept;

/// @returns the soft body under the bone (dura and brain as one solid); its top is the inner surface of the bone. Its distance is exact on
/// the surface and a lower bound outside its edge at the rim.
[[nodiscard]] SurfaceDistance soft_surface(const PhantomSpec& spec, const SkullSite& site) noexcept;

/// Hardness of the bone by depth, constant outside the bone; adjacent layers are blended over one voxel.
class SkullHardness {
 public:
  /// Calibrates the pores to the requested porosity. @pre validate(spec) found no error.
  explicit SkullHardness(const PhantomSpec& spec);
  [[nodiscard]] double at(const Vec3& p_bone, double depth) const noexcept;
  [[nodiscard]] const PoreField& pores() const noexcept { return pores_; }

 private:
  PhantomSpec spec_;
  PoreField pores_;
};

}  // namespace burrhole
