/// volumes/read/dicom_elements.h: the data elements of one DICOM file up to its pixels, as bytes. Every length is checked against the file.
///   Reason  The packaged GDCM is built with assertions. On a damaged length, an assertion ends the process, or GDCM allocates memory of
///           that length before it reads. This reader checks each length first, so time and memory are at most proportional to the size of
///           the file, after inflation, for any content. Compressed pixels are decoded by GDCM.
///   Errors  DicomElements::error.   Source  DICOM PS3.5 sec. 7 (data set), annex A (transfer syntaxes), PS3.10 sec. 7 (file).
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

/// Elements to keep. With implicit VR (value representation) a file does not state the type of an element, so a requested sequence must be
/// listed in `sequences`.
struct WantedTags {
  std::set<DicomTag> values, sequences;
};

struct DicomItem;

struct DicomValue {
  std::array<char, 2> vr{};      ///< value representation: "DS", ...; two blanks with implicit VR
  std::string bytes;             ///< value as in the file, with padding; empty for sequences and for values of more than 16384 bytes
  std::vector<DicomItem> items;  ///< of a sequence; empty for values
};

struct DicomItem {
  std::map<DicomTag, DicomValue> values;  ///< the requested elements only

  [[nodiscard]] const DicomValue* find(DicomTag tag) const;
};

/// Location of the pixels.
struct PixelSpan {
  std::uint64_t offset = 0;   ///< [bytes] of the first one, from the start of DicomBytes, after inflation
  std::uint64_t length = 0;   ///< [bytes] stated by the element; up to the end of the file if encapsulated
  std::uint64_t there = 0;    ///< [bytes] of `length` that the file contains
  bool encapsulated = false;  ///< true: the pixels are compressed, in fragments
  std::array<char, 2> vr{};   ///< of the element, as DicomValue::vr
};

struct DicomElements {
  std::string transfer_syntax;  ///< UID; empty if the file has no header
  std::string media_class;      ///< SOP class UID in the header of the file
  bool big_endian = false;
  std::optional<std::uint64_t> deflated_at;  ///< [bytes] offset in the file at which the deflated data set begins
  DicomItem top;                             ///< elements of the data set that are not inside a sequence
  std::optional<PixelSpan> pixels;           ///< absent if the file has no pixels, or if an error ended the reading before them
  std::string error;                         ///< reason of an early end, empty if none; elements read before are kept
};

/// @returns whether the first 132 bytes of a file (or all, if it is shorter) are DICOM: by the magic text after the preamble of 128
/// bytes or, without a preamble, by a first element of group 0002 or 0008.
[[nodiscard]] bool starts_like_dicom(std::span<const std::byte> head) noexcept;

/// Reads the requested elements, at the top and inside requested sequences, up to the pixels, and skips all others.
/// @returns nothing if the file is not DICOM. If the data set is deflated, `bytes` contains the inflated data set afterwards.
[[nodiscard]] std::optional<DicomElements> read_elements(DicomBytes& bytes, const WantedTags& wanted);

/// @returns a little- or big-endian number of 2 or 4 bytes. Inline: pixels are read by it one by one.
[[nodiscard]] inline std::uint16_t dicom_u16(const std::byte* at, bool big_endian) noexcept {
  const auto a = std::to_integer<unsigned>(at[0]), b = std::to_integer<unsigned>(at[1]);
  return static_cast<std::uint16_t>(big_endian ? (a << 8) | b : (b << 8) | a);
}
[[nodiscard]] inline std::uint32_t dicom_u32(const std::byte* at, bool big_endian) noexcept {
  const std::uint32_t first = dicom_u16(at, big_endian), second = dicom_u16(at + 2, big_endian);
  return big_endian ? (first << 16) | second : (second << 16) | first;
}

}  // namespace burrhole
