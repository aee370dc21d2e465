/// volumes/read/mesh_file.h: STL, OBJ and PLY (text or binary) to triangles; the formats are read in volumes/read/mesh_formats.h.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

/// @returns "STL", "OBJ" or "PLY" by the file's ending, else by its first bytes (OBJ has nothing to tell it by); empty: no mesh that is
/// read.
[[nodiscard]] std::string mesh_format(const std::string& path);

/// The format is mesh_format's. @param unit [m] length of one unit of the file. All parts of the file joined; polygons are cut into
/// triangles, vertices welded. Points, lines and triangle strips are refused, not dropped.
/// @returns bad_input: unreadable, empty, not finite, or larger than its file can hold. Does not ask whether the surface is closed.
[[nodiscard]] Result<SurfaceMesh> read_mesh(const std::string& path, double unit);

}  // namespace burrhole
