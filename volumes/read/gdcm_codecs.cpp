#include "volumes/read/gdcm_codecs.h"

#include <fmt/format.h>
#include <gdcmDict.h>
#include <gdcmDicts.h>
#include <gdcmGlobal.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmJPEGCodec.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <sstream>
#include <string>
#include <string_view>

#include "core/base/toml.h"
#include "core/base/toml_messages.h"
#include "volumes/read/jpeg_scan.h"

namespace burrhole {
namespace {

constexpr std::size_t kLongestBox = 512;  // [bytes] JP2 boxes that some writers put before the JPEG 2000 codestream

/// GDCM writes warnings to stderr unless told otherwise, for the whole process.
void silence_gdcm() {
  static const bool silent = [] {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    return true;
  }();
  static_cast<void>(silent);
}

unsigned byte_at(std::span<const std::byte> s, std::size_t at) { return std::to_integer<unsigned>(s[at]); }
unsigned word_at(std::span<const std::byte> s, std::size_t at) { return dicom_u16(s.data() + at, true); }

/// Bytes without the padding after the end: DICOM asks for an even length, some writers for more.
std::span<const std::byte> without_padding(std::span<const std::byte> s) {
  while (!s.empty() && s.back() == std::byte{0}) s = s.first(s.size() - 1);
  return s;
}

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

/// Entropy-coded bytes hold no marker but restarts. T.81 B.1.1.5.
bool scan_is_plain(std::span<const std::byte> scan) {
  for (std::size_t n = 0; n < scan.size(); ++n) {
    if (scan[n] != std::byte{0xff}) continue;
    const unsigned next = n + 1 < scan.size() ? byte_at(scan, n + 1) : 0xff;
    if (next != 0x00 && (next < 0xd0 || next > 0xd7)) return false;
    ++n;
  }
  return true;
}

/// The same image of one scan without comments and application segments, which decoders warn about; GDCM answers a warning about the header
/// by ending the process. @returns nothing for a stream that is anything but tables, one frame header and one scan.
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
  // No offset and no subsampling, as DICOM writers make them.
  const bool plain = size(16) == 0 && size(20) == 0 && std::to_integer<int>(siz[43]) == 1 && std::to_integer<int>(siz[44]) == 1;
  if (!sized || !plain) return std::nullopt;
  return StreamShape{.columns = static_cast<int>(columns),
                     .rows = static_cast<int>(rows),
                     .components = static_cast<int>(dicom_u16(siz + 40, true)),
                     .bits = (std::to_integer<int>(siz[42]) & 0x7f) + 1};
}

bool ends_with(std::span<const std::byte> s) { return s.size() >= 2 && word_at(s, s.size() - 2) == 0xffd9; }

/// Tile parts follow each other by their own lengths and end at EOC. T.800 A.4.2; a length of 0 means the rest.
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

void set_up(gdcm::ImageCodec& codec, const StreamShape& shape, unsigned short allocated) {
  const auto bits = static_cast<unsigned short>(shape.bits);
  const std::array<unsigned, 3> dims = {static_cast<unsigned>(shape.columns), static_cast<unsigned>(shape.rows), 1};
  codec.SetNumberOfDimensions(2);
  codec.SetDimensions(dims.data());
  codec.SetPlanarConfiguration(0);
  codec.SetPhotometricInterpretation(gdcm::PhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2));
  codec.SetPixelFormat(gdcm::PixelFormat(1, allocated, bits, static_cast<unsigned short>(bits - 1), 0));
}

std::size_t decoded_bytes(const StreamShape& shape) {
  return static_cast<std::size_t>(shape.columns) * static_cast<std::size_t>(shape.rows) * shape.bytes();
}

bool decode(gdcm::ImageCodec& codec, std::span<const std::byte> stream, const StreamShape& shape, std::vector<std::byte>& out) {
  gdcm::Fragment fragment;
  fragment.SetByteValue(reinterpret_cast<const char*>(stream.data()), gdcm::VL(static_cast<std::uint32_t>(stream.size())));
  const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;  // owned by the pointer, GDCM's own kind
  fragments->AddFragment(fragment);
  gdcm::DataElement in(gdcm::Tag(0x7fe0, 0x0010)), decoded;
  in.SetVR(gdcm::VR::OB);
  in.SetValue(*fragments);
  if (!codec.Decode(in, decoded)) return false;
  const gdcm::ByteValue* value = decoded.GetByteValue();
  if (value == nullptr || value->GetLength() != decoded_bytes(shape)) return false;
  out.resize(decoded_bytes(shape));
  std::memcpy(out.data(), value->GetPointer(), out.size());
  return true;
}

/// The way in by a stream: the codec's Decode() leaks its copy of every stream that it refuses (3.0.21).
class JpegLsCodec : public gdcm::JPEGLSCodec {
 public:
  bool decode_all(std::span<const std::byte> stream, const StreamShape& shape, std::vector<std::byte>& out) {
    const auto length = static_cast<std::uint32_t>(stream.size());
    std::string pieces("\xfe\xff\x00\xe0\0\0\0\0\xfe\xff\x00\xe0", 12);  // an empty table of offsets, then the one piece
    for (int n = 0; n < 4; ++n) pieces += static_cast<char>((length >> (8 * n)) & 0xff);
    pieces.append(reinterpret_cast<const char*>(stream.data()), stream.size());
    pieces.append("\xfe\xff\xdd\xe0\0\0\0\0", 8);
    std::istringstream in(pieces);
    out.resize(decoded_bytes(shape));
    return DecodeExtent(reinterpret_cast<char*>(out.data()), 0, static_cast<unsigned>(shape.columns) - 1, 0,
                        static_cast<unsigned>(shape.rows) - 1, 0, 0, in);
  }
};

bool is_text(const gdcm::VR& vr) {
  constexpr std::array kTexts = {gdcm::VR::AE, gdcm::VR::AS, gdcm::VR::CS, gdcm::VR::DA, gdcm::VR::DS, gdcm::VR::DT,
                                 gdcm::VR::IS, gdcm::VR::LO, gdcm::VR::LT, gdcm::VR::PN, gdcm::VR::SH, gdcm::VR::ST,
                                 gdcm::VR::TM, gdcm::VR::UI, gdcm::VR::UT, gdcm::VR::US, gdcm::VR::SS};
  return std::find(kTexts.begin(), kTexts.end(), static_cast<gdcm::VR::VRType>(vr)) != kTexts.end();
}

}  // namespace

std::optional<StreamShape> stream_shape(DicomCodec codec, std::span<const std::byte> stream) {
  return codec == DicomCodec::jpeg_2000 ? jpeg_2000_shape(stream) : jpeg_shape(codec, stream);
}

bool stream_is_whole(DicomCodec codec, std::span<const std::byte> stream) {
  const auto bare = without_padding(stream);
  return ends_with(bare) && (codec != DicomCodec::jpeg_2000 || tile_parts_whole(bare));
}

bool decode_stream(DicomCodec codec, std::span<const std::byte> stream, const StreamShape& shape, std::vector<std::byte>& out) {
  silence_gdcm();
  const auto allocated = static_cast<unsigned short>(8 * shape.bytes());
  try {
    if (codec == DicomCodec::jpeg) {
      // GDCM picks its 8-, 12- or 16-bit library by these bits; given 16 for a 12-bit stream, the wrong library is tried first and says so.
      const std::vector<std::byte> plain = plain_jpeg(stream);
      gdcm::JPEGCodec jpeg;
      set_up(jpeg, shape, shape.bits > 8 && shape.bits <= 12 ? 12 : allocated);
      return jpeg_scan_is_whole(plain) && decode(jpeg, plain, shape, out);
    }
    if (codec == DicomCodec::jpeg_ls) {
      JpegLsCodec jpeg_ls;
      set_up(jpeg_ls, shape, allocated);
      return jpeg_ls.decode_all(stream, shape, out);
    }
    gdcm::JPEG2000Codec jpeg_2000;
    set_up(jpeg_2000, shape, allocated);
    return decode(jpeg_2000, stream, shape, out);
  } catch (const std::exception&) {
    return false;
  }
}

Result<DicomKeepTag> find_keyword(const std::string& keyword) {
  silence_gdcm();
  const gdcm::Dict& dictionary = gdcm::Global::GetInstance().GetDicts().GetPublicDict();
  std::vector<std::string> known;
  for (auto entry = dictionary.Begin(); entry != dictionary.End(); ++entry) {
    const char* name = entry->second.GetKeyword();
    if (name == nullptr || *name == '\0') continue;
    if (keyword != name) {
      known.emplace_back(name);
      continue;
    }
    const gdcm::VR vr = entry->second.GetVR();
    if (!is_text(vr)) return bad_input(fmt::format("DICOM field {} holds no text that could be kept", keyword));
    return DicomKeepTag{keyword, (DicomTag{entry->first.GetGroup()} << 16) | entry->first.GetElement(), gdcm::VR::GetVRString(vr)};
  }
  const auto nearest = nearest_name(keyword, known);
  return bad_input(fmt::format("'{}' is no DICOM keyword{}", one_line(keyword), nearest ? "; did you mean " + *nearest + "?" : ""));
}

}  // namespace burrhole
