/// core/tool/mesh_spec.h: the table [mesh] of a tool file: a bit whose shape is a surface in a separate file. The only reader of the table.
///   Frame  vertex p of the file lies at turn * (p * unit) + shift in the tool frame: origin at the tip, +z up the shaft.   Units  SI.
///   The shell does not rotate with the spindle: a fluted bit must be given by the envelope that its flutes sweep.
///   Errors  pushed to Issues with file:line:column.   Source  own schema.
#pragma once

#include <optional>
#include <string>

#include "core/config/toml.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

struct MeshToolSpec {
  std::string name;  ///< name of the tool file without folder and extension
  std::string title;
  std::string file;             ///< as written
  std::string path;             ///< the path relative to the folder of the tool file
  std::string file_place;       ///< location of key `file`, for errors found later
  double unit = 0.0;            ///< [m] length of one unit of the file, key unit_mm
  double erosion_factor = 0.0;  ///< [1/rev] key erosion_factor
  double pitch = 0.0;           ///< [m] largest gap between shell points, key pitch_mm
  double cut_from = 0.0;        ///< [m] lowest height that cuts, key cutting_range_mm
  double cut_to = 0.0;          ///< [m] highest height that cuts
  Mat3 turn{1.0};               ///< [-] rotation about x, then y, then z, key turn_deg
  Vec3 shift{0.0};              ///< [m] key shift_mm

  [[nodiscard]] bool cuts_at(double z) const noexcept { return erosion_factor > 0.0 && z >= cut_from && z <= cut_to; }
};

/// Whether the document has a table [mesh]; it then has no [[region]].
[[nodiscard]] bool has_tool_mesh(const TomlDocument& document);
/// @returns nothing if an issue was pushed.
[[nodiscard]] std::optional<MeshToolSpec> read_mesh_tool_spec(const TomlDocument& document, Issues& issues, KeyLog* log = nullptr);

/// The surface in the tool frame. @returns bad_input if it is not a closed solid, larger than the limits, or its tip is not at the origin.
[[nodiscard]] Result<SurfaceMesh> place_tool_mesh(const MeshToolSpec& spec, SurfaceMesh mesh);

}  // namespace burrhole
