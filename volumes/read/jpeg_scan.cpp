#include "volumes/read/jpeg_scan.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace burrhole {
namespace {

using Bytes = std::span<const std::byte>;

unsigned byte_at(Bytes s, std::size_t at) { return std::to_integer<unsigned>(s[at]); }
unsigned word_at(Bytes s, std::size_t at) { return (byte_at(s, at) << 8) | byte_at(s, at + 1); }

/// Bits of a scan, most significant first, without stuffed zeros; ends at a marker. T.81 F.2.2.5.
class Bits {
 public:
  explicit Bits(Bytes scan) : scan_(scan) {}
  /// @returns 0 or 1, or -1 at the end.
  int next() {
    if (left_ == 0 && !fill()) return -1;
    return static_cast<int>((byte_ >> --left_) & 1u);
  }
  bool skip(unsigned count) {
    for (unsigned n = 0; n < count; ++n)
      if (next() < 0) return false;
    return true;
  }
  /// Skips the restart marker that must follow.
  bool restart() {
    left_ = 0;
    if (at_ + 2 > scan_.size() || byte_at(scan_, at_) != 0xff || (byte_at(scan_, at_ + 1) & 0xf8u) != 0xd0) return false;
    at_ += 2;
    return true;
  }

 private:
  bool fill() {
    if (at_ >= scan_.size()) return false;
    byte_ = byte_at(scan_, at_);
    if (byte_ == 0xff) {
      if (at_ + 1 >= scan_.size() || byte_at(scan_, at_ + 1) != 0) return false;
      ++at_;
    }
    ++at_;
    left_ = 8;
    return true;
  }

  Bytes scan_;
  std::size_t at_ = 0;
  unsigned byte_ = 0, left_ = 0;
};

/// One Huffman table. T.81 C.2, F.2.2.3.
struct Huffman {
  std::array<unsigned, 17> counts{};
  std::vector<std::uint8_t> values;

  /// @returns the value of the next code, or -1: no bits left, or an invalid code.
  [[nodiscard]] int next(Bits& bits) const {
    unsigned code = 0, first = 0, index = 0;
    for (std::size_t length = 1; length <= 16; ++length) {
      const int bit = bits.next();
      if (bit < 0) return -1;
      code = (code << 1) | static_cast<unsigned>(bit);
      first <<= 1;
      if (code - first < counts[length]) return values[index + (code - first)];
      index += counts[length];
      first += counts[length];
    }
    return -1;
  }
};

struct Stream {
  std::array<std::optional<Huffman>, 4> dc, ac;  ///< dc: of differences, also in lossless files
  unsigned restart_interval = 0;
  unsigned rows = 0, columns = 0;
  bool lossless = false, has_frame = false;
  std::size_t dc_table = 0, ac_table = 0;
  Bytes scan;
};

bool read_tables(Bytes body, Stream& out) {
  while (!body.empty()) {
    if (body.size() < 17) return false;
    const unsigned which = byte_at(body, 0);
    if ((which >> 4) > 1 || (which & 15u) > 3) return false;
    Huffman table;
    std::size_t total = 0;
    for (std::size_t n = 1; n <= 16; ++n) total += table.counts[n] = byte_at(body, n);
    if (total > 256 || body.size() < 17 + total) return false;
    for (const std::byte v : body.subspan(17, total)) table.values.push_back(std::to_integer<std::uint8_t>(v));
    ((which >> 4) == 0 ? out.dc : out.ac)[which & 15u] = std::move(table);
    body = body.subspan(17 + total);
  }
  return true;
}

/// Reads the segments up to the scan. @returns false if the stream is not one grey image.
bool read_segments(Bytes s, Stream& out) {
  for (std::size_t at = 2; at + 6 <= s.size();) {
    const unsigned marker = byte_at(s, at + 1);
    const std::size_t length = word_at(s, at + 2);
    if (length < 2 || at + 2 + length + 2 > s.size()) return false;
    const Bytes body = s.subspan(at + 4, length - 2);
    at += 2 + length;
    if (marker == 0xc4 && !read_tables(body, out)) return false;
    if (marker == 0xdd && body.size() >= 2) out.restart_interval = word_at(body, 0);
    if (marker == 0xc0 || marker == 0xc1 || marker == 0xc3) {
      if (body.size() != 9 || byte_at(body, 5) != 1) return false;
      out.has_frame = true;
      out.lossless = marker == 0xc3;
      out.rows = word_at(body, 1);
      out.columns = word_at(body, 3);
    }
    if (marker != 0xda) continue;
    if (!out.has_frame || body.size() != 6 || byte_at(body, 0) != 1) return false;
    out.dc_table = byte_at(body, 2) >> 4;
    out.ac_table = byte_at(body, 2) & 15u;
    out.scan = s.subspan(at, s.size() - at - 2);
    return out.dc_table < 4 && out.ac_table < 4 && out.dc[out.dc_table] && (out.lossless || out.ac[out.ac_table]);
  }
  return false;
}

/// One difference: its category, then as many bits as the category; category 16 has none. T.81 H.1.2.2.
bool pass_sample(const Huffman& table, Bits& bits) {
  const int category = table.next(bits);
  return category >= 0 && category <= 16 && (category == 16 || bits.skip(static_cast<unsigned>(category)));
}

/// One 8 x 8 block: its mean, then runs of zeros and coefficients until the end of the block. T.81 F.2.2.1, F.2.2.2.
bool pass_block(const Huffman& dc, const Huffman& ac, Bits& bits) {
  if (!pass_sample(dc, bits)) return false;
  for (int k = 1; k < 64;) {
    const int code = ac.next(bits);
    if (code < 0) return false;
    const int run = code >> 4, size = code & 15;
    if (size == 0 && run != 15) return true;
    k += run + 1;
    if (k > 64 || !bits.skip(static_cast<unsigned>(size))) return false;
  }
  return true;
}

}  // namespace

bool jpeg_scan_is_whole(std::span<const std::byte> stream) {
  Stream s;
  if (stream.size() < 4 || !read_segments(stream, s)) return false;
  const std::size_t units = s.lossless ? std::size_t{s.rows} * s.columns : std::size_t{(s.rows + 7) / 8} * ((s.columns + 7) / 8);
  Bits bits(s.scan);
  for (std::size_t n = 0; n < units; ++n) {
    if (s.restart_interval > 0 && n > 0 && n % s.restart_interval == 0 && !bits.restart()) return false;
    const Huffman& dc = *s.dc[s.dc_table];
    if (!(s.lossless ? pass_sample(dc, bits) : pass_block(dc, *s.ac[s.ac_table], bits))) return false;
  }
  return units > 0;
}

}  // namespace burrhole
