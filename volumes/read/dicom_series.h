/// volumes/read/dicom_series.h: finds the slices in a folder, groups them into series and selects one.
///   Frame  LPS (x left, y posterior, z superior).   Errors  bad_input.
///   Order  files by path, so that the same folder gives the same report on every file system.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "volumes/read/dicom_header.h"
#include "volumes/read/scan.h"
#include "volumes/read/slice_stack.h"

namespace burrhole {

struct DicomFolder {
  std::vector<DicomHeader> headers;  ///< of files that may be slices
  std::vector<Skipped> skipped;      ///< number of other files per reason, most frequent first
};

/// One frame of one file: a slice.
struct SliceSource {
  std::size_t file = 0, frame = 0;  ///< index into DicomFolder::headers, and into its frames
};

struct DicomSeries {
  SeriesLine line;                  ///< name, size and error, as listed to the user
  std::vector<std::size_t> files;   ///< into DicomFolder::headers
  std::vector<SliceSource> slices;  ///< ordered by position along the stack; unordered if the series has an error
  SliceStack stack;
  std::string error_place;         ///< path of the invalid file; empty if the error concerns the whole series
  bool thickness_assumed = false;  ///< one slice: the spacing along the stack is its SliceThickness
  bool is_half = false;            ///< of a series of two even stacks, e.g. "3:1"; selected by its name alone

  [[nodiscard]] double voxel_count() const noexcept {
    return static_cast<double>(line.dims.x) * static_cast<double>(line.dims.y) * static_cast<double>(line.dims.z);
  }
};

/// Reads all headers below a folder, or one file. @param keep header fields to copy. @param goes_on called before each
/// file: its error ends the reading. @returns bad_input if the path does not exist, cannot be
/// read or is empty, if a single file is not a slice, or if a folder has no slice (the message gives the number of files per reason).
[[nodiscard]] Result<DicomFolder> scan_dicom_folder(const std::string& folder_or_file, const std::vector<DicomKeepTag>& keep,
                                                    const std::function<Status()>& goes_on);

/// Groups slices into series and stacks each. An invalid series is returned with its error in DicomSeries::line. Behind a series that is no
/// even stack but can be divided into two, these are listed: slices twice at each place, or two distances between slices.
[[nodiscard]] std::vector<DicomSeries> group_series(const DicomFolder& folder);

/// Selects the named series. Without a name, among valid series: axial CT, then any CT, then any axial, then any series; the largest of the
/// first group that is not empty. @param place of the name, for messages.
/// @returns its index. Errors: bad_input if the name is unknown (the message lists the names); the error of the selected series; without a
/// name, if all series have errors, that of the first in the same order, and a question if the best of several has one slice.
[[nodiscard]] Result<std::size_t> choose_series(const std::vector<DicomSeries>& series, const std::string& name, const std::string& place);

}  // namespace burrhole
