/// volumes/read/dicom_header.h: the header of one DICOM file as plain values: its slice or slices.
///   Frame   LPS.   Units  mm, as in DICOM.   Errors  bad_input; DicomHeader::skip and ::error.
///   Privacy UIDs are kept in memory to group files; other fields of a patient or study are read only if requested by tag.
///   Source  DICOM PS3.3 C.7.6.2, C.7.6.3, C.8.2.1 (CT), C.7.6.16 (functional groups).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volumes/read/dicom_elements.h"
#include "volumes/read/slice_stack.h"

namespace burrhole {

enum class DicomCodec : std::uint8_t { none, rle, jpeg, jpeg_ls, jpeg_2000 };

/// Storage of a pixel. PS3.5 sec. 8.1.1.
struct StoredForm {
  int bits_allocated = 16;  ///< [bits] 8, 16 or 32
  int bits_stored = 16;     ///< [bits] 1..bits_allocated
  int high_bit = 15;        ///< bits_stored - 1 .. bits_allocated - 1; other bits are overlays
  bool is_signed = false;
  bool big_endian = false;
  bool swapped_bytes = false;                                    ///< 8-bit pixels in big-endian words: neighbours are swapped
  std::optional<std::pair<std::int64_t, std::int64_t>> padding;  ///< stored values lo..hi that are padding

  [[nodiscard]] std::size_t bytes() const noexcept { return static_cast<std::size_t>(bits_allocated) / 8; }
};

struct DicomFrame {
  std::optional<SlicePlane> plane;      ///< absent: the file does not define the position of the frame
  double slope = 1.0, intercept = 0.0;  ///< [HU per stored unit], [HU]
  bool has_rescale = false;             ///< the file has both
  double thickness_mm = 0.0;            ///< [mm] SliceThickness; 0: absent
};

/// A field that the user requested.
struct DicomKeepTag {
  std::string keyword;
  DicomTag tag = 0;
  std::string vr;
};

struct DicomHeader {
  std::string path;
  std::string skip;   ///< why the file is not a slice of a scan, empty if it may be one
  std::string error;  ///< why the slice cannot be read, empty if it can
  std::string series_uid, instance_uid;
  std::string series_number;                                  ///< digits, or "-"
  std::optional<double> acquisition_number, instance_number;  ///< [-] as written; they separate two slices at one place
  std::string modality;                                       ///< capital letters, or "-"
  int columns = 0, rows = 0;
  DicomCodec codec = DicomCodec::none;
  StoredForm stored;
  PixelSpan pixels;
  std::optional<std::uint64_t> deflated_at;  ///< [bytes] start of deflated data, if the data set is deflated
  std::uint64_t file_bytes = 0;
  std::vector<DicomFrame> frames;
  bool has_rescale = false;       ///< every frame has slope and intercept in the file
  bool hounsfield = true;         ///< RescaleType is HU or absent
  bool white_is_low = false;      ///< MONOCHROME1
  bool lossy = false;             ///< was compressed with loss
  std::vector<std::string> kept;  ///< one for each requested tag
};

/// Reads one regular file up to its pixels. @returns a header whose `skip` or `error` describes what is wrong with it; bad_input only if
/// the file cannot be opened.
[[nodiscard]] Result<DicomHeader> read_dicom_header(const std::string& path, const std::vector<DicomKeepTag>& keep);

}  // namespace burrhole
