/// volumes/import_bone.h: makes a bone model from a file or folder of any supported format, with a report of what was found and assumed.
///   `burrhole import`, all commands that read a scene, tests and benchmarks use this one path.
///   Frame  bone frame (LPS).   Units  SI in structs, named units in texts.   Errors  bad_input with the path as place; unavailable.
///   Thread any.   Privacy  see volumes/read/scan.h; the report contains the path as the user gave it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/measure/enclosure.h"
#include "core/voxel/bone_model.h"
#include "volumes/read/bone_from_scan.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {

/// Where bone will be drilled.
struct BoneSite {
  Vec3 entry{0.0};  ///< [m] near the outer surface
  Vec3 axis{0.0};   ///< [-] unit vector into bone
};

struct ImportRequest {
  std::string path;
  ReadOptions read;
  BoneOptions bone;
  std::optional<BoneSite> site{};  ///< ImportReport::enclosure is measured there; absent: it is not
  /// Called with the grid of the bone and the bytes of the scan, with those of the slabs in which bone is made, after the headers and before
  /// values are read (of a mesh and of a bone model, after the file is read), and again before bone is made, when its share is known. @returns
  /// where the bone is to be kept, of which the last answer counts; an error ends the import. May be empty.
  std::function<Result<BoneStorage>(const BoneGrid& grid, std::uint64_t scan_bytes)> accept = {};
};

struct ImportReport {
  std::string source;
  ScanReport scan;     ///< format, series, assumptions, skipped files
  Vec3i dims{0};       ///< [voxels] of the scan
  GridShape grid;      ///< of the scan
  BoneFromScan facts;  ///< range of values, offset, share and box of bone; without the model
  Vec3i bone_dims{0};  ///< [voxels] of the bone model
  bool resampled = false;
  double bone_share = 0.0;          ///< [-] share of the voxels with occupancy >= 0.5
  Vec3 bone_lo{0.0}, bone_hi{0.0};  ///< [m] box around the centres of bone voxels, bone frame
  double bone_spacing = 0.0;        ///< [m] edge of the cube with the volume of a voxel
  Vec3 bone_edges{0.0};             ///< [m] distances of voxel centres along i, j, k
  std::uint64_t bone_voxels = 0, bytes = 0;
  /// The largest connected part of the bone (core/measure/largest_part.h), by find_largest_part().
  struct Part {
    Vec3 lo{0.0}, hi{0.0};  ///< [m] box around the centres of its voxels, bone frame
    double share = 0.0;     ///< [-] of the bone voxels as loaded
  };
  std::optional<Part> largest{};
  std::optional<Enclosure> enclosure{};  ///< of the whole scan, at the site; of a bone model, of its bone as loaded
};

/// @returns whether the file says where left, back and up are; otherwise an assumption of the report says that LPS was taken.
[[nodiscard]] bool knows_directions(const ImportReport& report);

struct ImportedBone {
  std::shared_ptr<const BoneModel> bone;
  ImportReport report;
};

/// Reads and classifies. Of a folder without DICOM that holds one volume, that volume is read (readable_path.h). A bone model of this program
/// is used unchanged; a .vdb of another program needs a unit. Options that the format does not use are errors. @param say is called with one
/// line on the memory that the bone needs, before it is allocated; may be empty. @returns bad_input with the path as place.
[[nodiscard]] Result<ImportedBone> import_bone(const ImportRequest& request, const std::function<void(const std::string&)>& say);

/// Finds the largest connected part of the bone for the report; nothing without bone. A scan may hold others, a head rest for example. Takes a
/// few seconds for a head at 0.25 mm.
void find_largest_part(const BoneModel& bone, ImportReport& report);

/// {schema, source, format, series[], dims, spacing_mm, direction, shear_deg, oblique_deg, values{..}, bone{..}, assumed[], skipped[],
/// kept{}}
[[nodiscard]] std::string import_json(const ImportReport& report);
/// The same as text for a terminal, one fact per line.
[[nodiscard]] std::string import_text(const ImportReport& report);

}  // namespace burrhole
