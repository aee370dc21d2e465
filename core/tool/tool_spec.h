/// core/tool/tool_spec.h: the contents of a tool file as numbers, before points are made. The only reader of the tool schema.
///   Frame  tool frame: origin at the tip on the axis, +z up the shaft.   Units  SI here; keys of the file name their unit.
///   Errors pushed to Issues with file:line:column.   Source  parameters of [AcostaLiu07] sections 2 and 3; own schema.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/config/toml.h"
#include "core/tool/outline.h"
#include "core/tool/shape.h"

namespace burrhole {

/// Erosion factor over a region: e(p) = base * radial(r) * f. radial is `axis` up to r = core and linear from there to `rim` at R, the
/// largest radius of the region. f is the factor of the nearest face within `skin` of the tool's surface, and `interior` below it.
/// The core makes the factor on the axis one that bone can feel: the voxels nearest to the axis lie up to 0.71 voxel edge from it, and a
/// plunging bit feeds at its least factor. Voxels of up to 0.35 mm have one within the default core.
struct ErosionRule {
  double base = 0.0;                         ///< [1/rev] key erosion_factor; 0: the region is passive
  double axis = 1.0;                         ///< [-] from the axis to `core`, key axis_factor
  double core = 0.25e-3;                     ///< [m] radius, key axis_core_mm
  double rim = 1.0;                          ///< [-] at the region's largest radius R, key rim_factor
  double bottom = 1.0;                       ///< [-] key bottom_factor
  double side = 1.0;                         ///< [-] key side_factor
  double top = 1.0;                          ///< [-] key top_factor
  double inner = 1.0;                        ///< [-] wall of a bore, key inner_factor
  std::array<double, 4> flanks{1, 1, 1, 1};  ///< [-] of a box, -x +x -y +y; keys minus_x_factor ... plus_y_factor, default side_factor
  double interior = 1.0;                     ///< [-] key interior_factor
  double skin = 0.0;                         ///< [m] depth of the skin, key skin_mm

  [[nodiscard]] double of_face(Face face) const noexcept;
  /// @param r [m] distance from the axis. @param largest [m] radius of the region. @returns radial(r).
  [[nodiscard]] double radial(double r, double largest) const noexcept;
  /// @returns whether the factor depends on the nearest face; false if all faces have the interior's factor.
  [[nodiscard]] bool needs_depth() const noexcept;
};

/// Sampling of a region's surface: by counts as in [AcostaLiu07] sec. 2, or by the largest permitted gap.
struct ShellSampling {
  int stacks = 0;      ///< rows along the side; 0: by pitch
  int slices = 0;      ///< points on the widest ring
  double voxel = 0.0;  ///< [m] with stacks: largest gap between rings of flat faces; 0: the gap along the rim
  double pitch = 0.0;  ///< [m] without stacks: largest gap along rings and between them
};

struct RegionSpec {
  std::string name;
  Solid solid;
  ErosionRule erosion;
  ShellSampling shell;
};

struct ToolSpec {
  std::string name;  ///< file name without folder and extension
  std::string title;
  int teeth = 0;                      ///< [-] cutting edges, key teeth; 0: by the shape (find_cutting_edges)
  std::vector<RegionSpec> regions;    ///< at least one; lowest z_low is 0
  std::vector<OutlinePiece> outline;  ///< of the union of regions

  [[nodiscard]] std::vector<Solid> solids() const;
  /// @returns the region that owns the material at p: the first listed that contains it.
  [[nodiscard]] std::optional<std::size_t> region_at(const Vec3& p) const noexcept;
};

/// Reads the key `teeth`, of both kinds of tool. @param fallback [-] if it is absent. @param more of the key's description.
[[nodiscard]] int read_teeth(TableReader& root, int fallback, const char* more);

/// @returns nothing if an issue was pushed. @param log if not null, receives the record of all requested keys.
[[nodiscard]] std::optional<ToolSpec> read_tool_spec(const TomlDocument& document, Issues& issues, KeyLog* log = nullptr);

}  // namespace burrhole
