/// volumes/phantom/phantom_spec.h: parameters of a generated bone; keys as in the [volume] table of a scene.
///   Frame   bone frame: the drilling site is the origin, its outward normal +z; the edge of the wedge lies there. A head has that of
///   head_shape.h.
///   Units   SI in the struct; keys name their unit. Converted in phantom_spec.cpp only.   Errors  out_of_range with the key in the
///   message.
///   Source  thicknesses: parietal mean 7.04 mm (n = 100), table medians 2.4 and 1.7 mm [Zwirner21]; all others are assumed (A).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/units.h"
#include "core/config/toml.h"

namespace burrhole {

enum class PhantomKind : std::uint8_t {
  skull_patch,  ///< spherical shell of two tables and porous diploe, over dura and brain
  block,        ///< box; the middle of its top face is the origin
  plate,        ///< slab between two parallel planes, oblique if `plate_normal` is; extends to the ends of the grid
  sphere,       ///< ball; its top is the origin
  wedge,        ///< two half-spaces that meet in an edge along y, symmetric about z, edge up
  pit,          ///< level plate with a cylindrical blind hole on the z axis
  capsule,      ///< cylinder along x with round ends, as a cucumber; its middle is below the origin, which it touches
  head          ///< whole skull with the layers of skull_patch, of which a region round the approach is felt; head_bone.h
};

/// [voxels] A voxel of a dense phantom takes 13 bytes; 300 M voxels take 3.9 GB.
inline constexpr double kMaxPhantomVoxels = 300e6;
/// [voxels] Smallest thickness of the bone. The two ramps of occupancy may use up to 2 sqrt(3) = 3.46 voxels of it.
inline constexpr double kMinVoxelsThrough = 4.0;

/// Parameters. Each line names the kinds that use it; other kinds ignore it.
struct PhantomSpec {
  PhantomKind kind = PhantomKind::skull_patch;

  // Grid of every kind but head: x and y centred on the z axis, z from above - extent.z to above; rounded up to whole voxels.
  double pitch = 0.25 * kMillimetre;                                        ///< [m] in (0, 5]         key spacing_mm
  Vec3 extent{30.0 * kMillimetre, 30.0 * kMillimetre, 16.0 * kMillimetre};  ///< [m] each in (0, 500]  key extent_mm
  double above = 2.0 * kMillimetre;                                         ///< [m] in [0, 100]       key above_mm
  std::int64_t seed = 1;                                                    ///< [-] >= 0                  key seed (pores and noise)
  double noise = 0.0;  ///< [-] a in [0, 0.5]; densities are multiplied by (1-a) + a u, u uniform in [-1, 1): mean 1-a       key noise

  double thickness = 7.04 * kMillimetre;  ///< [m] in (0, 100]  key thickness_mm (skull_patch: tables and diploe; plate; pit)
  double hardness = 0.8;                  ///< [-] in [0, 1]        key hardness (all except skull_patch)

  // skull_patch
  double curvature = 80.0 * kMillimetre;   ///< [m] radius of the outer surface, in (0, 1000]   key curvature_mm
  double outer_table = 2.4 * kMillimetre;  ///< [m] in [0, 100]                                 key outer_table_mm
  double inner_table = 1.7 * kMillimetre;  ///< [m] in [0, 100]                                 key inner_table_mm
  double dura = 0.5 * kMillimetre;         ///< [m] in [0, 10]                                  key dura_mm
  double rim_radius = 0.0;                 ///< [m] bone, dura and brain end at this distance from the z axis; 0: none   key rim_mm
  double pore_size = 1.2 * kMillimetre;    ///< [m] mean width of a pore, in (0, 20]            key pore_mm
  double porosity = 0.4;                   ///< [-] share of pores in the diploe, in [0, 1]           key porosity
  double table_hardness = 0.9;             ///< [-] in [0, 1]                                       key table_hardness
  double trabecula_hardness = 0.45;        ///< [-] in [0, 1]                                       key trabecula_hardness
  double pore_hardness = 0.12;             ///< [-] in [0, 1]                                       key pore_hardness

  Vec3 block_size{20.0 * kMillimetre, 20.0 * kMillimetre, 8.0 * kMillimetre};  ///< [m] each in (0, 500]      key block_mm
  Vec3 plate_normal{0.0, 0.0, 1.0};  ///< [-] any length, z > 0; outward normal of the outer face            key plate_normal
  double sphere_radius =
      6.0 * kMillimetre;  ///< [m] in (0, 250]                                             key radius_mm (sphere, capsule)
  double capsule_length = 30.0 * kMillimetre;  ///< [m] of the whole, ends included, in (0, 500]              key length_mm
  double wedge_angle = 90.0 * kDegree;         ///< [rad] between the faces inside the bone, in [20, 170] degrees  key wedge_deg
  double hole_radius = 3.0 * kMillimetre;      ///< [m] in (0, 100]                                             key hole_radius_mm
  double hole_depth = 4.0 * kMillimetre;       ///< [m] in (0, 100], less than thickness                        key hole_depth_mm

  // head
  Vec3 region{40.0 * kMillimetre, 40.0 * kMillimetre,
              28.0 * kMillimetre};                 ///< [m] each in (0, 500], along the approach's axes  key region_mm
  double surroundings = 1.5 * kMillimetre;         ///< [m] edge of the voxels outside the region, in (0, 5]          key surroundings_mm
  Vec3 head_entry{0.0, 0.0, 112.0 * kMillimetre};  ///< [m] of the approach, where the region lies
  Vec3 head_axis{0.0, 0.0, -1.0};                  ///< [-] of the approach, length 1

  friend bool operator==(const PhantomSpec&, const PhantomSpec&) = default;
};

/// @returns the word after "phantom:" in the `source` of a scene.
[[nodiscard]] std::string_view phantom_name(PhantomKind kind) noexcept;
[[nodiscard]] std::optional<PhantomKind> find_phantom(std::string_view name) noexcept;
[[nodiscard]] std::vector<std::string> phantom_names();

/// @returns the number of voxels per axis. @pre the keys of the grid are valid, see validate().
[[nodiscard]] Vec3i phantom_dims(const PhantomSpec& spec) noexcept;
/// @returns bone_from_index: voxel centres, equal pitch on the axes. @pre as phantom_dims().
[[nodiscard]] Affine phantom_bone_from_index(const PhantomSpec& spec) noexcept;

/// @returns every error of the parameters that this kind uses (range, consistency, size of the grid); messages name the keys of the scene.
[[nodiscard]] Issues validate(const PhantomSpec& spec);

/// Reads the keys of this kind from [volume]; the caller reads `source`. Errors, including those of validate(), are pushed at the location
/// of the key, so the caller checks its Issues only. An unknown kind is an error at `source` that names the nearest kind.
[[nodiscard]] PhantomSpec read_phantom(TableReader& volume, std::string_view kind);

}  // namespace burrhole
