/// volumes/read/gdcm_codecs.h: the wrapper round GDCM: JPEG, JPEG-LS and JPEG 2000 streams to samples, and its dictionary of keywords.
///   Why checked first  GDCM's assertions and its reliance on the stream's own sizes: a stream is looked at by ourselves (stream_shape.h)
///   before GDCM sees it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "volumes/read/dicom_header.h"
#include "volumes/read/stream_shape.h"

namespace burrhole {

/// Decodes one greyscale frame into little-endian samples of shape.bytes(). @pre `shape` is the stream's own.
/// @returns false when GDCM cannot, or when another number of bytes than the shape's comes out.
[[nodiscard]] bool decode_stream(DicomCodec codec, std::span<const std::byte> stream, const StreamShape& shape,
                                 std::vector<std::byte>& out);

/// The tag of a DICOM keyword. @returns bad_input that names the nearest keyword, or for an element that holds no text.
[[nodiscard]] Result<DicomKeepTag> find_keyword(const std::string& keyword);

}  // namespace burrhole
