/// volumes/read/dicom_header.h: what one DICOM file says about its slice or slices, as plain values.
///   Units   mm, as DICOM has them.   Privacy  UIDs stay in memory to group files by; no other field of a patient or study is looked at
///   unless it is asked for by tag.   Source   DICOM PS3.3 C.7.6.2, C.7.6.3, C.8.2.1 (CT), C.7.6.16 (functional groups).
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

/// How one stored pixel is laid out. PS3.5 sec. 8.1.1.
struct StoredForm {
  int bits_allocated = 16;  ///< 8, 16 or 32
  int bits_stored = 16;     ///< 1..bits_allocated
  int high_bit = 15;        ///< bits_stored - 1 .. bits_allocated - 1; bits outside are overlays
  bool is_signed = false;
  bool big_endian = false;
  bool swapped_bytes = false;                                    ///< 8-bit pixels in big-endian words: neighbours are exchanged
  std::optional<std::pair<std::int64_t, std::int64_t>> padding;  ///< stored values lo..hi that are no measurement

  [[nodiscard]] std::size_t bytes() const noexcept { return static_cast<std::size_t>(bits_allocated) / 8; }
};

struct DicomFrame {
  std::optional<SlicePlane> plane;  ///< absent: the file does not say where the frame lies
  double slope = 1.0, intercept = 0.0;
  bool has_rescale = false;   ///< both are in the file
  double thickness_mm = 0.0;  ///< SliceThickness; 0: not said
};

/// A field that the user asked for.
struct DicomKeepTag {
  std::string keyword;
  DicomTag tag = 0;
  std::string vr;
};

struct DicomHeader {
  std::string path;
  std::string skip;   ///< why the file is no slice of a scan, empty if it may be one
  std::string fault;  ///< why it is one that cannot be read, empty if it can
  std::string series_uid, instance_uid;
  std::string series_number;  ///< digits, or "-"
  std::string modality;       ///< capital letters, or "-"
  int columns = 0, rows = 0;
  DicomCodec codec = DicomCodec::none;
  StoredForm stored;
  PixelSpan pixels;
  std::optional<std::uint64_t> deflated_at;  ///< where inflation starts, for files whose data set is deflated
  std::uint64_t file_bytes = 0;
  std::vector<DicomFrame> frames;
  bool has_rescale = false;       ///< slope and intercept are in the file, for every frame
  bool hounsfield = true;         ///< RescaleType is HU or not said
  bool white_is_low = false;      ///< MONOCHROME1
  bool lossy = false;             ///< was compressed with loss
  std::vector<std::string> kept;  ///< one for each tag asked for
};

/// Reads one regular file up to its pixels. @returns a header whose `skip` or `fault` says what is wrong with it;
/// bad_input only when the file cannot be opened.
[[nodiscard]] Result<DicomHeader> read_dicom_header(const std::string& path, const std::vector<DicomKeepTag>& keep);

}  // namespace burrhole
