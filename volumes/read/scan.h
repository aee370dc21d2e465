/// volumes/read/scan.h: a volume as read from a file, before anything is called bone.
///   Frame   bone frame = patient LPS as DICOM and ITK; bone_from_index is the full affine, shear and gantry tilt included.
///   Units   SI in structs; values in Hounsfield units where `quantity` says so.     Thread  any; readers share no state.
///   Privacy no field of a patient or a study enters these structs unless ReadOptions::keep names it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

/// Most voxels a reader allocates: 2048 slices of 1024 x 1024.
inline constexpr double kMaxScanVoxels = 2048.0 * 1024.0 * 1024.0;

/// What a voxel's number means. `unknown`: the file does not say (NIfTI, NRRD, MetaImage, raw); told apart later by its values.
enum class Quantity { hounsfield, unknown, other, occupancy };

struct Scan {
  Vec3i dims{0};
  Affine bone_from_index;  ///< [m]
  Quantity quantity = Quantity::unknown;
  std::vector<float> values;  ///< dims.x*dims.y*dims.z, i fastest; slope and intercept applied; occupancy 0..1 from meshes
};

/// One series of a folder, as listed in the report. No UID, no description: both can identify a patient.
struct SeriesLine {
  std::string name;  ///< series number as text; "3b" for a second series of number 3: what ReadOptions::series takes
  std::string modality;
  Vec3i dims{0};          ///< z: slices
  Vec3 spacing{0.0};      ///< [m]
  std::string direction;  ///< "axial", "coronal", "sagittal"
  bool taken = false;
  std::string fault;  ///< why it cannot be a volume, empty when it can
};

struct Skipped {
  std::string reason;  ///< "not DICOM", "localizer", "screen capture", ...
  std::size_t count = 0;
};

struct KeptField {
  std::string name, value;
};

/// What was found and assumed; everything here is printed to the user.
struct ScanReport {
  std::string format;  ///< "DICOM", "NIfTI-1", "NRRD", ...
  std::vector<SeriesLine> series;
  std::vector<std::string> assumed;  ///< one line each, e.g. "one slice: thickness 5 mm from SliceThickness"
  std::vector<Skipped> skipped;
  std::vector<KeptField> kept;  ///< fields asked for by ReadOptions::keep
};

struct ReadOptions {
  std::string series;                    ///< of a DICOM folder, by SeriesLine::name; grid name of a foreign .vdb; empty: the largest
  std::optional<double> unit;            ///< [m] one unit of length of a mesh or a foreign .vdb, whose files carry none
  std::optional<double> pitch;           ///< [m] voxel edge a mesh is sampled at; absent: longest side / 256, told as assumed
  std::vector<std::string> keep;         ///< DICOM keywords (PatientID, ...) to copy into the report
  std::optional<double> memory;          ///< [bytes] most that the voxels may take; absent: what the machine has available
  std::function<void(double)> progress;  ///< called now and then with the share done, 0..1; may be empty
};

struct ReadScan {
  Scan scan;
  ScanReport report;
};

/// Any supported input: a folder or file of DICOM, .nii(.gz) .hdr .nrrd .nhdr .mha .mhd, a raw volume's .toml, .stl .obj .ply, a foreign
/// .vdb. Chosen by ending, else by content (OBJ and binary STL have none to tell them by). @returns the scan with finite values, or an
/// error with the file as place: one line, fault and numbers; bad_input, or unavailable when there is not enough memory.
[[nodiscard]] Result<ReadScan> read_scan(const std::string& path, const ReadOptions& options);

// The readers behind it; each checks sizes against the file before it allocates, and lets no library exception pass.
[[nodiscard]] Result<ReadScan> read_dicom(const std::string& folder_or_file, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_nifti(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_nrrd(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_metaimage(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_raw(const std::string& sidecar_toml, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_mesh_scan(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_foreign_vdb(const std::string& path, const ReadOptions& options);

}  // namespace burrhole
