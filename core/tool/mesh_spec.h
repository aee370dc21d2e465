/// core/tool/mesh_spec.h: the table [mesh] of a tool file: a bit whose shape is a surface in a file of its own. Its only reader.
///   Frame  a file's vertex p lies at turn * (p * unit) + shift in the tool frame: origin at the tip, +z up the shaft.   Units  SI.
///   The shell does not turn with the spindle: a fluted bit is given by the envelope that its flutes sweep.
///   Errors go to Issues with file:line:column.   Source  own schema.
#pragma once

#include <optional>
#include <string>

#include "core/base/toml.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

struct MeshToolSpec {
  std::string name;  ///< tool file's name without folder and ending
  std::string title;
  std::string file;             ///< as written
  std::string path;             ///< the same, seen from the tool file's folder
  std::string file_place;       ///< of key `file`, for faults found later
  double unit = 0.0;            ///< [m] key unit_mm
  double erosion_factor = 0.0;  ///< [1/rev]
  double pitch = 0.0;           ///< [m] largest gap between shell points
  double cut_from = 0.0;        ///< [m] heights that cut, key cutting_range_mm
  double cut_to = 0.0;
  Mat3 turn{1.0};   ///< about x, then y, then z, key turn_deg
  Vec3 shift{0.0};  ///< [m]

  [[nodiscard]] bool cuts_at(double z) const noexcept { return erosion_factor > 0.0 && z >= cut_from && z <= cut_to; }
};

/// Whether the document has a table [mesh]; it then has no [[region]].
[[nodiscard]] bool has_tool_mesh(const TomlDocument& document);
/// @returns nothing when any issue was pushed.
[[nodiscard]] std::optional<MeshToolSpec> read_mesh_tool_spec(const TomlDocument& document, Issues& issues, KeyLog* log = nullptr);

/// The surface in the tool frame. @returns bad_input when it is no closed solid, larger than a tool can be, or does not stand on its tip.
[[nodiscard]] Result<SurfaceMesh> place_tool_mesh(const MeshToolSpec& spec, SurfaceMesh mesh);

}  // namespace burrhole
