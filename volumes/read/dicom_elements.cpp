#include "volumes/read/dicom_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string_view>

namespace burrhole {
namespace {

constexpr std::uint32_t kUndefined = 0xffffffff;  // length of an element that ends at a delimiter
constexpr DicomTag kItem = 0xfffee000, kItemEnd = 0xfffee00d, kSequenceEnd = 0xfffee0dd;
constexpr DicomTag kTransferSyntax = 0x00020010, kMediaClass = 0x00020002;
constexpr std::size_t kHead = 132;              // [bytes] preamble and magic text
constexpr int kDeepest = 16;                    // nested sequences; real files have up to about six
constexpr std::size_t kMostElements = 5000000;  // 2000 frames with 2500 elements each
constexpr std::size_t kLongestValue = 16384;    // [bytes] kept of one element; longer values are texts or tables that no reader requests

struct Form {
  bool explicit_vr = true;
  bool big_endian = false;
};

struct Head {
  DicomTag tag = 0;
  std::array<char, 2> vr{' ', ' '};
  std::uint32_t length = 0;
  std::uint64_t value_at = 0;
};

bool is_upper(char c) noexcept { return c >= 'A' && c <= 'Z'; }

/// VRs with two reserved bytes and a length of four bytes. PS3.5 table 7.1-1.
bool has_long_length(std::array<char, 2> vr) {
  constexpr std::array<std::string_view, 13> kLong = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"};
  return std::find(kLong.begin(), kLong.end(), std::string_view(vr.data(), 2)) != kLong.end();
}

bool is(std::array<char, 2> vr, std::string_view name) { return std::string_view(vr.data(), 2) == name; }

std::string trimmed(const std::string& bytes) {
  const std::size_t end = bytes.find_last_not_of(std::string_view(" \0", 2));
  return end == std::string::npos ? std::string() : bytes.substr(0, end + 1);
}

class Walker {
 public:
  Walker(DicomBytes& bytes, const WantedTags& wanted) : bytes_(bytes), wanted_(wanted) {}

  /// Reads group 0002, which is always explicit and little-endian. @returns the offset of the data set.
  std::uint64_t walk_meta(std::uint64_t at, DicomElements& out);
  void walk_top(std::uint64_t at, Form form, DicomElements& out);
  [[nodiscard]] const std::string& error() const noexcept { return error_; }

 private:
  bool read_head(std::uint64_t at, std::uint64_t end, Form form, Head& head);
  bool keep_value(const Head& head, DicomValue& value);
  bool step_over(const Head& head, std::uint64_t end, Form form, int depth, DicomItem* item, std::uint64_t& next);
  bool walk_sequence(const Head& head, std::uint64_t end, Form form, int depth, DicomValue* value, std::uint64_t& next);
  bool walk_item(std::uint64_t at, std::uint64_t end, bool delimited, Form form, int depth, DicomItem* item, std::uint64_t& next);
  bool fail(std::string what) {
    if (error_.empty()) error_ = std::move(what);
    return false;
  }

  DicomBytes& bytes_;
  const WantedTags& wanted_;
  std::size_t elements_ = 0;
  std::string error_;
};

bool Walker::read_head(std::uint64_t at, std::uint64_t end, Form form, Head& head) {
  std::array<std::byte, 12> raw{};
  if (++elements_ > kMostElements) return fail(fmt::format("the header has more than {} elements", kMostElements));
  if (end < at || end - at < 8 || !bytes_.read(at, std::span(raw).first(8))) return fail("the header is cut short");
  head.tag = (DicomTag{dicom_u16(raw.data(), form.big_endian)} << 16) | dicom_u16(raw.data() + 2, form.big_endian);
  head.vr = {' ', ' '};
  const bool delimiter = (head.tag >> 16) == 0xfffe;  // items have no VR in any syntax
  if (!form.explicit_vr || delimiter) {
    head.length = dicom_u32(raw.data() + 4, form.big_endian);
    head.value_at = at + 8;
    return true;
  }
  head.vr = {static_cast<char>(raw[4]), static_cast<char>(raw[5])};
  if (!is_upper(head.vr[0]) || !is_upper(head.vr[1])) return fail("the header is damaged: an element has no value type");
  if (!has_long_length(head.vr)) {
    head.length = dicom_u16(raw.data() + 6, form.big_endian);
    head.value_at = at + 8;
    return true;
  }
  if (end - at < 12 || !bytes_.read(at, raw)) return fail("the header is cut short");
  head.length = dicom_u32(raw.data() + 8, form.big_endian);
  head.value_at = at + 12;
  return true;
}

bool Walker::keep_value(const Head& head, DicomValue& value) {
  if (head.length > kLongestValue) return true;
  value.bytes.resize(head.length);
  if (!bytes_.read(head.value_at, std::as_writable_bytes(std::span(value.bytes)))) return fail("the header is cut short");
  return true;
}

/// Skips one element whose head was read; keeps it in `item` if it was requested and there is an item.
bool Walker::step_over(const Head& head, std::uint64_t end, Form form, int depth, DicomItem* item, std::uint64_t& next) {
  const bool wanted = item != nullptr && (wanted_.values.contains(head.tag) || wanted_.sequences.contains(head.tag));
  const bool undefined = head.length == kUndefined;
  if (!undefined && head.length > end - head.value_at)
    return fail(fmt::format("the header is cut short: an element of {} bytes has {}", head.length, end - head.value_at));
  DicomValue value;
  value.vr = head.vr;
  const bool sequence = wanted_.sequences.contains(head.tag) && (!form.explicit_vr || is(head.vr, "SQ"));
  if (undefined || (wanted && sequence)) {
    // An element of unknown type and undefined length contains an implicit sequence. PS3.5 sec. 6.2.2 note 4.
    const Form inside = is(head.vr, "UN") ? Form{false, false} : form;
    if (!walk_sequence(head, end, inside, depth + 1, wanted ? &value : nullptr, next)) return false;
  } else {
    next = head.value_at + head.length;
    if (wanted && !keep_value(head, value)) return false;
  }
  if (wanted) item->values.try_emplace(head.tag, std::move(value));
  return true;
}

bool Walker::walk_sequence(const Head& head, std::uint64_t end, Form form, int depth, DicomValue* value, std::uint64_t& next) {
  if (depth > kDeepest) return fail(fmt::format("the header is damaged: sequences lie {} deep", depth));
  const bool delimited = head.length == kUndefined;
  const std::uint64_t stop = delimited ? end : head.value_at + head.length;
  std::uint64_t at = head.value_at;
  while (delimited || at < stop) {
    Head item;
    if (!read_head(at, stop, form, item)) return false;
    if (delimited && item.tag == kSequenceEnd) {
      next = item.value_at;
      return true;
    }
    if (item.tag != kItem) return fail("the header is damaged: a sequence contains an element that is not an item");
    const bool open = item.length == kUndefined;
    if (!open && item.length > stop - item.value_at) return fail("the header is cut short inside a sequence");
    if (value == nullptr && !open) {
      at = item.value_at + item.length;
      continue;
    }
    if (value != nullptr) value->items.emplace_back();
    DicomItem* inside = value != nullptr ? &value->items.back() : nullptr;
    if (!walk_item(item.value_at, open ? stop : item.value_at + item.length, open, form, depth, inside, at)) return false;
  }
  next = stop;
  return true;
}

bool Walker::walk_item(std::uint64_t at, std::uint64_t end, bool delimited, Form form, int depth, DicomItem* item, std::uint64_t& next) {
  while (delimited || at < end) {
    Head head;
    if (!read_head(at, end, form, head)) return false;
    if (delimited && head.tag == kItemEnd) {
      next = head.value_at;
      return true;
    }
    if (!step_over(head, end, form, depth, item, at)) return false;
  }
  next = end;
  return true;
}

std::uint64_t Walker::walk_meta(std::uint64_t at, DicomElements& out) {
  const Form meta{true, false};
  while (at < bytes_.size()) {
    std::array<std::byte, 2> group{};
    if (!bytes_.read(at, group) || dicom_u16(group.data(), false) != 0x0002) break;
    Head head;
    if (!read_head(at, bytes_.size(), meta, head)) break;
    if (head.length > bytes_.size() - head.value_at) {
      fail("the header is cut short");
      break;
    }
    DicomValue value;
    if ((head.tag == kTransferSyntax || head.tag == kMediaClass) && keep_value(head, value))
      (head.tag == kTransferSyntax ? out.transfer_syntax : out.media_class) = trimmed(value.bytes);
    at = head.value_at + head.length;
  }
  return at;
}

void Walker::walk_top(std::uint64_t at, Form form, DicomElements& out) {
  const std::uint64_t end = bytes_.size();
  while (at < end) {
    Head head;
    if (!read_head(at, end, form, head)) return;
    if (head.tag == kPixelDataTag) {
      const std::uint64_t left = end - head.value_at;
      const bool encapsulated = head.length == kUndefined;
      const std::uint64_t length = encapsulated ? left : head.length;
      out.pixels = PixelSpan{head.value_at, length, std::min(length, left), encapsulated, head.vr};
      return;
    }
    if (!step_over(head, end, form, 0, &out.top, at)) return;
  }
}

bool has_magic(std::span<const std::byte> head) noexcept { return head.size() >= kHead && std::memcmp(head.data() + 128, "DICM", 4) == 0; }

/// VRs with a length of two bytes. PS3.5 table 7.1-2.
bool has_short_length(std::array<char, 2> vr) noexcept {
  constexpr std::array<std::string_view, 21> kShort = {"AE", "AS", "AT", "CS", "DA", "DS", "DT", "FD", "FL", "IS", "LO",
                                                       "LT", "PN", "SH", "SL", "SS", "ST", "TM", "UI", "UL", "US"};
  return std::ranges::find(kShort, std::string_view(vr.data(), 2)) != kShort.end();
}

/// Files without a preamble begin with group 0002 or 0008; the first element of that group decides. A value type is a strong sign; without
/// one, only the elements that such files begin with are.
bool begins_with_data(std::span<const std::byte> raw, Form& form) noexcept {
  if (raw.size() < 8) return false;
  const std::uint16_t group = dicom_u16(raw.data(), false), element = dicom_u16(raw.data() + 2, false);
  const std::array<char, 2> vr{static_cast<char>(raw[4]), static_cast<char>(raw[5])};
  form.explicit_vr = has_short_length(vr) || has_long_length(vr);
  if (group == 0x0008 && form.explicit_vr) return true;
  if ((group != 0x0002 && group != 0x0008) || element > 0x0018) return false;
  return form.explicit_vr || (group == 0x0008 && dicom_u32(raw.data() + 4, false) <= 64);
}

}  // namespace

const DicomValue* DicomItem::find(DicomTag tag) const {
  const auto found = values.find(tag);
  return found == values.end() ? nullptr : &found->second;
}

bool starts_like_dicom(std::span<const std::byte> head) noexcept {
  Form form;
  return has_magic(head) || begins_with_data(head, form);
}

std::optional<DicomElements> read_elements(DicomBytes& bytes, const WantedTags& wanted) {
  std::array<std::byte, kHead> raw{};
  const std::span<std::byte> head = std::span(raw).first(static_cast<std::size_t>(std::min<std::uint64_t>(kHead, bytes.size())));
  if (!bytes.read(0, head)) return std::nullopt;
  Form form;
  const bool magic = has_magic(head);
  if (!magic && !begins_with_data(head, form)) return std::nullopt;
  std::uint64_t at = magic ? kHead : 0;

  DicomElements out;
  Walker walker(bytes, wanted);
  at = walker.walk_meta(at, out);
  if (walker.error().empty()) {
    const std::string& uid = out.transfer_syntax;
    if (!uid.empty()) form = {uid != "1.2.840.10008.1.2", uid == "1.2.840.10008.1.2.2"};
    if (uid == "1.2.840.10008.1.2.1.99") {
      out.deflated_at = at;
      out.error = bytes.inflate_from(at);
      at = 0;
    }
    out.big_endian = form.big_endian;
    walker.walk_top(at, form, out);
  }
  if (out.error.empty()) out.error = walker.error();
  return out;
}

}  // namespace burrhole
