/// volumes/read/nrrd_header.h: the header of NRRD (attached or detached) from its text alone; no file access.
///   Frame   LPS out, from RAS, LAS or LPS; other spaces are taken as LPS and told. Space directions kept whole.     Units  m out.
///   Privacy comments, key:=value pairs, content, labels and sample units are passed over; no message quotes them.
///   Source  the NRRD format definition, revision 5 (teem.sourceforge.net/nrrd/format.html).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "volumes/read/image_file.h"
#include "volumes/read/number_text.h"

namespace burrhole {

struct NrrdHeader {
  ImageHead image;
  Packing packing = Packing::raw;
  std::size_t header_bytes = 0;         ///< where the data of an attached header starts
  std::vector<std::string> data_files;  ///< as written, relative to the header; empty with no numbered: data is attached
  std::optional<NumberedNames> numbered;
  std::uint64_t line_skip = 0;  ///< lines to drop of each data file, before unpacking
  std::uint64_t byte_skip = 0;  ///< [bytes] to drop after unpacking
  bool at_end = false;          ///< byte skip: -1
};

/// @param text the start of the file, up to what may be voxels. @returns bad_input without place, with the line: not NRRD, fields missing
/// or wrong, dimension other than 3, colours or vectors, an encoding that is not read (bzip2, hex), no usable affine.
[[nodiscard]] Result<NrrdHeader> parse_nrrd(std::string_view text);

}  // namespace burrhole
