/// volumes/read/stream_shape.h: what a compressed stream says about itself, before a codec sees it.
///   Source  ITU-T T.81 annex B (JPEG), T.87 annex C (JPEG-LS), T.800 annex A (JPEG 2000): markers and sizes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
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

/// The same JPEG image of one scan without comments and application segments, which decoders warn about; GDCM answers a warning about the
/// header by ending the process. @pre stream_is_whole. @returns nothing for a stream that is anything but tables, one frame header and one
/// scan.
[[nodiscard]] std::vector<std::byte> plain_jpeg(std::span<const std::byte> stream);

}  // namespace burrhole
