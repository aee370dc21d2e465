/// volumes/read/mesh_formats.h: parsers of the bytes of STL, OBJ and PLY files. Use volumes/read/mesh_file.h to read a file.
///   Reason  assimp 5.2 as packaged by Debian aborts on failed assertions and loops endlessly on files with a few damaged bytes
///           (triangulation; PLY data without end_header). A program that opens a file of a user must not.
///   Frame   of the file.   Units  of the file, not checked for finite values.   Errors  bad_input without a place, "line 17: ..." in text.
///   Memory  a few times the given bytes, for any counts in the file.   Source  the public descriptions of the formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

[[nodiscard]] Result<SurfaceMesh> parse_stl(std::string_view bytes);
[[nodiscard]] Result<SurfaceMesh> parse_obj(std::string_view bytes);
[[nodiscard]] Result<SurfaceMesh> parse_ply(std::string_view bytes);

inline constexpr std::size_t kMaxPolygonCorners = 256;
/// Limit of the triangulation steps of all polygons of one file: some seconds. Faces of four corners take up to 20 steps each, convex faces
/// of 256 corners 33 000, self-intersecting faces up to a third of the cube of their corners.
inline constexpr std::uint64_t kMaxPolygonSteps = 1'000'000'000;

/// Appends corners.size() - 2 triangles over the same corners with the same orientation, so that a closed surface stays closed for any
/// shape of the polygon. A planar simple polygon is covered exactly, concave or not; for other polygons some triangles may overlap. Ear
/// clipping, own derivation. @pre 3 <= corners.size() <= kMaxPolygonCorners, corners index mesh.positions.
/// @param steps steps of the file so far, one per corner tested; this polygon's steps are added.
/// @returns the error, empty if none: the polygons of the file take more than kMaxPolygonSteps. In that case only a part is appended.
[[nodiscard]] std::string append_polygon(std::span<const std::uint32_t> corners, SurfaceMesh& mesh, std::uint64_t& steps);

}  // namespace burrhole
