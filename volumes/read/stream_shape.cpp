#include "volumes/read/stream_shape.h"

#include <algorithm>
#include <array>

namespace burrhole {
namespace {

constexpr std::size_t kLongestBox = 512;  // [bytes] JP2 boxes that some writers put before the JPEG 2000 codestream

unsigned byte_at(std::span<const std::byte> s, std::size_t at) { return std::to_integer<unsigned>(s[at]); }
unsigned word_at(std::span<const std::byte> s, std::size_t at) { return dicom_u16(s.data() + at, true); }

/// T.81 B.2.2, T.87 C.2.2: the frame header SOFn, reached over the segments before it.
std::optional<StreamShape> jpeg_shape(DicomCodec codec, std::span<const std::byte> s) {
  if (s.size() < 4 || word_at(s, 0) != 0xffd8) return std::nullopt;
  for (std::size_t at = 2; at + 10 <= s.size();) {
    if (byte_at(s, at) != 0xff) return std::nullopt;
    const unsigned marker = byte_at(s, at + 1);
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    const bool frame = codec == DicomCodec::jpeg_ls
                           ? marker == 0xf7
                           : marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame)
      return StreamShape{.columns = static_cast<int>(word_at(s, at + 7)),
                         .rows = static_cast<int>(word_at(s, at + 5)),
                         .components = static_cast<int>(byte_at(s, at + 9)),
                         .bits = static_cast<int>(byte_at(s, at + 4))};
    if (marker == 0xda || marker == 0xd9) return std::nullopt;
    at += 2 + word_at(s, at + 2);
  }
  return std::nullopt;
}

/// Entropy-coded bytes contain no markers except restarts. T.81 B.1.1.5.
bool scan_is_plain(std::span<const std::byte> scan) {
  for (std::size_t n = 0; n < scan.size(); ++n) {
    if (scan[n] != std::byte{0xff}) continue;
    const unsigned next = n + 1 < scan.size() ? byte_at(scan, n + 1) : 0xff;
    if (next != 0x00 && (next < 0xd0 || next > 0xd7)) return false;
    ++n;
  }
  return true;
}

/// The raw codestream: SOC and SIZ. T.800 A.4.1, A.5.1.
std::optional<std::size_t> codestream_at(std::span<const std::byte> s) {
  constexpr std::array<std::byte, 4> kStart = {std::byte{0xff}, std::byte{0x4f}, std::byte{0xff}, std::byte{0x51}};
  const auto area = s.first(std::min(s.size(), kLongestBox));
  const auto found = std::search(area.begin(), area.end(), kStart.begin(), kStart.end());
  if (found == area.end()) return std::nullopt;
  return static_cast<std::size_t>(found - area.begin());
}

std::optional<StreamShape> jpeg_2000_shape(std::span<const std::byte> s) {
  const auto start = codestream_at(s);
  if (!start || s.size() < *start + 45) return std::nullopt;
  const std::byte* siz = s.data() + *start;
  const auto size = [&](std::size_t at) { return std::int64_t{dicom_u32(siz + at, true)}; };
  const std::int64_t columns = size(8) - size(16), rows = size(12) - size(20);
  const bool sized = columns > 0 && rows > 0 && columns <= 65535 && rows <= 65535;
  // No offset and no subsampling, as written for DICOM.
  const bool plain = size(16) == 0 && size(20) == 0 && std::to_integer<int>(siz[43]) == 1 && std::to_integer<int>(siz[44]) == 1;
  if (!sized || !plain) return std::nullopt;
  return StreamShape{.columns = static_cast<int>(columns),
                     .rows = static_cast<int>(rows),
                     .components = static_cast<int>(dicom_u16(siz + 40, true)),
                     .bits = (std::to_integer<int>(siz[42]) & 0x7f) + 1};
}

bool ends_with(std::span<const std::byte> s) { return s.size() >= 2 && word_at(s, s.size() - 2) == 0xffd9; }

/// Tile parts follow each other by their lengths and end at EOC. T.800 A.4.2; a length of 0 means the rest.
bool tile_parts_whole(std::span<const std::byte> s) {
  const auto start = codestream_at(s);
  if (!start) return false;
  const std::size_t end = s.size() - 2;
  std::size_t at = *start + 2;
  bool tiles = false;
  while (at + 4 <= end) {
    const unsigned marker = word_at(s, at);
    if (marker != 0xff90) {  // a segment of the main header
      if (tiles || (marker >> 8) != 0xff) return false;
      at += 2 + word_at(s, at + 2);
      continue;
    }
    if (at + 12 > end) return false;
    tiles = true;
    const std::uint32_t length = dicom_u32(s.data() + at + 6, true);
    if (length == 0) return true;
    if (length < 14 || length > end - at) return false;
    at += length;
  }
  return tiles && at == end;
}

}  // namespace

std::span<const std::byte> without_padding(std::span<const std::byte> s) noexcept {
  while (!s.empty() && (s.back() == std::byte{0} || s.back() == std::byte{0xff})) s = s.first(s.size() - 1);
  return s;
}

bool starts_stream(DicomCodec codec, std::span<const std::byte> first) noexcept {
  if (first.size() < 8 || codec == DicomCodec::rle) return false;
  const std::uint32_t begin = dicom_u32(first.data(), true);
  if (codec != DicomCodec::jpeg_2000) return begin >> 8 == 0xffd8ff;
  // SOC and SIZ of a codestream, or the signature box of a file. Both may be met in compressed data, once in 2^32.
  return begin == 0xff4fff51 || (begin == 12 && dicom_u32(first.data() + 4, true) == 0x6a502020);
}

std::vector<std::byte> plain_jpeg(std::span<const std::byte> s) {
  s = without_padding(s);
  std::vector<std::byte> out(s.begin(), s.begin() + 2);
  int frames = 0;
  for (std::size_t at = 2; at + 4 <= s.size();) {
    const unsigned marker = byte_at(s, at + 1);
    const std::size_t length = word_at(s, at + 2);
    if (byte_at(s, at) != 0xff || length < 2 || at + 2 + length + 2 > s.size()) return {};
    const auto segment = s.subspan(at, 2 + length);
    at += segment.size();
    const bool frame = marker == 0xc0 || marker == 0xc1 || marker == 0xc3;
    const bool table = marker == 0xc4 || marker == 0xdb || marker == 0xdd;
    const bool comment = (marker >= 0xe0 && marker <= 0xef) || marker == 0xfe;
    if (comment) continue;
    if ((!frame && !table && marker != 0xda) || (frame && ++frames > 1)) return {};
    out.insert(out.end(), segment.begin(), segment.end());
    if (marker != 0xda) continue;
    const auto scan = s.subspan(at, s.size() - at - 2);
    if (frames != 1 || !scan_is_plain(scan)) return {};
    out.insert(out.end(), scan.begin(), scan.end());
    out.insert(out.end(), {std::byte{0xff}, std::byte{0xd9}});
    return out;
  }
  return {};
}

std::optional<StreamShape> stream_shape(DicomCodec codec, std::span<const std::byte> stream) {
  return codec == DicomCodec::jpeg_2000 ? jpeg_2000_shape(stream) : jpeg_shape(codec, stream);
}

bool stream_is_whole(DicomCodec codec, std::span<const std::byte> stream) {
  const auto bare = without_padding(stream);
  return ends_with(bare) && (codec != DicomCodec::jpeg_2000 || tile_parts_whole(bare));
}

}  // namespace burrhole
