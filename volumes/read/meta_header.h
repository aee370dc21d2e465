/// volumes/read/meta_header.h: the header of a MetaImage (.mha, .mhd) from its text alone; no file access.
///   Frame   LPS; TransformMatrix kept whole, so a shear in it stays.     Units  m out.
///   Privacy Name, ID, Comment, AcquisitionDate and every key that is not needed are passed over; no message quotes them.
///   Source  MetaIO documentation (itk.org/Wiki/MetaIO/Documentation): triple n of TransformMatrix is the direction of axis n.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "volumes/read/image_file.h"
#include "volumes/read/number_text.h"

namespace burrhole {

struct MetaHeader {
  ImageHead image;
  Packing packing = Packing::raw;
  Quantity quantity = Quantity::unknown;  ///< other: the modality is said and is not CT
  std::size_t header_bytes = 0;           ///< where the data starts if local
  std::vector<std::string> data_files;    ///< as written; empty with no numbered: local
  std::optional<NumberedNames> numbered;
  std::uint64_t file_header_bytes = 0;  ///< to drop of each data file
  bool at_end = false;                  ///< HeaderSize = -1
};

/// Whether the text starts as a MetaImage does: a known key and "=".
[[nodiscard]] bool looks_like_metaimage(std::string_view text);

/// @returns bad_input without place: fields missing or wrong, not three axes, channels, no usable affine, a data file form that is not
/// read.
[[nodiscard]] Result<MetaHeader> parse_metaimage(std::string_view text);

}  // namespace burrhole
