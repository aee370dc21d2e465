/// core/tool/mesh_spec.h: reads the table [mesh] of a tool file: a bit given by a closed triangle mesh in a separate file.
///   Frame  tool frame: origin at the tip, +z along the shaft. A vertex p of the file lies at turn * (unit * p) + shift.   Units  SI.
///   The contact points do not rotate with the spindle: a fluted bit must be given by the envelope that its flutes sweep.
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
  int teeth = 2;                ///< [-] cutting edges, key teeth
  std::string file;             ///< value of the key `file`
  std::string path;             ///< `file`, resolved against the folder of the tool file
  std::string file_place;       ///< file:line:column of the key `file`, for errors found later
  double unit = 0.0;            ///< [m] length of one unit of the file, key unit_mm
  double erosion_factor = 0.0;  ///< [1/rev] key erosion_factor
  double pitch = 0.0;           ///< [m] spacing of shell points, key pitch_mm; a surface point is within pitch / sqrt(2) of one
  double cut_from = 0.0;        ///< [m] lower end of the part that cuts, as height z above the tip, key cutting_range_mm
  double cut_to = 0.0;          ///< [m] upper end
  Mat3 turn{1.0};               ///< [-] rotation about the fixed axes x, then y, then z, key turn_deg
  Vec3 shift{0.0};              ///< [m] key shift_mm

  /// @param z [m] height above the tip.
  [[nodiscard]] bool cuts_at(double z) const noexcept { return erosion_factor > 0.0 && z >= cut_from && z <= cut_to; }
};

/// Whether the document has a table [mesh]. read_mesh_tool_spec() rejects a [[region]] beside it.
[[nodiscard]] bool has_tool_mesh(const TomlDocument& document);
/// @param log receives the keys that were read; may be null. @returns nothing if an issue was pushed.
[[nodiscard]] std::optional<MeshToolSpec> read_mesh_tool_spec(const TomlDocument& document, Issues& issues, KeyLog* log = nullptr);

/// Transforms `mesh` (positions in [m], already scaled by `unit`) into the tool frame. @returns bad_input if it is not a closed solid, if it extends beyond
/// 50 mm from the axis or 200 mm in height, if its lowest point is not at z = 0, or if the axis is outside its bounding box.
[[nodiscard]] Result<SurfaceMesh> place_tool_mesh(const MeshToolSpec& spec, SurfaceMesh mesh);

}  // namespace burrhole
