/// volumes/read/dicom_elements.h: the data elements of one DICOM file up to its pixels, as bytes; every length is checked against the file.
///   Why our own  GDCM as distributions ship it is built with its assertions on: a damaged length ends the process, or is first allocated.
///                Here a file is walked with bounds, so that whatever it says, time and memory follow its size. Codecs stay GDCM's.
///   Source       DICOM PS3.5 sec. 7 (data set), annex A (transfer syntaxes), PS3.10 sec. 7 (file).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "volumes/read/dicom_bytes.h"

namespace burrhole {

/// (group, element) as one number: 0x00200032.
using DicomTag = std::uint32_t;
inline constexpr DicomTag kPixelDataTag = 0x7fe00010;

/// What to keep; implicit files do not say which elements are sequences.
struct WantedTags {
  std::set<DicomTag> values, sequences;
};

struct DicomItem;

struct DicomValue {
  std::array<char, 2> vr{};      ///< "DS", ...; blank in implicit files
  std::string bytes;             ///< as in the file
  std::vector<DicomItem> items;  ///< of a sequence
};

struct DicomItem {
  std::map<DicomTag, DicomValue> values;  ///< the wanted ones alone

  [[nodiscard]] const DicomValue* find(DicomTag tag) const;
};

/// Where the pixels lie.
struct PixelSpan {
  std::uint64_t offset = 0;  ///< [bytes] of DicomBytes, after inflation
  std::uint64_t length = 0;  ///< [bytes] as the element says; up to the end of the file when encapsulated
  std::uint64_t there = 0;   ///< [bytes] of those that the file has
  bool encapsulated = false;
  std::array<char, 2> vr{};
};

struct DicomElements {
  std::string transfer_syntax;  ///< UID
  std::string media_class;      ///< SOP class UID of the file's own header
  bool big_endian = false;
  std::optional<std::uint64_t> deflated_at;  ///< offset in the file at which the deflated data set begins
  DicomItem top;
  std::optional<PixelSpan> pixels;
  std::string fault;  ///< why walking ended early, empty when it did not; what was read until then is kept
};

/// Do a file's first 132 bytes, or as many as it has, look like DICOM? By the magic text behind the preamble of 128 bytes or, without one,
/// by a first element of group 0002 or 0008 as a data set begins with.
[[nodiscard]] bool looks_like_dicom(std::span<const std::byte> head) noexcept;

/// Reads the wanted elements, at the top and inside wanted sequences, and moves past all others unread.
/// @returns nothing when the file is not DICOM. `bytes` is left inflated when the file is deflated.
[[nodiscard]] std::optional<DicomElements> read_elements(DicomBytes& bytes, const WantedTags& wanted);

/// Little- or big-endian number of 2 or 4 bytes. Here, as pixels are read by it one by one.
[[nodiscard]] inline std::uint16_t dicom_u16(const std::byte* at, bool big_endian) noexcept {
  const auto a = std::to_integer<unsigned>(at[0]), b = std::to_integer<unsigned>(at[1]);
  return static_cast<std::uint16_t>(big_endian ? (a << 8) | b : (b << 8) | a);
}
[[nodiscard]] inline std::uint32_t dicom_u32(const std::byte* at, bool big_endian) noexcept {
  const std::uint32_t first = dicom_u16(at, big_endian), second = dicom_u16(at + 2, big_endian);
  return big_endian ? (first << 16) | second : (second << 16) | first;
}

}  // namespace burrhole
