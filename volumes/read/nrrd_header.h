/// volumes/read/nrrd_header.h: parses the header of NRRD (attached or detached) from its text; no file access.
///   Frame   LPS out, from RAS, LAS or LPS; other spaces are assumed to be LPS and reported. Space directions are used as they are.
///   Units   m.   Errors  bad_input without place, with the line.
///   Privacy comments, key:=value pairs, content, labels and sample units are skipped; no message quotes them.
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
  std::size_t header_bytes = 0;         ///< start of the data after an attached header
  std::vector<std::string> data_files;  ///< as written, relative to the header; empty without `numbered`: data is attached
  std::optional<NumberedNames> numbered;
  std::uint64_t line_skip = 0;  ///< lines to skip in each data file, before decompression
  std::uint64_t byte_skip = 0;  ///< [bytes] to skip after decompression
  bool at_end = false;          ///< byte skip: -1
};

/// @param text the start of the file, possibly including voxels. @returns bad_input without place, with the line: not NRRD, fields missing
/// or wrong, dimension other than 3, colours or vectors, an unsupported encoding (bzip2, hex), no usable affine.
[[nodiscard]] Result<NrrdHeader> parse_nrrd(std::string_view text);

}  // namespace burrhole
