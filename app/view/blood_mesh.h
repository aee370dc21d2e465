/// app/view/blood_mesh.h: blood in and about a hole as triangles: the surface of the pool, a film, drops and runs on the cut pores, wax.
///   The pool is level in its middle. It rises where it wets a wall, dips at a brim, and goes a little into the bone, which hides that part. It is
///   left out where the blood under it is too thin to hide the floor. A film lies on the pores of cut bone (blood_film.h), the wider the wetter. Some
///   pores carry a drop; from some, blood runs in a band down to the pool, or to where the surface is level. Waxed pores have a pale layer.
///   Frame  bone frame.   Units  m.   Errors  none.   Thread  any.   Source  own; colours and shapes are chosen by eye, volumes are not.
#pragma once

#include <cstdint>
#include <vector>

#include "app/view/added_mesh.h"
#include "core/blood/blood_site.h"

namespace burrhole {

/// What a picture shows, copied from a BloodSite and a BloodPool. Vectors are in the order of SiteBone.
struct BloodPicture {
  std::vector<std::uint16_t> removed;  ///< share of the voxel, of BloodSite::kWhole
  std::vector<float> pore_area;        ///< [m^2] of a source; 0: none
  std::vector<std::uint8_t> waxed;     ///< 1: wax is in its pores
  double level = 0.0;                  ///< [m] height of the pool
  double blood = 0.0;                  ///< [-] share of blood in the pool, 0..1; 0: there is no pool
  double wetness = 0.0;                ///< [-] 0..1 how much blood is on the wall: the film grows with it, runs need kRunWetness
  double hide = 3e-4;                  ///< [m] depth of blood that hides the floor
};

inline constexpr double kRunWetness = 0.5;  ///< [-]

/// Appends the triangles. @param bone of the site that was copied.
void append_blood(const SiteBone& bone, const BloodPicture& picture, AddedMesh& out);

}  // namespace burrhole
