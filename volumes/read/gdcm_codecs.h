/// volumes/read/gdcm_codecs.h: wrapper of GDCM: decodes JPEG, JPEG-LS and JPEG 2000 streams to samples, and looks up DICOM keywords.
///   Errors  bad_input; false.   Reason  GDCM has enabled assertions and trusts the sizes in a stream, so stream_shape.h checks every
///   stream first.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "volumes/read/dicom_header.h"
#include "volumes/read/stream_shape.h"

namespace burrhole {

/// Decodes one greyscale frame into little-endian samples of shape.bytes(). @pre `shape` is that of the stream.
/// @returns false if GDCM fails or returns another number of bytes than `shape` states.
[[nodiscard]] bool decode_stream(DicomCodec codec, std::span<const std::byte> stream, const StreamShape& shape,
                                 std::vector<std::byte>& out);

/// @returns the tag of a DICOM keyword; bad_input if it is unknown (names the nearest keyword) or its element is not text.
[[nodiscard]] Result<DicomKeepTag> find_keyword(const std::string& keyword);

}  // namespace burrhole
