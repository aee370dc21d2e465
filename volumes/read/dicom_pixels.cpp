#include "volumes/read/dicom_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "volumes/read/gdcm_codecs.h"
#include "volumes/read/stream_shape.h"

namespace burrhole {
namespace {

constexpr std::uint32_t kItemHead = 0xe000fffe, kEndHead = 0xe0ddfffe;  // little-endian, as in all compressed files
constexpr std::size_t kMostFragments = 1000000;

template <class Word>
Word load(const std::byte* at, bool big_endian) {
  if constexpr (sizeof(Word) == 1) return std::to_integer<Word>(*at);
  if constexpr (sizeof(Word) == 2) return dicom_u16(at, big_endian);
  if constexpr (sizeof(Word) == 4) return dicom_u32(at, big_endian);
}

/// Extracts the stored bits with sign extension; other bits of the word are overlays. PS3.5 sec. 8.1.1.
template <class Word>
void unpack(std::span<const std::byte> raw, const StoredForm& form, double slope, double intercept, bool hounsfield, std::span<float> out,
            PixelCounts& counts) {
  const int shift = form.high_bit + 1 - form.bits_stored;
  const std::int64_t mask = (std::int64_t{1} << form.bits_stored) - 1;
  const std::int64_t sign = form.is_signed ? std::int64_t{1} << (form.bits_stored - 1) : 0;
  const bool padded = hounsfield && form.padding.has_value();
  const auto [low, high] = form.padding.value_or(std::pair<std::int64_t, std::int64_t>{1, 0});
  const std::size_t swap = form.swapped_bytes ? 1 : 0;
  for (std::size_t n = 0; n < out.size(); ++n) {
    const auto word = std::int64_t{load<Word>(raw.data() + (n ^ swap) * sizeof(Word), form.big_endian)};
    const std::int64_t stored = (((word >> shift) & mask) ^ sign) - sign;
    float value = static_cast<float>(slope * static_cast<double>(stored) + intercept);
    if (padded && stored >= low && stored <= high) {
      value = kAirHounsfield;
      ++counts.padded;
    } else if (hounsfield && value < kAirHounsfield) {
      value = kAirHounsfield;
      ++counts.clamped;
    }
    out[n] = value;
  }
}

/// Decodes one PackBits segment into every `stride`-th byte. @returns the number of bytes. PS3.5 G.3.1.
std::size_t unpack_bits(std::span<const std::byte> in, std::size_t wanted, std::byte* out, std::size_t stride) {
  std::size_t made = 0;
  for (std::size_t at = 0; at + 1 < in.size() && made < wanted;) {
    const auto code = static_cast<std::int8_t>(std::to_integer<std::uint8_t>(in[at++]));
    if (code == -128) continue;
    const bool run = code < 0;
    const auto count = static_cast<std::size_t>(run ? 1 - int{code} : int{code} + 1);
    for (std::size_t n = 0; n < count && made < wanted && at < in.size(); ++n, ++made) {
      out[made * stride] = in[at];
      if (!run) ++at;
    }
    if (run) ++at;
  }
  return made;
}

}  // namespace

void stored_to_float(std::span<const std::byte> raw, const StoredForm& form, double slope, double intercept, bool hounsfield,
                     std::span<float> out, PixelCounts& counts) {
  if (form.bits_allocated == 8) return unpack<std::uint8_t>(raw, form, slope, intercept, hounsfield, out, counts);
  if (form.bits_allocated == 16) return unpack<std::uint16_t>(raw, form, slope, intercept, hounsfield, out, counts);
  unpack<std::uint32_t>(raw, form, slope, intercept, hounsfield, out, counts);
}

std::string decode_rle(std::span<const std::byte> coded, std::size_t pixels, std::size_t bytes_each, std::vector<std::byte>& out) {
  constexpr std::size_t kHeader = 64;
  if (coded.size() < kHeader) return fmt::format("pixels cut short: {} bytes of an RLE frame", coded.size());
  const std::uint32_t segments = dicom_u32(coded.data(), false);
  if (segments != bytes_each) return fmt::format("RLE frame of {} segments for pixels of {} bytes", segments, bytes_each);
  out.resize(pixels * bytes_each);
  for (std::size_t s = 0; s < bytes_each; ++s) {
    const std::size_t begin = dicom_u32(coded.data() + 4 + 4 * s, false);
    const std::size_t end = s + 1 < bytes_each ? dicom_u32(coded.data() + 8 + 4 * s, false) : coded.size();
    if (begin < kHeader || begin > end || end > coded.size())
      return fmt::format("pixels cut short: RLE segment {} lies at {}..{} of {} bytes", s + 1, begin, end, coded.size());
    // The most significant bytes come first.
    const std::size_t made = unpack_bits(coded.subspan(begin, end - begin), pixels, out.data() + (bytes_each - 1 - s), bytes_each);
    if (made < pixels) return fmt::format("pixels cut short: RLE segment {} gives {} of {} bytes", s + 1, made, pixels);
  }
  return {};
}

Result<FrameReader> FrameReader::open(const DicomHeader& header) {
  auto bytes = DicomBytes::open(header.path);
  if (!bytes) return bytes.error();
  if (header.deflated_at)
    if (const std::string error = bytes->inflate_from(*header.deflated_at); !error.empty()) return bad_input(error, header.path);
  FrameReader out(header, std::move(bytes).value());
  if (header.codec != DicomCodec::none)
    if (const std::string error = out.list_fragments(); !error.empty()) return bad_input(error, header.path);
  return Result<FrameReader>(std::move(out));
}

std::string FrameReader::list_fragments() {
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> table;  // offsets of the frames, from the first fragment's item
  std::uint64_t at = header_->pixels.offset, first_item = at;
  for (std::size_t item = 0;; ++item) {
    std::array<std::byte, 8> head{};
    if (!bytes_.read(at, head)) return fmt::format("pixels cut short: the file ends after {} compressed fragments", fragments.size());
    const std::uint32_t tag = dicom_u32(head.data(), false), length = dicom_u32(head.data() + 4, false);
    at += head.size();
    if (tag == kEndHead) break;
    if (tag != kItemHead) return fmt::format("compressed pixels are damaged after {} fragments", fragments.size());
    if (item > kMostFragments) return fmt::format("more than {} compressed fragments", kMostFragments);
    if (length > bytes_.size() - at)
      return fmt::format("pixels cut short: a compressed fragment of {} bytes has {}", length, bytes_.size() - at);
    if (item > 0) {
      fragments.push_back({at, length});
    } else {
      std::vector<std::byte> raw(length);
      if (!bytes_.read(at, raw)) return "pixels cut short: the table of frames is not there";
      for (std::size_t n = 0; n + 4 <= raw.size(); n += 4) table.push_back(dicom_u32(raw.data() + n, false));
      first_item = at + length;
    }
    at += length;
  }
  return share_out(fragments, first_item, table);
}

/// Numbers of the fragments with which the frames begin, by the marker that begins a stream.
std::vector<std::size_t> FrameReader::find_starts(const std::vector<Fragment>& fragments) {
  std::vector<std::size_t> out;
  std::array<std::byte, 8> first{};
  for (std::size_t n = 0; n < fragments.size(); ++n)
    if (fragments[n].length >= first.size() && bytes_.read(fragments[n].offset, first) && starts_stream(header_->codec, first))
      out.push_back(n);
  return out;
}

/// Assigns fragments to frames: a single frame has all; otherwise one each; otherwise by the offset table, or where it is empty by the starts
/// of the streams. PS3.5 A.4.
std::string FrameReader::share_out(const std::vector<Fragment>& fragments, std::uint64_t first_item,
                                   const std::vector<std::uint32_t>& table) {
  const std::size_t frames = header_->frames.size();
  if (fragments.empty()) return "pixels cut short: there is no compressed fragment";
  frames_.resize(frames);
  if (frames == 1) {
    frames_.front() = fragments;
    return {};
  }
  if (fragments.size() == frames) {
    for (std::size_t n = 0; n < frames; ++n) frames_[n] = {fragments[n]};
    return {};
  }
  if (table.empty()) {
    std::vector<std::size_t> starts = find_starts(fragments);
    if (starts.size() != frames || starts.front() != 0)
      return fmt::format("{} compressed fragments for {} frames: there is no offset table, and {} of the fragments begin an image",
                         fragments.size(), frames, starts.size());
    starts.push_back(fragments.size());
    for (std::size_t n = 0; n < frames; ++n)
      frames_[n].assign(fragments.begin() + static_cast<std::ptrdiff_t>(starts[n]),
                        fragments.begin() + static_cast<std::ptrdiff_t>(starts[n + 1]));
    return {};
  }
  if (table.size() != frames || !std::is_sorted(table.begin(), table.end()))
    return fmt::format("{} compressed fragments for {} frames, and the offset table with {} entries does not assign them", fragments.size(),
                       frames, table.size());
  for (const Fragment& f : fragments) {
    const std::uint64_t from_first = f.offset - 8 - first_item;
    const auto after = std::upper_bound(table.begin(), table.end(), from_first);
    if (after != table.begin()) frames_[static_cast<std::size_t>(after - table.begin()) - 1].push_back(f);
  }
  return {};
}

/// Reads the pixels of one frame into raw_ and sets `form` to their format: a codec may return other words than the file states.
std::string FrameReader::read_stored(std::size_t frame, StoredForm& form) {
  const std::size_t pixels = static_cast<std::size_t>(header_->columns) * static_cast<std::size_t>(header_->rows);
  form = header_->stored;
  if (header_->codec == DicomCodec::none) {
    raw_.resize(pixels * form.bytes());
    if (bytes_.read(header_->pixels.offset + frame * raw_.size(), raw_)) return {};
    return fmt::format("pixels cut short: frame {} is not there", frame + 1);
  }
  std::uint64_t length = 0;
  for (const Fragment& f : frames_[frame]) length += f.length;
  if (length > std::numeric_limits<std::int32_t>::max()) return fmt::format("a compressed frame of {} bytes is not read", length);
  coded_.resize(length);
  std::size_t at = 0;
  for (const Fragment& f : frames_[frame]) {
    if (!bytes_.read(f.offset, std::span(coded_).subspan(at, f.length))) return "pixels cut short while reading";
    at += f.length;
  }
  if (header_->codec == DicomCodec::rle) return decode_rle(coded_, pixels, form.bytes(), raw_);
  return decode(form);
}

std::string FrameReader::decode(StoredForm& form) {
  const DicomCodec codec = header_->codec;
  const std::span<const std::byte> stream = without_padding(coded_);
  if (!stream_is_whole(codec, stream)) return fmt::format("pixels cut short: the compressed image of {} bytes does not end", coded_.size());
  const auto shape = stream_shape(codec, stream);
  if (!shape) return fmt::format("the compressed image of {} bytes has no usable header", coded_.size());
  if (shape->columns != header_->columns || shape->rows != header_->rows || shape->components != 1)
    return fmt::format("the compressed image has {} x {} pixels of {} colours, the file states {} x {} of 1", shape->columns, shape->rows,
                       shape->components, header_->columns, header_->rows);
  if (shape->bits < 2 || shape->bits > form.bits_allocated || (form.is_signed && shape->bits < form.bits_stored))
    return fmt::format("the compressed image has {} bits, the file states {}", shape->bits, form.bits_stored);
  if (!decode_stream(codec, stream, *shape, raw_))
    return fmt::format("pixels cut short or damaged: {} compressed bytes do not give {} x {} pixels", coded_.size(), shape->columns,
                       shape->rows);
  const int words = static_cast<int>(8 * shape->bytes());
  if (words != form.bits_allocated) {
    form.bits_allocated = words;
    form.bits_stored = std::min(form.bits_stored, words);
    form.high_bit = form.bits_stored - 1;
  }
  return {};
}

Status FrameReader::read(std::size_t frame, bool hounsfield, std::span<float> out, PixelCounts& counts) {
  if (out.size() != static_cast<std::size_t>(header_->columns) * static_cast<std::size_t>(header_->rows))
    return bad_input(fmt::format("the image has {} x {} pixels, the series {}", header_->columns, header_->rows, out.size()),
                     header_->path);
  StoredForm form;
  if (const std::string error = read_stored(frame, form); !error.empty()) return bad_input(error, header_->path);
  const DicomFrame& f = header_->frames[frame];
  stored_to_float(raw_, form, f.slope, f.intercept, hounsfield, out, counts);
  return {};
}

}  // namespace burrhole
