/// volumes/phantom/skull_layers.h: what lies at which depth of a skull patch: outer table, diploe, inner table, dura, brain.
///   Frame  bone frame.   Units  SI; depth is measured from the outer surface along the radius, positive into the skull.
#pragma once

#include "core/voxel/bone_model.h"
#include "volumes/phantom/phantom_spec.h"
#include "volumes/phantom/pore_field.h"
#include "volumes/phantom/shapes.h"

namespace burrhole {

/// A point as seen from the patch.
struct SkullSite {
  double depth = 0.0;       ///< [m] below the outer surface
  double past_rim = 0.0;    ///< [m] beyond the rim; -infinity where there is none
  Vec3 up{0.0, 0.0, 1.0};   ///< radial, outward
  Vec3 out{1.0, 0.0, 0.0};  ///< away from the z axis
};
[[nodiscard]] SkullSite skull_site(const PhantomSpec& spec, const Vec3& p_bone) noexcept;

[[nodiscard]] VoxelLabel skull_label(const PhantomSpec& spec, const SkullSite& site) noexcept;

/// @returns the soft body under the bone (dura and brain as one solid): its top is the bone's inner surface. Exact on the surface, a lower
/// bound of the distance outside its edge at the rim.
[[nodiscard]] SurfaceDistance soft_surface(const PhantomSpec& spec, const SkullSite& site) noexcept;

/// Hardness of the bone by depth, goes on unchanged outside it; layers blend over one voxel about their border.
class SkullHardness {
 public:
  /// @pre validate(spec) found nothing. Calibrates the pores to the porosity asked for.
  explicit SkullHardness(const PhantomSpec& spec);
  [[nodiscard]] double at(const Vec3& p_bone, double depth) const noexcept;
  [[nodiscard]] const PoreField& pores() const noexcept { return pores_; }

 private:
  PhantomSpec spec_;
  PoreField pores_;
};

}  // namespace burrhole
