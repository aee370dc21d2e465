/// volumes/read/jpeg_scan.h: does a JPEG stream hold all of its image? Decoders fill what is missing with grey and only warn.
///   Source  ITU-T T.81: annex C (Huffman codes), F.2.2 (sequential), H.2 (lossless), B.2 (segments). Codes are counted, not turned into
///   pixels.
#pragma once

#include <cstddef>
#include <span>

namespace burrhole {

/// @param stream one greyscale image: tables, one frame header (SOF0, SOF1 or SOF3) and one scan, no padding after the end.
/// @returns whether every block or sample of the frame has its codes, all of them valid. Bits left over are no fault.
[[nodiscard]] bool jpeg_scan_is_whole(std::span<const std::byte> stream);

}  // namespace burrhole
