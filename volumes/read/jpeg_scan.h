/// volumes/read/jpeg_scan.h: tests whether a JPEG stream contains all of its image. Decoders fill missing parts with grey and only warn.
///   Errors  none.   Source  ITU-T T.81: annex C (Huffman codes), F.2.2 (sequential), H.2 (lossless), B.2 (segments). Codes are counted,
///   not decoded to pixels.
#pragma once

#include <cstddef>
#include <span>

namespace burrhole {

/// @param stream one greyscale image: tables, one frame header (SOF0, SOF1 or SOF3) and one scan, no padding after the end.
/// @returns whether every block or sample of the frame has valid codes. Remaining bits are permitted.
[[nodiscard]] bool jpeg_scan_is_whole(std::span<const std::byte> stream);

}  // namespace burrhole
