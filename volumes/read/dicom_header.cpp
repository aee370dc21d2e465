#include "volumes/read/dicom_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/config/toml_messages.h"
#include "volumes/read/scan.h"

namespace burrhole {
namespace {

// Tags by their keywords in PS3.6.
constexpr DicomTag kImageType = 0x00080008, kSopClassUid = 0x00080016, kSopInstanceUid = 0x00080018, kModality = 0x00080060;
constexpr DicomTag kSliceThickness = 0x00180050, kSeriesInstanceUid = 0x0020000e, kSeriesNumber = 0x00200011,
                   kAcquisitionNumber = 0x00200012, kInstanceNumber = 0x00200013;
constexpr DicomTag kImagePosition = 0x00200032, kImageOrientation = 0x00200037;
constexpr DicomTag kSamplesPerPixel = 0x00280002, kPhotometric = 0x00280004, kNumberOfFrames = 0x00280008, kRows = 0x00280010,
                   kColumns = 0x00280011, kPixelSpacing = 0x00280030, kBitsAllocated = 0x00280100, kBitsStored = 0x00280101,
                   kHighBit = 0x00280102, kPixelRepresentation = 0x00280103, kPixelPadding = 0x00280120, kPixelPaddingLimit = 0x00280121,
                   kIntercept = 0x00281052, kSlope = 0x00281053, kRescaleType = 0x00281054, kLossy = 0x00282110;
constexpr DicomTag kPlanePosition = 0x00209113, kPlaneOrientation = 0x00209116, kPixelMeasures = 0x00289110, kPixelValues = 0x00289145,
                   kSharedGroups = 0x52009229, kPerFrameGroups = 0x52009230;

constexpr std::string_view kDicomDirectory = "1.2.840.10008.1.3.10", kSecondaryCapture = "1.2.840.10008.5.1.4.1.1.7";
// Largest accepted compression ratio: a 512 x 512 slice that contains only air has about 200 in JPEG 2000.
constexpr double kMostExpansion = 1000.0;

/// Text of a value without its padding.
std::string text(const DicomItem& item, DicomTag tag) {
  const DicomValue* value = item.find(tag);
  if (value == nullptr) return {};
  const std::string_view padding(" \0", 2);
  const std::size_t begin = value->bytes.find_first_not_of(padding);
  if (begin == std::string::npos) return {};
  return value->bytes.substr(begin, value->bytes.find_last_not_of(padding) - begin + 1);
}

std::vector<std::string> parts(const std::string& whole) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at <= whole.size();) {
    const std::size_t end = std::min(whole.find('\\', at), whole.size());
    out.push_back(whole.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

std::optional<double> number(std::string word) {
  std::erase(word, ' ');
  if (!word.empty() && word.front() == '+') word.erase(0, 1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (word.empty() || code != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// `count` decimal numbers, or nothing if there are fewer or one of them is invalid.
std::optional<std::vector<double>> numbers(const DicomItem& item, DicomTag tag, std::size_t count) {
  const std::vector<std::string> words = parts(text(item, tag));
  if (words.size() < count) return std::nullopt;
  std::vector<double> out;
  for (std::size_t n = 0; n < count; ++n) {
    const auto value = number(words[n]);
    if (!value) return std::nullopt;
    out.push_back(*value);
  }
  return out;
}

double number_or(const DicomItem& item, DicomTag tag, double otherwise) {
  const auto value = numbers(item, tag, 1);
  return value ? value->front() : otherwise;
}

std::optional<int> u16(const DicomItem& item, DicomTag tag, bool big_endian) {
  const DicomValue* value = item.find(tag);
  if (value == nullptr || value->bytes.size() < 2) return std::nullopt;
  return dicom_u16(reinterpret_cast<const std::byte*>(value->bytes.data()), big_endian);
}

bool holds(const std::vector<std::string>& words, std::string_view word) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& w) { return w.find(word) != std::string::npos; });
}

/// Only codes are copied to reports: a name that was written into a code field must not appear there.
std::string code_or_dash(const std::string& word, bool digits) {
  const auto fits = [&](char c) { return digits ? c >= '0' && c <= '9' : c >= 'A' && c <= 'Z'; };
  const bool good = !word.empty() && word.size() <= (digits ? 12u : 4u) && std::all_of(word.begin(), word.end(), fits);
  return good ? word : "-";
}

/// Whether the transfer syntax is supported, and its codec. PS3.5 annex A, PS3.6 table A-1.
std::optional<DicomCodec> codec_of(const std::string& uid) {
  if (uid.empty()) return DicomCodec::none;
  constexpr std::string_view kRoot = "1.2.840.10008.1.2";
  if (uid.rfind(kRoot, 0) != 0) return std::nullopt;
  const std::string_view end = std::string_view(uid).substr(kRoot.size());
  if (end.empty() || end == ".1" || end == ".2" || end == ".1.99") return DicomCodec::none;
  if (end == ".5") return DicomCodec::rle;
  if (end == ".4.50" || end == ".4.51" || end == ".4.57" || end == ".4.70") return DicomCodec::jpeg;
  if (end == ".4.80" || end == ".4.81") return DicomCodec::jpeg_ls;
  if (end == ".4.90" || end == ".4.91") return DicomCodec::jpeg_2000;
  return std::nullopt;
}

std::string skip_reason(const DicomElements& file) {
  const DicomItem& top = file.top;
  const std::string sop = text(top, kSopClassUid);
  if (file.media_class == kDicomDirectory || sop == kDicomDirectory) return "DICOMDIR";
  if (!file.error.empty() && text(top, kSeriesInstanceUid).empty()) return "broken DICOM";
  const std::vector<std::string> type = parts(text(top, kImageType));
  if (sop.rfind(kSecondaryCapture, 0) == 0 || holds(type, "SCREEN")) return "screen capture";
  if (holds(type, "LOCALIZER")) return "localizer";
  if (!file.error.empty()) return {};
  if (!file.pixels || top.find(kRows) == nullptr || top.find(kColumns) == nullptr) return "no image";
  const std::string photometric = text(top, kPhotometric);
  if (u16(top, kSamplesPerPixel, file.big_endian).value_or(1) != 1 || (!photometric.empty() && photometric.rfind("MONOCHROME", 0) != 0))
    return "colour picture";
  return {};
}

/// The first item of a sequence.
const DicomItem* inside(const DicomItem* item, DicomTag sequence) {
  const DicomValue* value = item != nullptr ? item->find(sequence) : nullptr;
  return value != nullptr && !value->items.empty() ? &value->items.front() : nullptr;
}

/// Location of a frame's values: its own functional groups, the shared groups, or the top level of a plain file.
struct FrameScope {
  const DicomItem *own = nullptr, *shared = nullptr, *top = nullptr;

  [[nodiscard]] const DicomItem& holder(DicomTag sequence, DicomTag tag) const {
    static const DicomItem nowhere;
    for (const DicomItem* groups : {own, shared})
      if (const DicomItem* item = inside(groups, sequence); item != nullptr && item->find(tag) != nullptr) return *item;
    return top != nullptr ? *top : nowhere;
  }
};

/// Slope and intercept, which belong together: of the frame, of all frames, or of the file. Invalid numbers give NaN, an error later.
void read_rescale(const FrameScope& scope, const DicomItem& file_top, DicomFrame& frame) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const DicomItem* holder = &scope.holder(kPixelValues, kSlope);
  if (holder->find(kSlope) == nullptr) holder = &scope.holder(kPixelValues, kIntercept);
  if (holder->find(kSlope) == nullptr && holder->find(kIntercept) == nullptr) holder = &file_top;
  if (holder->find(kSlope) != nullptr) frame.slope = number_or(*holder, kSlope, kNone);
  if (holder->find(kIntercept) != nullptr) frame.intercept = number_or(*holder, kIntercept, kNone);
  frame.has_rescale = holder->find(kSlope) != nullptr && holder->find(kIntercept) != nullptr;
}

DicomFrame read_frame(const FrameScope& scope, const DicomItem& file_top, int columns, int rows) {
  DicomFrame frame;
  read_rescale(scope, file_top, frame);
  frame.thickness_mm = number_or(scope.holder(kPixelMeasures, kSliceThickness), kSliceThickness, 0.0);
  const auto position = numbers(scope.holder(kPlanePosition, kImagePosition), kImagePosition, 3);
  const auto turn = numbers(scope.holder(kPlaneOrientation, kImageOrientation), kImageOrientation, 6);
  const auto spacing = numbers(scope.holder(kPixelMeasures, kPixelSpacing), kPixelSpacing, 2);
  if (!position || !turn || !spacing) return frame;
  frame.plane = SlicePlane{.position = Vec3((*position)[0], (*position)[1], (*position)[2]),
                           .row = Vec3((*turn)[0], (*turn)[1], (*turn)[2]),
                           .column = Vec3((*turn)[3], (*turn)[4], (*turn)[5]),
                           .column_spacing = (*spacing)[1],
                           .row_spacing = (*spacing)[0],
                           .columns = columns,
                           .rows = rows};
  return frame;
}

/// Fills frames. @returns the error of a multi-frame file with incomplete information.
std::string read_frames(const DicomItem& top, DicomHeader& out) {
  const double claimed = number_or(top, kNumberOfFrames, 1.0);
  const DicomValue* per_frame = top.find(kPerFrameGroups);
  const std::size_t described = per_frame != nullptr ? per_frame->items.size() : 0;
  if (claimed < 1.0 || claimed != std::floor(claimed)) return fmt::format("the number of frames is {:.6g}", claimed);
  if (described == 0) {
    if (claimed > 1.0) return fmt::format("multi-frame image that is not a volume: {:.0f} frames without positions of their own", claimed);
    out.frames = {read_frame({.own = nullptr, .shared = inside(&top, kSharedGroups), .top = &top}, top, out.columns, out.rows)};
    return {};
  }
  if (claimed != static_cast<double>(described))
    return fmt::format("multi-frame image that is not a volume: {:.0f} frames, {} of them described", claimed, described);
  for (const DicomItem& own : per_frame->items)
    out.frames.push_back(read_frame({.own = &own, .shared = inside(&top, kSharedGroups), .top = nullptr}, top, out.columns, out.rows));
  return {};
}

/// RescaleType at any of its locations; "US" and others mean that the values are not Hounsfield units.
void read_rescale_type(const DicomItem& top, DicomHeader& out) {
  const DicomValue* per_frame = top.find(kPerFrameGroups);
  const DicomItem* first = per_frame != nullptr && !per_frame->items.empty() ? &per_frame->items.front() : nullptr;
  const FrameScope scope{.own = first, .shared = inside(&top, kSharedGroups), .top = &top};
  const std::string type = text(scope.holder(kPixelValues, kRescaleType), kRescaleType);
  out.hounsfield = type.empty() || type == "HU";
}

/// 16 bits of padding value, interpreted with the sign of the pixels: files disagree on the type of the padding.
std::optional<std::int64_t> padding_value(const DicomItem& top, DicomTag tag, const StoredForm& form, bool big_endian) {
  const auto raw = u16(top, tag, big_endian);
  if (!raw) return std::nullopt;
  return form.is_signed ? std::int64_t{static_cast<std::int16_t>(*raw)} : std::int64_t{*raw};
}

std::string read_form(const DicomElements& file, DicomHeader& out) {
  const DicomItem& top = file.top;
  const bool big = file.big_endian;
  StoredForm& form = out.stored;
  form.bits_allocated = u16(top, kBitsAllocated, big).value_or(0);
  form.bits_stored = u16(top, kBitsStored, big).value_or(form.bits_allocated);
  form.high_bit = u16(top, kHighBit, big).value_or(form.bits_stored - 1);
  form.is_signed = u16(top, kPixelRepresentation, big).value_or(0) == 1;
  form.big_endian = big;
  form.swapped_bytes = big && form.bits_allocated == 8 && out.pixels.vr == std::array<char, 2>{'O', 'W'};
  if (form.bits_allocated != 8 && form.bits_allocated != 16 && form.bits_allocated != 32)
    return fmt::format("pixels of {} bits; 8, 16 and 32 are read", form.bits_allocated);
  const bool fits = form.bits_stored >= 1 && form.bits_stored <= form.bits_allocated && form.high_bit >= form.bits_stored - 1 &&
                    form.high_bit < form.bits_allocated;
  if (!fits) return fmt::format("{} bits stored below bit {} do not fit into {}", form.bits_stored, form.high_bit, form.bits_allocated);
  if (const auto low = padding_value(top, kPixelPadding, form, big)) {
    const std::int64_t high = padding_value(top, kPixelPaddingLimit, form, big).value_or(*low);
    form.padding = std::minmax(*low, high);
  }
  return {};
}

/// Checks the sizes in the header against the size of the file, before any allocation.
std::string size_error(const DicomHeader& h) {
  if (h.columns < 1 || h.rows < 1) return fmt::format("the image has {} x {} pixels", h.columns, h.rows);
  const double voxels = static_cast<double>(h.columns) * h.rows * static_cast<double>(h.frames.size());
  const double needed = voxels * static_cast<double>(h.stored.bytes());
  if (voxels > kMaxScanVoxels) return fmt::format("{:.4g} voxels are more than the {:.4g} that are read", voxels, kMaxScanVoxels);
  if (h.stored.swapped_bytes && h.columns % 2 != 0 && h.rows % 2 != 0)
    return "an odd number of 8-bit pixels in big-endian words is not read";
  if (h.codec == DicomCodec::none) {
    if (static_cast<double>(h.pixels.there) >= needed) return {};
    return fmt::format("pixels cut short: {} of {:.0f} bytes are there", h.pixels.there, needed);
  }
  if (needed <= kMostExpansion * static_cast<double>(h.file_bytes)) return {};
  return fmt::format("{} x {} x {} compressed pixels in {} bytes: more than {:.0f} to 1 is not accepted", h.columns, h.rows,
                     h.frames.size(), h.file_bytes, kMostExpansion);
}

std::string rescale_error(const DicomHeader& h) {
  for (const DicomFrame& f : h.frames) {
    if (!std::isfinite(f.slope) || !std::isfinite(f.intercept)) return "rescale slope or intercept is not a number";
    const double largest = std::abs(f.slope) * std::ldexp(1.0, h.stored.bits_stored) + std::abs(f.intercept);
    if (f.slope == 0.0 || largest > static_cast<double>(std::numeric_limits<float>::max()))
      return fmt::format("rescale slope {:.4g} and intercept {:.4g} give no usable values", f.slope, f.intercept);
  }
  return {};
}

std::string read_image(const DicomElements& file, DicomHeader& out) {
  const DicomItem& top = file.top;
  const auto codec = codec_of(file.transfer_syntax);
  if (!codec)
    return fmt::format("transfer syntax {} is not read", file.transfer_syntax.find_first_not_of("0123456789.") == std::string::npos
                                                             ? file.transfer_syntax
                                                             : "that is not a UID");
  out.codec = *codec;
  out.pixels = *file.pixels;
  out.deflated_at = file.deflated_at;
  if (out.pixels.encapsulated != (out.codec != DicomCodec::none))
    return fmt::format("pixels are {}compressed, in contradiction to the transfer syntax", out.pixels.encapsulated ? "" : "not ");
  out.rows = u16(top, kRows, file.big_endian).value_or(0);
  out.columns = u16(top, kColumns, file.big_endian).value_or(0);
  read_rescale_type(top, out);
  out.white_is_low = text(top, kPhotometric) == "MONOCHROME1";
  out.lossy = text(top, kLossy) == "01";
  std::string error = read_form(file, out);
  if (error.empty()) error = read_frames(top, out);
  out.has_rescale = std::all_of(out.frames.begin(), out.frames.end(), [](const DicomFrame& f) { return f.has_rescale; });
  if (error.empty()) error = size_error(out);
  return error.empty() ? rescale_error(out) : error;
}

WantedTags wanted_tags(const std::vector<DicomKeepTag>& keep) {
  WantedTags wanted;
  wanted.values = {kImageType,     kSopClassUid,       kSopInstanceUid,
                   kModality,      kSliceThickness,    kSeriesInstanceUid,
                   kSeriesNumber,  kAcquisitionNumber, kInstanceNumber,
                   kImagePosition, kImageOrientation,  kSamplesPerPixel,
                   kPhotometric,   kNumberOfFrames,    kRows,
                   kColumns,       kPixelSpacing,      kBitsAllocated,
                   kBitsStored,    kHighBit,           kPixelRepresentation,
                   kPixelPadding,  kPixelPaddingLimit, kIntercept,
                   kSlope,         kRescaleType,       kLossy};
  wanted.sequences = {kPlanePosition, kPlaneOrientation, kPixelMeasures, kPixelValues, kSharedGroups, kPerFrameGroups};
  for (const DicomKeepTag& k : keep) wanted.values.insert(k.tag);
  return wanted;
}

std::string kept_text(const DicomElements& file, const DicomKeepTag& keep) {
  const DicomValue* value = file.top.find(keep.tag);
  if (value == nullptr) return "(absent)";
  if (keep.vr != "US" && keep.vr != "SS") return one_line(text(file.top, keep.tag));
  const int raw = u16(file.top, keep.tag, file.big_endian).value_or(0);
  return std::to_string(keep.vr == "SS" ? static_cast<std::int16_t>(raw) : raw);
}

}  // namespace

Result<DicomHeader> read_dicom_header(const std::string& path, const std::vector<DicomKeepTag>& keep) {
  auto bytes = DicomBytes::open(path);
  if (!bytes) return bytes.error();
  DicomHeader out;
  out.path = path;
  out.file_bytes = bytes->size();
  const auto file = read_elements(*bytes, wanted_tags(keep));
  if (!file) {
    out.skip = "not DICOM";
    return out;
  }
  out.series_uid = text(file->top, kSeriesInstanceUid);
  out.instance_uid = text(file->top, kSopInstanceUid);
  out.series_number = code_or_dash(text(file->top, kSeriesNumber), true);
  const auto count = [&](DicomTag tag) {
    const auto value = numbers(file->top, tag, 1);
    return value ? std::optional(value->front()) : std::nullopt;
  };
  out.acquisition_number = count(kAcquisitionNumber);
  out.instance_number = count(kInstanceNumber);
  out.modality = code_or_dash(text(file->top, kModality), false);
  out.skip = skip_reason(*file);
  if (!out.skip.empty()) return out;
  for (const DicomKeepTag& k : keep) out.kept.push_back(kept_text(*file, k));
  out.error = file->error.empty() ? read_image(*file, out) : file->error;
  return out;
}

}  // namespace burrhole
