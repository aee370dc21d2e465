/// volumes/write/mesh_writer.h: writes a triangle mesh as binary STL, binary PLY or OBJ.
///   Frame  LPS; the header says so in the words that 3D Slicer reads ("SPACE=LPS").   Units  mm in the files, as floats.
///   Errors  bad_input with the path as place; unavailable: stopped.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "core/tool/surface_mesh.h"

namespace burrhole {

/// @param mesh positions in m. @param format "STL", "PLY" or "OBJ". @param stop see OutputFile::create(). @returns the size of the file
/// [bytes].
[[nodiscard]] Result<std::uint64_t> write_mesh(const std::string& path, const std::string& format, const SurfaceMesh& mesh,
                                               const std::atomic<bool>* stop = nullptr);

}  // namespace burrhole
