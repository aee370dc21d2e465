/// volumes/read/scan.h: a volume as read from a file, before classification as bone.
///   Frame   bone frame = patient LPS as in DICOM and ITK; bone_from_index is the full affine, including shear and gantry tilt.
///   Units   SI in structs; values in Hounsfield units where `quantity` says so.   Errors  bad_input, unavailable.
///   Thread  any; readers share no state.
///   Privacy these structs contain no field of a patient or a study unless ReadOptions::keep names it.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/geometry.h"
#include "core/base/result.h"

namespace burrhole {

/// [voxels] Largest volume that a reader allocates: 2048 slices of 1024 x 1024.
inline constexpr double kMaxScanVoxels = 2048.0 * 1024.0 * 1024.0;

/// Meaning of a voxel's value. `unknown`: not stated in the file (NIfTI, NRRD, MetaImage, raw); determined later from the values.
enum class Quantity { hounsfield, unknown, other, occupancy };

struct Scan {
  Vec3i dims{0};           ///< [voxels]
  Affine bone_from_index;  ///< [m]
  Quantity quantity = Quantity::unknown;
  /// [HU], [-] or [unit of the file]; dims.x*dims.y*dims.z, i fastest; slope and intercept applied; occupancy 0..1 from meshes
  std::vector<float> values;
};

/// One series of a folder, as listed in the report. It contains no UID and no description: both can identify a patient.
struct SeriesLine {
  std::string name;  ///< series number as text, "3b" for a second series of number 3; the argument of ReadOptions::series
  std::string modality;
  Vec3i dims{0};          ///< [voxels] z: slices
  Vec3 spacing{0.0};      ///< [m]
  std::string direction;  ///< "axial", "coronal", "sagittal"
  bool taken = false;
  std::string error;  ///< why it cannot be a volume, empty if it can
};

struct Skipped {
  std::string reason;  ///< "not DICOM", "localizer", "screen capture", ...
  std::size_t count = 0;
};

struct KeptField {
  std::string name, value;
};

/// What was found and assumed; all of it is printed.
struct ScanReport {
  std::string format;  ///< "DICOM", "NIfTI-1", "NRRD", ...
  std::vector<SeriesLine> series;
  std::vector<std::string> assumed;  ///< one line each, e.g. "one slice: thickness 5 mm from SliceThickness"
  std::vector<Skipped> skipped;
  std::vector<KeptField> kept;  ///< fields requested by ReadOptions::keep
};

struct ReadOptions {
  std::string series;             ///< series of a DICOM folder, by SeriesLine::name; grid name of a foreign .vdb; empty: the largest
  std::optional<double> unit;     ///< [m] length of one unit of a mesh or a foreign .vdb, whose files have no unit
  std::optional<double> pitch;    ///< [m] voxel edge for a mesh; absent: longest side / 256, listed in `assumed`
  std::vector<std::string> keep;  ///< DICOM keywords (PatientID, ...) to copy into the report
  bool by_values = false;         ///< the mark of an exported density is ignored: the values are those of a scan
  std::optional<double> memory;   ///< [bytes] limit for the voxels; absent: the available memory of the machine
  /// Called with dims, affine and quantity after the headers and before the values are read; its error ends the reading. May be empty.
  std::function<Status(const Scan&)> accept;
  std::function<void(double)> progress;  ///< called from time to time with the share done, 0..1; may be empty
  std::stop_token stop;                  ///< a request ends the reading, between slices and pieces, with an error `unavailable`
};

/// Reports the share that is done. @returns an error if the reading shall stop.
[[nodiscard]] Status advance(const ReadOptions& options, double share);

struct ReadScan {
  Scan scan;
  ScanReport report;
};

/// Reads any supported input: a folder or file of DICOM, .nii(.gz) .hdr .nrrd .nhdr .mha .mhd, a raw volume's .toml, .stl .obj .ply, a
/// foreign .vdb. The format is detected by extension, else by content (OBJ and binary STL have no magic bytes). @returns the scan with
/// finite values, or an error of one line with the file as place: bad_input, or unavailable if there is not enough memory.
[[nodiscard]] Result<ReadScan> read_scan(const std::string& path, const ReadOptions& options);

// The readers of the formats. Each checks sizes against the file before it allocates, and catches all exceptions of libraries.
[[nodiscard]] Result<ReadScan> read_dicom(const std::string& folder_or_file, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_nifti(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_nrrd(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_metaimage(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_raw(const std::string& sidecar_toml, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_mesh_scan(const std::string& path, const ReadOptions& options);
[[nodiscard]] Result<ReadScan> read_foreign_vdb(const std::string& path, const ReadOptions& options);

}  // namespace burrhole
