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

#include "core/config/toml.h"
#include "core/config/toml_messages.h"
#include "volumes/read/jpeg_scan.h"

namespace burrhole {
namespace {

/// GDCM writes warnings to stderr by default, for the whole process.
void silence_gdcm() {
  static const bool silent = [] {
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    return true;
  }();
  static_cast<void>(silent);
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
  const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;  // owned by the pointer, as GDCM requires
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

/// Decodes through a stream: the codec's Decode() leaks its copy of every stream that it rejects (3.0.21).
class JpegLsCodec : public gdcm::JPEGLSCodec {
 public:
  bool decode_all(std::span<const std::byte> stream, const StreamShape& shape, std::vector<std::byte>& out) {
    const auto length = static_cast<std::uint32_t>(stream.size());
    std::string pieces("\xfe\xff\x00\xe0\0\0\0\0\xfe\xff\x00\xe0", 12);  // an empty offset table, then the only fragment
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

bool decode_stream(DicomCodec codec, std::span<const std::byte> stream, const StreamShape& shape, std::vector<std::byte>& out) {
  silence_gdcm();
  const auto allocated = static_cast<unsigned short>(8 * shape.bytes());
  try {
    if (codec == DicomCodec::jpeg) {
      // GDCM selects its 8-, 12- or 16-bit library by these bits. With 16 for a 12-bit stream, it tries the wrong library first and prints
      // a warning.
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
  return bad_input(fmt::format("'{}' is not a DICOM keyword{}", one_line(keyword), nearest ? "; did you mean " + *nearest + "?" : ""));
}

}  // namespace burrhole
