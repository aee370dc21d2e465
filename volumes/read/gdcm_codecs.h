/// volumes/read/gdcm_codecs.h: the wrapper round GDCM: JPEG, JPEG-LS and JPEG 2000 streams to samples, and its dictionary of keywords.
///   Why checked first  GDCM's assertions and its reliance on the stream's own sizes: a stream is looked at by ourselves before GDCM sees it.
///   Source  ITU-T T.81 annex B (JPEG), T.87 annex C (JPEG-LS), T.800 annex A (JPEG 2000): markers and sizes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volumes/read/dicom_header.h"

namespace burrhole {

/// What a compressed stream says about itself.
struct StreamShape {
  int columns = 0, rows = 0;
  int components = 0;
  int bits = 0;
  [[nodiscard]] std::size_t bytes() const noexcept { return bits <= 8 ? 1 : bits <= 16 ? 2 : 4; }  ///< of one decoded sample
};

/// @returns the sizes in the stream's header, or nothing when there is no such header.
[[nodiscard]] std::optional<StreamShape> stream_shape(DicomCodec codec, std::span<const std::byte> stream);

/// @returns whether the stream has its end: the last marker and, in JPEG 2000, all tile parts in between.
[[nodiscard]] bool stream_is_whole(DicomCodec codec, std::span<const std::byte> stream);

/// Decodes one greyscale frame into little-endian samples of shape.bytes(). @pre `shape` is the stream's own.
/// @returns false when GDCM cannot, or when another number of bytes than the shape's comes out.
[[nodiscard]] bool decode_stream(DicomCodec codec, std::span<const std::byte> stream, const StreamShape& shape,
                                 std::vector<std::byte>& out);

/// The tag of a DICOM keyword. @returns bad_input that names the nearest keyword, or for an element that holds no text.
[[nodiscard]] Result<DicomKeepTag> find_keyword(const std::string& keyword);

}  // namespace burrhole
