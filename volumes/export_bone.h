/// volumes/export_bone.h: writes a bone, drilled or as loaded, for other programs: NRRD, NIfTI, OpenVDB, and its surface as STL, PLY or OBJ.
///   Frame  patient LPS, as the bone frame; NIfTI is RAS and its affine says so.   Units  mm in all files.
///   Errors  bad_input: the path, a field that the format does not hold, no bone; unavailable: errors of a paged bone.
///   Files   appear under their name only when they are whole.   Thread  any; the bone must not change meanwhile.
///   Memory  a slab of 8 slices for NRRD and NIfTI, the sparse grid of the density for .vdb and meshes, and the mesh.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/voxel/voxmap.h"

namespace burrhole {

/// density: share of bone in the voxel, 0..1, its 0.5 level is the surface. hardness: relative mineral density, 0..1. remaining: share that
/// tools have left, 1 as loaded. labels: VoxelLabel, 8 bits; a voxel of bone that was drilled away has none.
enum class ExportField : std::uint8_t { density, hardness, remaining, labels };
/// Names of the fields, in the order of ExportField.
[[nodiscard]] const std::vector<std::string>& export_field_names();

struct ExportRequest {
  std::string path;                           ///< file to write; its ending chooses the format
  std::optional<ExportField> field = {};      ///< of a volume; absent: the density. A .vdb and a mesh have no choice
  bool undrilled = false;                     ///< bone as loaded, without what tools have removed
  bool crop = false;                          ///< only the box round the bone, with a margin; not for .vdb and meshes
  bool ball = false;                          ///< a mesh by ball pivoting (write/ball_surface.h), not by dual contouring
  std::function<void(double)> progress = {};  ///< receives the share done, 0..1; may be empty
  std::function<void()> begin = {};  ///< called before the temporary file is made: until then there is nothing to remove; may be empty
  /// Once true, the export ends with `unavailable`, and what was under the name stays; a signal handler may set it.
  const std::atomic<bool>* stop = nullptr;
};

struct ExportReport {
  std::string format;         ///< "NRRD", "NIfTI-1", "OpenVDB", "STL", ...
  Vec3i dims{0};              ///< [voxels] of a volume; 0 for a mesh
  std::size_t triangles = 0;  ///< of a mesh
  std::uint64_t bytes = 0;    ///< size of the file
};

/// @returns the format by the ending of the path: "NRRD", "NIfTI-1", "OpenVDB", "STL", "PLY" or "OBJ"; bad_input, which lists the endings.
[[nodiscard]] Result<std::string> export_format(const std::string& path);
/// @returns the error of a request that does not depend on the bone.
[[nodiscard]] Status check_request(const ExportRequest& request);
[[nodiscard]] Result<ExportReport> export_bone(const Voxmap& bone, const ExportRequest& request);

/// Reads a field of the present bone, or of the bone as loaded. `out` holds the box, i fastest; the box may reach outside the grid.
void read_field(const Voxmap& bone, ExportField field, bool undrilled, const VoxelBox& box, std::span<float> out);

}  // namespace burrhole
