/// volumes/read/mesh_file.h: reads STL, OBJ and PLY (text or binary) as triangles. The formats are in volumes/read/mesh_formats.h.
///   Frame  of the file.   Units  SI after scaling.   Errors  bad_input, unavailable.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

/// @returns "STL", "OBJ" or "PLY" by the extension of the file, else by its first bytes (OBJ has no magic bytes); empty if the file is not
/// a supported mesh.
[[nodiscard]] std::string mesh_format(const std::string& path);

/// Reads a mesh in the format of mesh_format(). @param unit [m] length of one unit of the file. Parts of the file are joined, polygons are
/// triangulated, equal vertices are merged. Points, lines and triangle strips are errors.
/// @returns bad_input: unreadable, empty, not finite, or counts larger than the file. It does not check that the surface is closed.
[[nodiscard]] Result<SurfaceMesh> read_mesh(const std::string& path, double unit);

}  // namespace burrhole
