#include "tests/support/dicom_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace burrhole::test {
namespace {

std::string number_bytes(std::uint32_t value, int count, bool big_endian) {
  std::string out;
  for (int n = 0; n < count; ++n) out += static_cast<char>((value >> (8 * n)) & 0xff);
  if (big_endian) std::reverse(out.begin(), out.end());
  return out;
}

std::string tag_bytes(std::uint32_t tag, bool big_endian) {
  return number_bytes(tag >> 16, 2, big_endian) + number_bytes(tag & 0xffff, 2, big_endian);
}

std::string element_head(std::uint32_t tag, const std::string& vr, std::uint32_t length, bool is_explicit, bool big_endian) {
  const std::string head = tag_bytes(tag, big_endian);
  if (!is_explicit) return head + number_bytes(length, 4, big_endian);
  if (vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN" || vr == "UT")
    return head + vr + std::string(2, '\0') + number_bytes(length, 4, big_endian);
  return head + vr + number_bytes(length, 2, big_endian);
}

std::string item_bytes(std::uint32_t tag, const std::string& content, bool big_endian) {
  return tag_bytes(tag, big_endian) + number_bytes(static_cast<std::uint32_t>(content.size()), 4, big_endian) + content;
}

std::string even(std::string value, char fill) {
  if (value.size() % 2 != 0) value += fill;
  return value;
}

}  // namespace

DicomData& DicomData::pixels(const char* vr, int word_bytes, const std::string& little_endian) {
  return put(0x7fe00010, vr, Words{word_bytes, little_endian});
}
DicomData& DicomData::pieces(const std::vector<std::string>& fragments) { return put(0x7fe00010, "OB", Pieces{fragments}); }

DicomData& DicomData::erase(std::uint32_t tag) {
  elements_.erase(tag);
  return *this;
}

std::string DicomData::value_bytes(const Element& element, bool is_explicit, bool big_endian) {
  std::string out;
  if (const auto* text = std::get_if<std::string>(&element.value)) return even(*text, element.vr == "UI" ? '\0' : ' ');
  if (const auto* numbers = std::get_if<std::vector<std::uint16_t>>(&element.value))
    for (const std::uint16_t n : *numbers) out += number_bytes(n, 2, big_endian);
  if (const auto* items = std::get_if<std::vector<DicomData>>(&element.value))
    for (const DicomData& item : *items) out += item_bytes(0xfffee000, item.bytes(is_explicit, big_endian), big_endian);
  if (const auto* words = std::get_if<Words>(&element.value)) {
    out = words->little_endian;
    if (big_endian)
      for (std::size_t n = 0; n + words->bytes <= out.size(); n += words->bytes)
        std::reverse(out.begin() + n, out.begin() + n + words->bytes);
    out = even(out, '\0');
  }
  if (const auto* pieces = std::get_if<Pieces>(&element.value)) {
    out = item_bytes(0xfffee000, "", false);
    for (const std::string& piece : pieces->fragments) out += item_bytes(0xfffee000, even(piece, '\0'), false);
    out += item_bytes(0xfffee0dd, "", false);
  }
  return out;
}

std::string DicomData::bytes(bool is_explicit, bool big_endian) const {
  std::string out;
  for (const auto& [tag, element] : elements_) {
    const std::string value = value_bytes(element, is_explicit, big_endian);
    const bool pieces = std::holds_alternative<Pieces>(element.value);
    const std::uint32_t length = pieces ? 0xffffffffu : static_cast<std::uint32_t>(value.size());
    out += element_head(tag, element.vr, length, is_explicit, big_endian) + value;
  }
  return out;
}

std::string DicomData::file(const std::string& transfer_syntax) const {
  DicomData meta;
  meta.text(0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.2").text(0x00020010, "UI", transfer_syntax);
  return std::string(128, '\0') + "DICM" + meta.bytes(true, false) +
         bytes(transfer_syntax != kImplicitLittle, transfer_syntax == kExplicitBig);
}

void DicomData::write(const std::string& path, const std::string& transfer_syntax) const { write_bytes(path, file(transfer_syntax)); }

std::string decimals(const std::vector<double>& values) {
  std::string out;
  for (const double v : values) out += (out.empty() ? "" : "\\") + fmt::format("{}", v);
  return out;
}

std::string words16(const std::vector<int>& values) {
  std::string out;
  for (const int v : values) out += number_bytes(static_cast<std::uint32_t>(v), 2, false);
  return out;
}

DicomData ct_slice(const CtSlice& s) {
  std::vector<int> stored;
  for (int j = 0; j < s.rows; ++j)
    for (int i = 0; i < s.columns; ++i) stored.push_back(s.stored(i, j));
  DicomData out;
  out.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\AXIAL").text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
  out.text(0x00080018, "UI", s.instance).text(0x00080060, "CS", "CT").text(0x00180050, "DS", decimals({s.thickness}));
  out.text(0x0020000e, "UI", s.series).text(0x00200011, "IS", fmt::format("{}", s.number));
  out.text(0x00200032, "DS", decimals({s.position.x, s.position.y, s.position.z}));
  out.text(0x00200037, "DS", decimals({s.row.x, s.row.y, s.row.z, s.column.x, s.column.y, s.column.z}));
  out.numbers(0x00280002, "US", {1}).text(0x00280004, "CS", "MONOCHROME2");
  out.numbers(0x00280010, "US", {static_cast<std::uint16_t>(s.rows)}).numbers(0x00280011, "US", {static_cast<std::uint16_t>(s.columns)});
  out.text(0x00280030, "DS", decimals({s.row_spacing, s.column_spacing}));
  out.numbers(0x00280100, "US", {16}).numbers(0x00280101, "US", {16}).numbers(0x00280102, "US", {15}).numbers(0x00280103, "US", {1});
  out.text(0x00281052, "DS", "-1024").text(0x00281053, "DS", "1");
  return out.pixels("OW", 2, words16(stored));
}

DicomData ct_frames(const CtSlice& slice, const std::vector<double>& heights) {
  std::vector<DicomData> frames;
  for (std::size_t n = 0; n < heights.size(); ++n) {
    DicomData position, values, frame;
    position.text(0x00200032, "DS", decimals({-10, -20, heights[n]}));
    values.text(0x00281052, "DS", decimals({static_cast<double>(n)})).text(0x00281053, "DS", "1").text(0x00281054, "LO", "HU");
    frames.push_back(frame.items(0x00209113, {position}).items(0x00289145, {values}));
  }
  DicomData orientation, measures, shared;
  orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
  measures.text(0x00280030, "DS", "0.75\\0.5").text(0x00180050, "DS", "2");
  shared.items(0x00209116, {orientation}).items(0x00289110, {measures});
  DicomData data = ct_slice(slice);
  for (const std::uint32_t tag : {0x00200032u, 0x00200037u, 0x00280030u, 0x00281052u, 0x00281053u}) data.erase(tag);
  return data.text(0x00280008, "IS", std::to_string(heights.size())).items(0x52009229, {shared}).items(0x52009230, frames);
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) std::abort();
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace burrhole::test
