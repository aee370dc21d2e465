#include "app/session/row_codec.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <new>

namespace burrhole {
namespace {

constexpr char kBlockFormat = 1;
constexpr std::size_t kHeaderBytes = 5;    // format, coarse_every
constexpr std::size_t kPayloadHeader = 8;  // coarse_every again and rows, where zlib's checksum covers them
constexpr int kLevel = 1;
// Deflate codes at most 258 bytes in 2 bits [RFC 1951]. A larger payload size is damaged, and is not allocated.
constexpr std::uint64_t kMostExpansion = 1032;
constexpr std::uint64_t kMostPayload = std::uint64_t{1} << 31;

/// Method of an exact column: one byte before the column.
enum class Method : char { bits_xor, integer_difference };

template <class Word>
void put_little_endian(Word word, char* out) {
  for (std::size_t i = 0; i < sizeof(Word); ++i) out[i] = static_cast<char>(word >> (8 * i) & 0xffu);
}

template <class Word>
Word get_little_endian(const char* bytes) {
  Word word = 0;
  for (std::size_t i = 0; i < sizeof(Word); ++i)
    word |= static_cast<Word>(static_cast<Word>(static_cast<unsigned char>(bytes[i])) << (8 * i));
  return word;
}

/// Writes byte 0 of all words, then byte 1 of all, and so on, so that similar bytes are adjacent.
template <class Word>
void shuffle(const std::vector<Word>& words, std::string& out) {
  for (std::size_t byte = 0; byte < sizeof(Word); ++byte)
    for (const Word word : words) out += static_cast<char>(word >> (8 * byte) & 0xffu);
}

template <class Word>
std::vector<Word> unshuffle(const char* bytes, std::size_t count) {
  std::vector<Word> words(count, 0);
  for (std::size_t byte = 0; byte < sizeof(Word); ++byte)
    for (Word& word : words) word |= static_cast<Word>(static_cast<Word>(static_cast<unsigned char>(*bytes++)) << (8 * byte));
  return words;
}

/// Maps differences 0, -1, 1, -2, ... to 0, 1, 2, 3, ...
std::uint64_t zigzag(std::uint64_t difference) { return difference << 1 ^ (0 - (difference >> 63)); }
std::uint64_t unzigzag(std::uint64_t code) { return code >> 1 ^ (0 - (code & 1)); }

/// @returns whether the value is an integer whose conversion back gives the same bits (so not -0.0).
bool integer_of(double value, std::int64_t& integer) {
  constexpr double kExact = 9.0e15;  // below 2^53
  if (!(value > -kExact && value < kExact)) return false;
  integer = static_cast<std::int64_t>(value);
  // Compares bits: a comparison of numbers treats a denormal as 0 if the processor flushes denormals.
  return std::bit_cast<std::uint64_t>(static_cast<double>(integer)) == std::bit_cast<std::uint64_t>(value);
}

/// Converts to float; values out of range become infinite (the language leaves this conversion undefined).
float to_float(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  if (value > kMost) return std::numeric_limits<float>::infinity();
  if (value < -kMost) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(value);
}

/// One column of a block: value n is values[first + n * stride].
struct Strided {
  std::span<const double> values;
  std::size_t first, stride, rows;
  double operator[](std::size_t n) const { return values[first + n * stride]; }
};

void put_exact(const Strided& column, std::string& out) {
  std::vector<std::uint64_t> words(column.rows);
  std::uint64_t before = 0;
  bool integers = true;
  for (std::size_t n = 0; n < column.rows && integers; ++n) {
    std::int64_t now = 0;
    integers = integer_of(column[n], now);
    words[n] = zigzag(static_cast<std::uint64_t>(now) - before);
    before = static_cast<std::uint64_t>(now);
  }
  if (!integers) {
    before = 0;
    for (std::size_t n = 0; n < column.rows; ++n) {
      const auto now = std::bit_cast<std::uint64_t>(column[n]);
      words[n] = now ^ before;
      before = now;
    }
  }
  out += static_cast<char>(integers ? Method::integer_difference : Method::bits_xor);
  shuffle(words, out);
}

void put_coarse(const Strided& column, std::size_t every, std::string& out) {
  std::vector<std::uint32_t> words;
  std::uint32_t before = 0;
  for (std::size_t n = 0; n < column.rows; n += every) {
    const auto now = std::bit_cast<std::uint32_t>(to_float(column[n]));
    words.push_back(now ^ before);
    before = now;
  }
  shuffle(words, out);
}

/// Writes column `c` of `rows` rows into `out`. @returns whether its method is known.
bool get_exact(const char* bytes, std::size_t rows, std::size_t c, std::size_t stride, std::vector<double>& out) {
  const auto method = static_cast<Method>(*bytes);
  if (method != Method::bits_xor && method != Method::integer_difference) return false;
  const std::vector<std::uint64_t> words = unshuffle<std::uint64_t>(bytes + 1, rows);
  std::uint64_t now = 0;
  for (std::size_t n = 0; n < rows; ++n) {
    now = method == Method::bits_xor ? now ^ words[n] : now + unzigzag(words[n]);
    out[c + n * stride] = method == Method::bits_xor ? std::bit_cast<double>(now) : static_cast<double>(static_cast<std::int64_t>(now));
  }
  return true;
}

void get_coarse(const char* bytes, std::size_t rows, std::size_t every, std::size_t c, std::size_t stride, std::vector<double>& out) {
  const std::vector<std::uint32_t> words = unshuffle<std::uint32_t>(bytes, (rows - 1) / every + 1);
  std::uint32_t now = 0;
  for (std::size_t n = 0; n < rows; ++n) {
    if (n % every == 0) now ^= words[n / every];
    out[c + n * stride] = static_cast<double>(std::bit_cast<float>(now));
  }
}

Error damaged_block() { return bad_input("a block of rows is damaged"); }

}  // namespace

std::string encode_rows(std::span<const double> values, std::span<const SessionColumn> columns, std::int64_t coarse_every) {
  const std::size_t width = columns.size(), rows = values.size() / width;
  const auto every = static_cast<std::size_t>(coarse_every);
  std::string payload;
  payload.reserve(values.size() * sizeof(double) + width + kPayloadHeader);
  payload.resize(kPayloadHeader);
  put_little_endian(static_cast<std::uint32_t>(every), payload.data());
  put_little_endian(static_cast<std::uint32_t>(rows), payload.data() + 4);
  for (std::size_t c = 0; c < width; ++c) {
    const Strided column{values, c, width, rows};
    if (columns[c].keep == Keep::exact)
      put_exact(column, payload);
    else
      put_coarse(column, every, payload);
  }
  uLongf packed = compressBound(static_cast<uLong>(payload.size()));
  std::string out(kHeaderBytes + packed, '\0');
  out[0] = kBlockFormat;
  put_little_endian(static_cast<std::uint32_t>(every), out.data() + 1);
  // Can fail for lack of memory only: the buffer has the size of compressBound().
  if (compress2(reinterpret_cast<Bytef*>(out.data() + kHeaderBytes), &packed, reinterpret_cast<const Bytef*>(payload.data()),
                static_cast<uLong>(payload.size()), kLevel) != Z_OK)
    throw std::bad_alloc();
  out.resize(kHeaderBytes + packed);
  return out;
}

Result<std::vector<double>> decode_rows(std::string_view bytes, std::span<const SessionColumn> columns, std::int64_t rows) {
  if (bytes.size() <= kHeaderBytes || bytes[0] != kBlockFormat || rows < 1 || columns.empty()) return damaged_block();
  const std::uint64_t every = get_little_endian<std::uint32_t>(bytes.data() + 1), count = static_cast<std::uint64_t>(rows);
  const std::uint64_t packed_size = bytes.size() - kHeaderBytes;
  if (every < 1 || count > kMostPayload / (9 * columns.size())) return damaged_block();
  const auto bytes_of = [&](const SessionColumn& column) {
    return column.keep == Keep::exact ? 1 + sizeof(double) * count : sizeof(float) * ((count - 1) / every + 1);
  };
  std::uint64_t size = kPayloadHeader;
  for (const SessionColumn& column : columns) size += bytes_of(column);
  if (size > kMostExpansion * packed_size) return damaged_block();
  std::string payload(size, '\0');
  uLongf unpacked = size;
  uLong used = packed_size;
  if (uncompress2(reinterpret_cast<Bytef*>(payload.data()), &unpacked, reinterpret_cast<const Bytef*>(bytes.data() + kHeaderBytes),
                  &used) != Z_OK ||
      unpacked != size || used != packed_size || get_little_endian<std::uint32_t>(payload.data()) != every ||
      get_little_endian<std::uint32_t>(payload.data() + 4) != count)
    return damaged_block();
  std::vector<double> out(count * columns.size());
  const char* at = payload.data() + kPayloadHeader;
  for (std::size_t c = 0; c < columns.size(); at += bytes_of(columns[c]), ++c) {
    if (columns[c].keep == Keep::coarse)
      get_coarse(at, count, every, c, columns.size(), out);
    else if (!get_exact(at, count, c, columns.size(), out))
      return damaged_block();
  }
  return out;
}

Result<std::vector<double>> decode_plain_rows(std::string_view bytes, std::size_t columns, std::int64_t rows) {
  // Division instead of multiplication avoids overflow: `rows` may come from a damaged file.
  if (rows < 1 || columns == 0 || bytes.size() % (8 * columns) != 0 || bytes.size() / (8 * columns) != static_cast<std::uint64_t>(rows))
    return bad_input("a block of rows has the wrong size");
  std::vector<double> out(bytes.size() / 8);
  for (std::size_t n = 0; n < out.size(); ++n) out[n] = std::bit_cast<double>(get_little_endian<std::uint64_t>(bytes.data() + 8 * n));
  return out;
}

}  // namespace burrhole
