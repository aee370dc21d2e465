/// volumes/read/meta_header.h: parses the header of a MetaImage (.mha, .mhd) from its text; no file access.
///   Frame   LPS; TransformMatrix is used as it is, including shear.     Units  m.   Errors  bad_input without place.
///   Privacy Name, ID, Comment, AcquisitionDate and all keys that are not needed are skipped; no message quotes them.
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
  Quantity quantity = Quantity::unknown;  ///< other: the modality is stated and is not CT
  std::size_t header_bytes = 0;           ///< start of the data if local
  std::vector<std::string> data_files;    ///< as written; empty without `numbered`: local
  std::optional<NumberedNames> numbered;
  std::uint64_t file_header_bytes = 0;  ///< to skip in each data file
  bool at_end = false;                  ///< HeaderSize = -1
};

/// @returns whether the text starts with a known key and "=", as a MetaImage does.
[[nodiscard]] bool starts_like_metaimage(std::string_view text);

/// @returns bad_input without place if fields are missing or wrong, the image does not have three axes and one channel, the affine is not
/// usable, or the form of the data file is not supported.
[[nodiscard]] Result<MetaHeader> parse_metaimage(std::string_view text);

}  // namespace burrhole
