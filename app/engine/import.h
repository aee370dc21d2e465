/// app/engine/import.h: from a file or folder of any format to a bone model, with a report of what was found and assumed.
/// One path for `burrhole import`, every command that takes a scene, tests and benchmarks.
///   Units SI in structs, named units in texts.   Thread any.   Privacy: see volumes/read/scan.h; the report holds the path as the user
///   gave it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/voxel/bone_model.h"
#include "volumes/read/bone_from_scan.h"
#include "volumes/read/scan.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {

struct ImportRequest {
  std::string path;
  ReadOptions read;
  BoneOptions bone;
};

struct ImportReport {
  std::string source;
  ScanReport scan;     ///< format, series, what was assumed and skipped
  Vec3i dims{0};       ///< as scanned
  GridShape grid;      ///< as scanned
  BoneFromScan facts;  ///< range of values, offset, share and box of bone; its model is not kept here
  Vec3i bone_dims{0};
  bool resampled = false;
  double bone_share = 0.0;          ///< of the voxels, occupancy >= 0.5
  Vec3 bone_lo{0.0}, bone_hi{0.0};  ///< [m] box round the bone voxels' centres, bone frame
  double bone_spacing = 0.0;        ///< [m] edge of the cube with a voxel's volume
  std::uint64_t bone_voxels = 0, bytes = 0;
};

struct ImportedBone {
  std::shared_ptr<const BoneModel> bone;
  ImportReport report;
};

/// Reads and classifies. A bone model of this program is taken as it is; another program's .vdb needs its unit. Options that a format has
/// no use for are refused. @param say gets one line on the memory that the bone needs, before that is taken; may be empty. @returns
/// bad_input with the path as place.
[[nodiscard]] Result<ImportedBone> import_bone(const ImportRequest& request, const std::function<void(const std::string&)>& say);

/// {schema, source, format, series[], dims, spacing_mm, direction, shear_deg, oblique_deg, values{..}, bone{..}, assumed[], skipped[],
/// kept{}}
[[nodiscard]] std::string import_json(const ImportReport& report);
/// The same for a terminal, a line a fact.
[[nodiscard]] std::string import_text(const ImportReport& report);

}  // namespace burrhole
