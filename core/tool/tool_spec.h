/// core/tool/tool_spec.h: a tool file as plain numbers, before any point is made. The only reader of the tool schema.
///   Frame  tool frame: origin at the tip on the axis, +z up the shaft.   Units  SI here; keys in the file carry theirs.
///   Errors all faults go to Issues with file:line:column.   Source  parameters of [AcostaLiu07] sections 2 and 3; schema is our own.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/toml.h"
#include "core/tool/outline.h"
#include "core/tool/shape.h"

namespace burrhole {

/// Erosion factor over a region: e(p) = base * (axis + (rim - axis) r / R) * f, R its largest radius; f is the factor of the nearest
/// face within `skin` of the tool's surface, and `interior` below it.
struct ErosionRule {
  double base = 0.0;    ///< [1/rev] key erosion_factor; 0: the region is passive
  double axis = 1.0;    ///< [-] at r = 0, key axis_factor
  double rim = 1.0;     ///< [-] at the region's largest radius R, key rim_factor
  double bottom = 1.0;  ///< [-] keys bottom_factor, side_factor, top_factor
  double side = 1.0;
  double top = 1.0;
  double inner = 1.0;                        ///< [-] wall of a bore, key inner_factor
  std::array<double, 4> flanks{1, 1, 1, 1};  ///< [-] of a box, -x +x -y +y; keys minus_x_factor ... plus_y_factor, by default side_factor
  double interior = 1.0;                     ///< [-] key interior_factor
  double skin = 0.0;                         ///< [m] key skin_mm

  [[nodiscard]] double of_face(Face face) const noexcept;
  /// Whether the factor depends on which face is near: not when all faces have the interior's.
  [[nodiscard]] bool needs_depth() const noexcept;
};

/// How a region's surface is sampled: by counts as in [AcostaLiu07] sec. 2, or by the largest gap allowed.
struct ShellSampling {
  int stacks = 0;      ///< rows along the side; 0: by pitch
  int slices = 0;      ///< points round the widest ring
  double voxel = 0.0;  ///< [m] with stacks: largest gap between rings of flat faces; 0: the gap round the rim
  double pitch = 0.0;  ///< [m] without stacks: largest gap along rings and between them
};

struct RegionSpec {
  std::string name;
  Solid solid;
  ErosionRule erosion;
  ShellSampling shell;
};

struct ToolSpec {
  std::string name;  ///< file name without folder and ending
  std::string title;
  std::vector<RegionSpec> regions;    ///< at least one; lowest z_low is 0
  std::vector<OutlinePiece> outline;  ///< of the union of regions

  [[nodiscard]] std::vector<Solid> solids() const;
  /// Region that owns the material at p: the first listed that contains it.
  [[nodiscard]] std::optional<std::size_t> region_at(const Vec3& p) const noexcept;
};

/// @returns nothing when any issue was pushed. `log`: also tells which keys were asked for.
[[nodiscard]] std::optional<ToolSpec> read_tool_spec(const TomlDocument& document, Issues& issues, KeyLog* log = nullptr);

}  // namespace burrhole
