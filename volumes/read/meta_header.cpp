#include "volumes/read/meta_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/units.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

/// The keys that are needed; all others are skipped.
constexpr std::string_view kKeys[] = {"ObjectType",
                                      "NDims",
                                      "DimSize",
                                      "BinaryData",
                                      "BinaryDataByteOrderMSB",
                                      "ElementByteOrderMSB",
                                      "CompressedData",
                                      "HeaderSize",
                                      "Modality",
                                      "TransformMatrix",
                                      "Rotation",
                                      "Orientation",
                                      "Offset",
                                      "Position",
                                      "Origin",
                                      "ElementSpacing",
                                      "ElementSize",
                                      "ElementType",
                                      "ElementNumberOfChannels",
                                      "DistanceUnits",
                                      "ElementToIntensityFunctionSlope",
                                      "ElementToIntensityFunctionOffset",
                                      "ElementDataFile"};

using Fields = std::map<std::string, std::string, std::less<>>;

struct Lines {
  Fields fields;
  std::vector<std::string> list;
  std::size_t bytes = 0;
};

bool is_key(std::string_view name) { return std::find(std::begin(kKeys), std::end(kKeys), name) != std::end(kKeys); }

Result<Lines> split(std::string_view text) {
  Lines out;
  std::string_view rest = text;
  int number = 0;
  while (const auto line = take_line(rest)) {
    ++number;
    if (trimmed(*line).empty()) continue;
    const std::size_t equals = line->find('=');
    if (equals == std::string_view::npos) return bad_input(fmt::format("line {} of the header is not \"Key = value\"", number));
    const std::string_view name = trimmed(line->substr(0, equals));
    if (!is_key(name)) continue;
    if (!out.fields.emplace(name, trimmed(line->substr(equals + 1))).second)
      return bad_input(fmt::format("line {} of the header says {} again", number, name));
    if (name == "ElementDataFile") break;
  }
  out.bytes = text.size() - rest.size();
  if (const auto found = out.fields.find("ElementDataFile"); found == out.fields.end())
    return bad_input("ElementDataFile is missing: it ends the header");
  else if (found->second.starts_with("LIST"))
    while (const auto line = take_line(rest))
      if (!trimmed(*line).empty()) out.list.emplace_back(trimmed(*line));
  return out;
}

/// The value of the first of the names that is present.
std::optional<std::string_view> value_of(const Fields& fields, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (const auto found = fields.find(name); found != fields.end()) return std::string_view(found->second);
  return std::nullopt;
}

Result<bool> flag_of(const Fields& fields, std::initializer_list<std::string_view> names, bool fallback) {
  const auto value = value_of(fields, names);
  const std::string word = value ? lower(*value) : std::string();
  if (!value) return fallback;
  if (word == "true" || word == "1" || word == "yes" || word == "t") return true;
  if (word == "false" || word == "0" || word == "no" || word == "f") return false;
  return bad_input(fmt::format("{} is neither True nor False", *names.begin()));
}

/// `count` numbers of the first of the names that is present; nothing if none is.
Result<std::optional<std::vector<double>>> numbers_under(const Fields& fields, std::initializer_list<std::string_view> names,
                                                         std::size_t count) {
  const auto value = value_of(fields, names);
  if (!value) return std::optional<std::vector<double>>();
  auto numbers = numbers_of(*value, count);
  if (!numbers) return bad_input(fmt::format("{} is not {} finite numbers", *names.begin(), count));
  return numbers;
}

Result<Vec3i> dims_of(const Fields& fields) {
  if (const auto type = value_of(fields, {"ObjectType"}); type && lower(*type) != "image") return bad_input("its ObjectType is not Image");
  const auto value = value_of(fields, {"NDims"});
  const auto axes = value ? whole_of(*value) : std::nullopt;
  if (!axes) return bad_input("NDims is missing or not an integer");
  if (*axes != 3) return bad_input(fmt::format("{}D: a volume has three axes", *axes));
  const auto sizes = value_of(fields, {"DimSize"});
  const auto edges = sizes ? wholes_of(*sizes, 3) : std::nullopt;
  if (!edges) return bad_input("DimSize is missing or not three integers");
  if (const auto error = dims_error((*edges)[0], (*edges)[1], (*edges)[2])) return bad_input(*error);
  if (const auto channels = value_of(fields, {"ElementNumberOfChannels"})) {
    const auto count = whole_of(*channels);
    if (!count) return bad_input("ElementNumberOfChannels is not an integer");
    if (*count != 1) return bad_input(fmt::format("{} channels (colours or vectors): only one number per voxel is supported", *count));
  }
  return Vec3i((*edges)[0], (*edges)[1], (*edges)[2]);
}

std::optional<PixelType> pixel_type(std::string_view name) {
  // MET_LONG has 4 bytes on every machine that MetaIO supports, MET_LONG_LONG has 8.
  static const std::map<std::string_view, PixelType> kTypes{
      {"MET_CHAR", PixelType::i8},   {"MET_UCHAR", PixelType::u8},   {"MET_SHORT", PixelType::i16},     {"MET_USHORT", PixelType::u16},
      {"MET_INT", PixelType::i32},   {"MET_UINT", PixelType::u32},   {"MET_LONG", PixelType::i32},      {"MET_ULONG", PixelType::u32},
      {"MET_FLOAT", PixelType::f32}, {"MET_DOUBLE", PixelType::f64}, {"MET_LONG_LONG", PixelType::i64}, {"MET_ULONG_LONG", PixelType::u64}};
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

Result<PixelForm> form_of(const Fields& fields, Packing packing, std::vector<std::string>& assumed) {
  PixelForm out;
  const auto name = value_of(fields, {"ElementType"});
  const auto type = name ? pixel_type(*name) : std::nullopt;
  if (!type) return bad_input("ElementType is missing or not supported (MET_UCHAR .. MET_DOUBLE, no arrays)");
  out.type = *type;
  const Result<bool> big = flag_of(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}, false);
  if (!big) return big.error();
  out.big_endian = big.value();
  const bool said = value_of(fields, {"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}).has_value();
  if (!said && packing != Packing::text && bytes_of(out.type) > 1) assumed.emplace_back("no byte order in the file: little endian");
  const auto slope = numbers_under(fields, {"ElementToIntensityFunctionSlope"}, 1);
  if (!slope) return slope.error();
  const auto intercept = numbers_under(fields, {"ElementToIntensityFunctionOffset"}, 1);
  if (!intercept) return intercept.error();
  if (slope.value() && slope.value()->front() != 0.0) out.slope = slope.value()->front();
  if (intercept.value()) out.intercept = intercept.value()->front();
  return out;
}

Result<Packing> packing_of(const Fields& fields) {
  const Result<bool> binary = flag_of(fields, {"BinaryData"}, true);
  if (!binary) return binary.error();
  const Result<bool> packed = flag_of(fields, {"CompressedData"}, false);
  if (!packed) return packed.error();
  if (packed.value() && !binary.value()) return bad_input("compressed text is not read");
  return packed.value() ? Packing::packed : binary.value() ? Packing::raw : Packing::text;
}

/// [m] per unit of the file.
Result<double> unit_of(const Fields& fields) {
  const auto unit = value_of(fields, {"DistanceUnits"});
  const std::string word = unit ? lower(*unit) : std::string("mm");  // default of the format
  if (word == "mm" || word == "?" || word == "unknown") return kMillimetre;
  if (word == "cm") return 0.01;
  if (word == "um") return 1e-6;
  if (word == "m") return 1.0;
  return bad_input("DistanceUnits is not one of mm, cm, um");
}

Result<Affine> affine_of(const Fields& fields, std::vector<std::string>& assumed) {
  const Result<double> unit = unit_of(fields);
  if (!unit) return unit.error();
  const auto matrix = numbers_under(fields, {"TransformMatrix", "Rotation", "Orientation"}, 9);
  if (!matrix) return matrix.error();
  auto spacing = numbers_under(fields, {"ElementSpacing", "ElementSize"}, 3);
  if (!spacing) return spacing.error();
  const auto origin = numbers_under(fields, {"Offset", "Position", "Origin"}, 3);
  if (!origin) return origin.error();
  if (!matrix.value()) assumed.emplace_back("no orientation in the file: i towards left, j towards posterior, k towards superior (LPS)");
  const auto anatomical = fields.find("AnatomicalOrientation");
  if (anatomical != fields.end() && anatomical->second.find('?') != std::string::npos)
    assumed.emplace_back("the file does not know its anatomical orientation: assumed to be LPS");
  if (!spacing.value()) assumed.emplace_back("no spacing in the file: 1 mm along each axis");
  if (!origin.value()) assumed.emplace_back("no origin in the file: first voxel at 0");
  Affine out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row)
      if (matrix.value()) out.linear[axis][row] = (*matrix.value())[3 * axis + row];
    out.linear[axis] *= unit.value() * (spacing.value() ? (*spacing.value())[axis] : 1.0);
    if (origin.value()) out.offset[axis] = (*origin.value())[axis] * unit.value();
  }
  return out;
}

/// ElementDataFile: LOCAL, a name, LIST with names below, or "name%03d.raw first last step".
Status set_files(Lines& lines, MetaHeader& out) {
  const std::string_view field = *value_of(lines.fields, {"ElementDataFile"});
  const auto words = words_of(field);
  if (words.empty()) return bad_input("ElementDataFile names no file");
  const bool local = field == "LOCAL" || field == "Local" || field == "local";
  if (words.front() == "LIST") {
    if (words.size() > 2 || (words.size() == 2 && words[1] != "2" && words[1] != "2D" && words[1] != "3" && words[1] != "3D"))
      return bad_input("ElementDataFile = LIST of a kind that is not read");
    if (lines.list.empty()) return bad_input("ElementDataFile = LIST without files");
    out.data_files = std::move(lines.list);
  } else if (words.front().find('%') != std::string_view::npos && words.size() > 1) {
    const auto first = whole_of(words[1]);
    const auto last = words.size() > 2 ? whole_of(words[2]) : std::nullopt;
    const auto step = words.size() > 3 ? whole_of(words[3]) : std::optional<std::int64_t>(1);
    if (first && last && step && words.size() <= 4) out.numbered = numbered_names(words.front(), *first, *last, *step);
    if (!out.numbered) return bad_input("ElementDataFile: its numbered names are of a form not read");
  } else if (!local) {
    out.data_files = {std::string(field)};
  }
  if (const auto header = value_of(lines.fields, {"HeaderSize"})) {
    const auto count = whole_of(*header);
    if (!count || *count < -1) return bad_input("HeaderSize is not an integer of at least -1");
    if (local && *count > 0) return bad_input("HeaderSize goes with a data file of its own, not with LOCAL");
    out.at_end = *count == -1;
    out.file_header_bytes = *count > 0 ? static_cast<std::uint64_t>(*count) : 0;
  }
  if (out.at_end && out.packing != Packing::raw) return bad_input("HeaderSize = -1 goes with plain binary data only");
  if (out.packing == Packing::packed && (out.numbered || out.data_files.size() > 1))
    return bad_input("several compressed data files are not read");
  return {};
}

}  // namespace

bool starts_like_metaimage(std::string_view text) {
  const auto line = take_line(text);
  const std::size_t equals = line ? line->find('=') : std::string_view::npos;
  if (equals == std::string_view::npos) return false;
  const std::string_view name = trimmed(line->substr(0, equals));
  return name == "Comment" || name == "ID" || name == "Name" || is_key(name);
}

Result<MetaHeader> parse_metaimage(std::string_view text) {
  Result<Lines> lines = split(text);
  if (!lines) return lines.error();
  const Fields& fields = lines->fields;
  MetaHeader out;
  out.header_bytes = lines->bytes;
  const Result<Vec3i> dims = dims_of(fields);
  if (!dims) return dims.error();
  out.image.dims = dims.value();
  const Result<Packing> packing = packing_of(fields);
  if (!packing) return packing.error();
  out.packing = packing.value();
  const Result<PixelForm> form = form_of(fields, out.packing, out.image.assumed);
  if (!form) return form.error();
  out.image.form = form.value();
  const Result<Affine> affine = affine_of(fields, out.image.assumed);
  if (!affine) return affine.error();
  out.image.bone_from_index = affine.value();
  if (const auto error = affine_error(affine.value())) return bad_input(*error);
  const auto modality = value_of(fields, {"Modality"});
  if (modality && (*modality == "MET_MOD_MR" || *modality == "MET_MOD_NM" || *modality == "MET_MOD_US")) out.quantity = Quantity::other;
  if (const Status status = set_files(lines.value(), out); !status) return status.error();
  return out;
}

}  // namespace burrhole
