/// volumes/read/dicom_series.h: finds the slices in a folder, groups them into series and selects one.
///   Frame  LPS.   Errors  bad_input.   Order  files by path, so that the same folder gives the same report on every file system.
#pragma once

#include <string>
#include <vector>

#include "volumes/read/dicom_header.h"
#include "volumes/read/scan.h"
#include "volumes/read/slice_stack.h"

namespace burrhole {

struct DicomFolder {
  std::vector<DicomHeader> headers;  ///< of files that may be slices
  std::vector<Skipped> skipped;      ///< the other files, by reason, most frequent first
};

/// One frame of one file: a slice.
struct SliceSource {
  std::size_t file = 0, frame = 0;  ///< index into DicomFolder::headers, and into its frames
};

struct DicomSeries {
  SeriesLine line;
  std::vector<std::size_t> files;   ///< into DicomFolder::headers
  std::vector<SliceSource> slices;  ///< sorted along the stack if there is no error
  SliceStack stack;
  std::string error_place;         ///< the invalid file, empty if the error concerns the series
  bool thickness_assumed = false;  ///< a single slice, with its SliceThickness

  [[nodiscard]] double voxels() const noexcept {
    return static_cast<double>(line.dims.x) * static_cast<double>(line.dims.y) * static_cast<double>(line.dims.z);
  }
};

/// Reads all headers below a folder, or one file. @returns bad_input if the path does not exist, cannot be read or is empty, if a single
/// file is not a slice, or if a folder has no slice (with the counts).
[[nodiscard]] Result<DicomFolder> scan_dicom_folder(const std::string& folder_or_file, const std::vector<DicomKeepTag>& keep);

/// Groups slices into series and stacks each; an error of a series is in its line.
[[nodiscard]] std::vector<DicomSeries> group_series(const DicomFolder& folder);

/// Selects the named series. Without a name: of the series without error the largest axial CT, else CT, else axial, else the largest.
/// @returns its index; bad_input if the name is unknown (the message lists the names), or the error of the named series, or of the largest
/// series if all have errors.
[[nodiscard]] Result<std::size_t> choose_series(const std::vector<DicomSeries>& series, const std::string& name, const std::string& place);

}  // namespace burrhole
