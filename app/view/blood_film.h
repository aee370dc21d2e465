/// app/view/blood_film.h: what lies on the pores of cut bone as one layer: a film of blood, or wax. The surface of the bone round them, cut off where
/// there is too little of it, along a ragged edge.
///   How much there is at a point: the pores of the voxels round it, weighted by a normal distribution of kFilmBlur voxels, over the same sum of a
///   level face that is all pores.
///   Frame  bone frame.   Units  m.   Errors  none.   Thread  any.   Source  own; shapes and colours are chosen by eye, the place is not.
#pragma once

#include <optional>
#include <span>

#include "app/view/added_mesh.h"
#include "core/blood/blood_site.h"

namespace burrhole {

struct FilmLook {
  double least = 0.3;                      ///< [-] of how much there is, at the edge of the layer
  double ragged = 0.2;                     ///< [-] by which that varies
  double lift = 0.3;                       ///< [voxels] over the surface of the bone
  double uneven = 0.0;                     ///< [m] height of its bumps
  std::optional<double> dry_below{};       ///< [m] height against `SiteBone::down`, below which there is none
  Vec3 thin_color{0.0}, thick_color{0.0};  ///< [-] 0..1
  std::uint8_t shine = 0;
};

inline constexpr double kFilmBlur = 0.8;  ///< [voxels]

/// Appends the layer. @param density [-] of the bone as it is, @param pores [-] of the voxels that are covered, 0: of others; both over `bone.box`.
void append_film(const SiteBone& bone, std::span<const float> density, std::span<const float> pores, const FilmLook& look, AddedMesh& out);

}  // namespace burrhole
