/// volumes/read/dicom_series.h: which files of a folder are slices, to which series they belong, and which series is taken.
///   Order  files by path, so that the same folder gives the same report on every file system.
#pragma once

#include <string>
#include <vector>

#include "volumes/read/dicom_header.h"
#include "volumes/read/scan.h"
#include "volumes/read/slice_stack.h"

namespace burrhole {

struct DicomFolder {
  std::vector<DicomHeader> headers;  ///< of files that may be slices
  std::vector<Skipped> skipped;      ///< the others, by reason, most frequent first
};

/// One frame of one file: a slice.
struct SliceSource {
  std::size_t file = 0, frame = 0;  ///< index into DicomFolder::headers, and into its frames
};

struct DicomSeries {
  SeriesLine line;
  std::vector<std::size_t> files;   ///< into DicomFolder::headers
  std::vector<SliceSource> slices;  ///< sorted along the stack when there is no fault
  SliceStack stack;
  std::string fault_place;         ///< the file at fault, empty when the fault is of the series
  bool thickness_assumed = false;  ///< one slice, as thick as its SliceThickness

  [[nodiscard]] double voxels() const noexcept {
    return static_cast<double>(line.dims.x) * static_cast<double>(line.dims.y) * static_cast<double>(line.dims.z);
  }
};

/// Reads all headers below a folder, or the one file. @returns bad_input: no such path, no permission, empty, a lone file that is no slice,
/// or a folder without any slice, with the counts.
[[nodiscard]] Result<DicomFolder> scan_dicom_folder(const std::string& folder_or_file, const std::vector<DicomKeepTag>& keep);

/// Groups slices into series and stacks each; what is wrong with one is in its line.
[[nodiscard]] std::vector<DicomSeries> group_series(const DicomFolder& folder);

/// The named series, or of those without fault the largest axial CT, else CT, else axial, else largest.
/// @returns its index; bad_input: unknown name (names listed), or the fault of the one that was asked for or of the largest when all have
/// one.
[[nodiscard]] Result<std::size_t> choose_series(const std::vector<DicomSeries>& series, const std::string& name, const std::string& place);

}  // namespace burrhole
