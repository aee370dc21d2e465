/// volumes/read/mesh_formats.h: the bytes of STL, OBJ and PLY files to a surface; volumes/read/mesh_file.h is the way in.
///   Our own readers: assimp 5.2 as Debian builds it aborts on a failed assertion and loops without end on files with a few damaged bytes
///   (its polygon cutting; its PLY reader when end_header runs into the data), and a program that opens a user's file must not.
///   Units   numbers as in the file, not checked for being finite.   Errors  bad_input without a place, "line 17: ..." in text.
///   Memory  a few times the bytes given, whatever counts they claim.   Source  the formats' public descriptions.
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
/// Most steps that all polygons of one file may take to be cut: some seconds. Four-cornered faces take up to 20 each, convex ones of 256
/// corners 33 000, crossed ones up to a third of the cube of their corners.
inline constexpr std::uint64_t kMaxPolygonSteps = 1'000'000'000;

/// Appends corners.size() - 2 triangles over the same corners, in the same sense, so that a closed surface stays closed whatever the
/// polygon's shape. A plane polygon without crossings is covered exactly, concave or not; of others some triangles may overlap.
/// Ear clipping, own derivation. @pre 3 <= corners.size() <= kMaxPolygonCorners, corners index mesh.positions.
/// @param steps taken for the file so far, one for each corner looked at; grows by this polygon's.
/// @returns what is wrong, empty if nothing: the file's polygons take more than kMaxPolygonSteps. Then only a part is appended.
[[nodiscard]] std::string append_polygon(std::span<const std::uint32_t> corners, SurfaceMesh& mesh, std::uint64_t& steps);

}  // namespace burrhole
