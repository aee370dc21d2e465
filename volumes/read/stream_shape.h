/// volumes/read/stream_shape.h: sizes in the header of a compressed stream, checked before a codec is used.
///   Errors  an empty result.   Source  ITU-T T.81 annex B (JPEG), T.87 annex C (JPEG-LS), T.800 annex A (JPEG 2000): markers and sizes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "volumes/read/dicom_header.h"

namespace burrhole {

/// Sizes stated in a compressed stream.
struct StreamShape {
  int columns = 0, rows = 0;  ///< [pixels]
  int components = 0;
  int bits = 0;                                                                                    ///< [bits] per sample
  [[nodiscard]] std::size_t bytes() const noexcept { return bits <= 8 ? 1 : bits <= 16 ? 2 : 4; }  ///< of one decoded sample
};

/// @returns the stream without the bytes after its end: DICOM requires an even length, and writers pad with 00 or with the fill byte FF.
[[nodiscard]] std::span<const std::byte> without_padding(std::span<const std::byte> stream) noexcept;

/// @param first the first bytes of a fragment. @returns whether a compressed image begins there. Of RLE, whose frames have one fragment each,
/// always false.
[[nodiscard]] bool starts_stream(DicomCodec codec, std::span<const std::byte> first) noexcept;

/// @returns the sizes in the stream's header, or nothing if there is no such header.
[[nodiscard]] std::optional<StreamShape> stream_shape(DicomCodec codec, std::span<const std::byte> stream);

/// @returns whether the stream is complete: the last marker and, in JPEG 2000, all tile parts are present.
[[nodiscard]] bool stream_is_whole(DicomCodec codec, std::span<const std::byte> stream);

/// @returns the same JPEG image of one scan without comments and application segments. Decoders warn about these, and GDCM ends the process
/// on a warning about the header. Empty if the stream has more than tables, one frame header and one scan. @pre stream_is_whole().
[[nodiscard]] std::vector<std::byte> plain_jpeg(std::span<const std::byte> stream);

}  // namespace burrhole
