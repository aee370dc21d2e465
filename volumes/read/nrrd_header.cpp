#include "volumes/read/nrrd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/base/units.h"
#include "volumes/read/scan_geometry.h"

namespace burrhole {
namespace {

constexpr std::int64_t kMostSkipped = std::int64_t{1} << 40;  ///< lines or bytes

/// Fields as written, by name; the format requires that an unknown name is an error.
using Fields = std::map<std::string, std::string, std::less<>>;

constexpr std::array<std::string_view, 37> kFields{
    "dimension",   "type",      "block size", "blocksize",   "encoding",       "endian",      "content",    "min",
    "old min",     "oldmin",    "max",        "old max",     "oldmax",         "data file",   "datafile",   "line skip",
    "lineskip",    "byte skip", "byteskip",   "number",      "sample units",   "sampleunits", "sizes",      "spacings",
    "thicknesses", "axis mins", "axismins",   "axis maxs",   "axismaxs",       "centers",     "centerings", "labels",
    "units",       "kinds",     "space",      "space units", "space dimension"};
constexpr std::array<std::string_view, 3> kMoreFields{"space origin", "space directions", "measurement frame"};

bool is_field(std::string_view name) {
  return std::find(kFields.begin(), kFields.end(), name) != kFields.end() ||
         std::find(kMoreFields.begin(), kMoreFields.end(), name) != kMoreFields.end();
}

struct Lines {
  Fields fields;
  std::vector<std::string> list;  ///< lines after "data file: LIST"
  std::size_t bytes = 0;          ///< up to the data
  bool own_density = false;       ///< see ImageHead
};

/// Splits the header; drops comments and key:=value pairs.
Result<Lines> split(std::string_view text) {
  Lines out;
  std::string_view rest = text;
  const auto magic = take_line(rest);
  if (!magic || magic->size() != 8 || !magic->starts_with("NRRD000")) return bad_input("does not start with NRRD and a version");
  if (magic->back() < '1' || magic->back() > '5') return bad_input("is of a version of NRRD that is not known; 1 to 5 are read");
  bool list = false;
  int number = 1;
  while (const auto line = take_line(rest)) {
    ++number;
    if (list) {
      if (!trimmed(*line).empty()) out.list.emplace_back(trimmed(*line));
      continue;
    }
    if (line->empty()) break;
    if (line->front() == '#') continue;
    const std::size_t colon = line->find(':');
    if (colon == std::string_view::npos) return bad_input(fmt::format("line {} of the header is not \"field: value\"", number));
    out.own_density = out.own_density || *line == kNrrdDensity;
    if (line->substr(colon).starts_with(":=")) continue;
    std::string name = lower(trimmed(line->substr(0, colon)));
    if (!is_field(name)) return bad_input(fmt::format("line {} of the header is not a field of NRRD", number));
    std::string value(trimmed(line->substr(colon + 1)));
    list = (name == "data file" || name == "datafile") && !words_of(value).empty() && words_of(value).front() == "LIST";
    if (!out.fields.emplace(std::move(name), std::move(value)).second)
      return bad_input(fmt::format("line {} of the header repeats a field", number));
  }
  out.bytes = text.size() - rest.size();
  return out;
}

/// The value of a field under either of its names, or nothing.
std::optional<std::string_view> value_of(const Fields& fields, std::string_view name, std::string_view other = {}) {
  auto found = fields.find(name);
  if (found == fields.end() && !other.empty()) found = fields.find(other);
  if (found == fields.end()) return std::nullopt;
  return std::string_view(found->second);
}

std::optional<PixelType> pixel_type(std::string_view name) {
  static const std::map<std::string_view, PixelType> kTypes{{"signed char", PixelType::i8},
                                                            {"int8", PixelType::i8},
                                                            {"int8_t", PixelType::i8},
                                                            {"uchar", PixelType::u8},
                                                            {"unsigned char", PixelType::u8},
                                                            {"uint8", PixelType::u8},
                                                            {"uint8_t", PixelType::u8},
                                                            {"short", PixelType::i16},
                                                            {"short int", PixelType::i16},
                                                            {"signed short", PixelType::i16},
                                                            {"signed short int", PixelType::i16},
                                                            {"int16", PixelType::i16},
                                                            {"int16_t", PixelType::i16},
                                                            {"ushort", PixelType::u16},
                                                            {"unsigned short", PixelType::u16},
                                                            {"unsigned short int", PixelType::u16},
                                                            {"uint16", PixelType::u16},
                                                            {"uint16_t", PixelType::u16},
                                                            {"int", PixelType::i32},
                                                            {"signed int", PixelType::i32},
                                                            {"int32", PixelType::i32},
                                                            {"int32_t", PixelType::i32},
                                                            {"uint", PixelType::u32},
                                                            {"unsigned int", PixelType::u32},
                                                            {"uint32", PixelType::u32},
                                                            {"uint32_t", PixelType::u32},
                                                            {"longlong", PixelType::i64},
                                                            {"long long", PixelType::i64},
                                                            {"long long int", PixelType::i64},
                                                            {"signed long long", PixelType::i64},
                                                            {"signed long long int", PixelType::i64},
                                                            {"int64", PixelType::i64},
                                                            {"int64_t", PixelType::i64},
                                                            {"ulonglong", PixelType::u64},
                                                            {"unsigned long long", PixelType::u64},
                                                            {"unsigned long long int", PixelType::u64},
                                                            {"uint64", PixelType::u64},
                                                            {"uint64_t", PixelType::u64},
                                                            {"float", PixelType::f32},
                                                            {"double", PixelType::f64}};
  const auto found = kTypes.find(lower(name));
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

/// Removes "(1,0,0)" from the start of `rest` and returns it as a vector.
std::optional<Vec3> take_vector(std::string_view& rest) {
  rest = trimmed(rest);
  const std::size_t close = rest.find(')');
  if (rest.empty() || rest.front() != '(' || close == std::string_view::npos) return std::nullopt;
  std::string inside(rest.substr(1, close - 1));
  if (std::count(inside.begin(), inside.end(), ',') != 2) return std::nullopt;
  std::replace(inside.begin(), inside.end(), ',', ' ');
  rest.remove_prefix(close + 1);
  const auto three = numbers_of(inside, 3);
  if (!three) return std::nullopt;
  return Vec3((*three)[0], (*three)[1], (*three)[2]);
}

/// Words in quotes: "mm" "mm" "mm".
std::vector<std::string> quoted(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t open = text.find('"'); open != std::string_view::npos;) {
    const std::size_t close = text.find('"', open + 1);
    if (close == std::string_view::npos) break;
    out.push_back(lower(trimmed(text.substr(open + 1, close - open - 1))));
    open = text.find('"', close + 1);
  }
  return out;
}

/// [m] per unit, of each axis.
Result<Vec3> axis_units(std::optional<std::string_view> units, std::vector<std::string>& assumed) {
  const auto words = units ? quoted(*units) : std::vector<std::string>();
  if (words.empty() || std::all_of(words.begin(), words.end(), [](const std::string& word) { return word.empty(); })) {
    assumed.emplace_back("no unit of length in the file: millimetres");
    return Vec3(kMillimetre);
  }
  if (words.size() != 3) return bad_input(fmt::format("{} units of length for three axes", words.size()));
  Vec3 out(0.0);
  for (std::size_t n = 0; n < 3; ++n) {
    const std::string& word = words[n];
    if (word == "mm" || word == "millimeter" || word == "millimeters" || word == "millimetre")
      out[n] = kMillimetre;
    else if (word == "m" || word == "meter" || word == "metre")
      out[n] = 1.0;
    else if (word == "cm")
      out[n] = 0.01;
    else if (word == "um" || word == "\xc2\xb5m" || word == "micron" || word == "microns")
      out[n] = 1e-6;
    else
      return bad_input(fmt::format("the unit of axis {} is not one of mm, cm, m, um", "xyz"[n]));
  }
  return out;
}

/// Signs that convert the space of the file to LPS; assumptions are reported.
Result<Vec3> lps_from_space(const Fields& fields, std::vector<std::string>& assumed) {
  const auto space = value_of(fields, "space");
  const std::string name = space ? lower(*space) : std::string();
  if (name == "left-posterior-superior" || name == "lps") return Vec3(1, 1, 1);
  if (name == "right-anterior-superior" || name == "ras") return Vec3(-1, -1, 1);
  if (name == "left-anterior-superior" || name == "las") return Vec3(1, -1, 1);
  if (name.ends_with("-time") || name == "rast" || name == "last" || name == "lpst") return bad_input("4D: its space has a time axis");
  if (name == "scanner-xyz" || name == "3d-right-handed" || name == "3d-left-handed") {
    assumed.push_back(fmt::format("space {} does not define left and right: assumed to be LPS", name));
    return Vec3(1, 1, 1);
  }
  if (space) return bad_input("its space is not one of LPS, RAS, LAS, scanner-xyz, 3D-right-handed, 3D-left-handed");
  if (const auto axes = value_of(fields, "space dimension"); axes && *axes != "3") return bad_input("its space dimension is not 3");
  assumed.emplace_back("no space in the file: i towards left, j towards posterior, k towards superior");
  return Vec3(1, 1, 1);
}

/// Columns from three vectors; "none" and other words are errors.
Result<Mat3> directions_of(std::string_view text) {
  Mat3 out(0.0);
  std::string_view rest = text;
  for (std::size_t n = 0; n < 3; ++n) {
    rest = trimmed(rest);
    if (lower(rest.substr(0, 4)) == "none")
      return bad_input(fmt::format("axis {} has no direction (none): it is not an axis of space", n + 1));
    const auto column = take_vector(rest);
    if (!column) return bad_input(fmt::format("space directions: vector {} is not three finite numbers", n + 1));
    out[n] = *column;
  }
  if (!trimmed(rest).empty()) return bad_input("space directions: more than three vectors");
  return out;
}

Result<Affine> affine_of(const Fields& fields, std::vector<std::string>& assumed) {
  const Result<Vec3> sign = lps_from_space(fields, assumed);
  if (!sign) return sign.error();
  Affine out;
  Vec3 unit(kMillimetre);
  const auto directions = value_of(fields, "space directions");
  if (directions) {
    const Result<Mat3> columns = directions_of(*directions);
    if (!columns) return columns.error();
    out.linear = columns.value();
  } else if (const auto spacings = value_of(fields, "spacings")) {
    const auto edges = numbers_of(*spacings, 3);
    if (!edges) return bad_input("spacings are not three finite numbers");
    for (std::size_t n = 0; n < 3; ++n) out.linear[n] *= (*edges)[n];
  } else {
    assumed.emplace_back("no spacing in the file: 1 along each axis");
  }
  const Result<Vec3> units = axis_units(directions ? value_of(fields, "space units") : value_of(fields, "units"), assumed);
  if (!units) return units.error();
  unit = units.value();
  if (const auto origin = value_of(fields, "space origin")) {
    std::string_view rest = *origin;
    const auto at = take_vector(rest);
    if (!at || !trimmed(rest).empty()) return bad_input("space origin is not a vector of three finite numbers");
    out.offset = *at;
  } else {
    assumed.emplace_back("no origin in the file: first voxel at 0");
  }
  for (std::size_t column = 0; column < 3; ++column) out.linear[column] *= unit * sign.value();
  out.offset *= unit * sign.value();
  return out;
}

/// Three axes of space, one number a voxel.
Result<Vec3i> dims_of(const Fields& fields) {
  const auto dimension = value_of(fields, "dimension");
  const auto axes = dimension ? whole_of(*dimension) : std::nullopt;
  if (!axes) return bad_input("dimension is missing or not an integer");
  if (*axes == 4) return bad_input("dimension 4: several volumes, colours or vectors; one number per voxel of a volume is read");
  if (*axes != 3) return bad_input(fmt::format("dimension {}: a volume has three", *axes));
  const auto sizes = value_of(fields, "sizes");
  const auto edges = sizes ? wholes_of(*sizes, 3) : std::nullopt;
  if (!edges) return bad_input("sizes are missing or not three integers");
  if (const auto error = dims_error((*edges)[0], (*edges)[1], (*edges)[2])) return bad_input(*error);
  if (const auto kinds = value_of(fields, "kinds")) {
    const auto words = words_of(*kinds);
    if (words.size() != 3) return bad_input(fmt::format("{} kinds for three axes", words.size()));
    for (std::size_t n = 0; n < 3; ++n) {
      const std::string kind = lower(words[n]);
      if (kind != "domain" && kind != "space" && kind != "none" && kind != "???")
        return bad_input(fmt::format("axis {} is of a kind that is not space: colours, vectors and time are not read", n + 1));
    }
  }
  return Vec3i((*edges)[0], (*edges)[1], (*edges)[2]);
}

/// An axis of 3 or 4 numbers beside two long ones holds the colours of a picture as often as slices. Directions, or a kind, say which.
Status check_colours(const Fields& fields, const Vec3i& dims) {
  constexpr int kPicture = 32;  // pixels along a side
  if (value_of(fields, "space directions")) return {};
  const auto kinds = value_of(fields, "kinds");
  const auto words = kinds ? words_of(*kinds) : std::vector<std::string_view>();
  for (std::size_t n = 0; n < 3; ++n) {
    if (dims[n] != 3 && dims[n] != 4) continue;
    if (dims[(n + 1) % 3] < kPicture || dims[(n + 2) % 3] < kPicture) continue;
    const std::string kind = words.empty() ? std::string() : lower(words[n]);
    if (kind == "domain" || kind == "space") continue;
    return bad_input(
        fmt::format("axis {} has {} numbers, which may be colours: if they are slices of a volume, add \"kinds: domain domain "
                    "domain\" to the header; colours are not read",
                    n + 1, dims[n]));
  }
  return {};
}

Status set_form(const Fields& fields, NrrdHeader& out) {
  const auto type = value_of(fields, "type");
  const auto known = type ? pixel_type(*type) : std::nullopt;
  if (!known) return bad_input("type is missing or not supported (8 to 64 bit whole numbers, float, double)");
  out.image.form.type = *known;
  const auto encoding = value_of(fields, "encoding");
  const std::string name = encoding ? lower(*encoding) : std::string();
  if (name == "raw")
    out.packing = Packing::raw;
  else if (name == "gzip" || name == "gz")
    out.packing = Packing::packed;
  else if (name == "ascii" || name == "text" || name == "txt")
    out.packing = Packing::text;
  else if (name == "bzip2" || name == "bz2")
    return bad_input("encoding bzip2 is not read: save it again with encoding gzip or raw");
  else
    return bad_input("encoding is missing or not one of raw, gzip, ascii");
  if (out.packing == Packing::text || bytes_of(*known) == 1) return {};
  const auto endian = value_of(fields, "endian");
  const std::string order = endian ? lower(*endian) : std::string();
  if (order != "little" && order != "big") return bad_input("endian is missing or neither little nor big");
  out.image.form.big_endian = order == "big";
  return {};
}

/// The data file field: one file, a list or numbered names.
Status set_files(Lines& lines, NrrdHeader& out) {
  const auto field = value_of(lines.fields, "data file", "datafile");
  if (!field) return {};
  const auto words = words_of(*field);
  if (words.empty()) return bad_input("data file names no file");
  if (words.front() == "LIST") {
    if (words.size() > 2 || (words.size() == 2 && words[1] != "2" && words[1] != "3"))
      return bad_input("data file: LIST of a kind not read");
    if (lines.list.empty()) return bad_input("data file: LIST without files");
    out.data_files = std::move(lines.list);
    return {};
  }
  if (words.front().find('%') == std::string_view::npos || words.size() < 4) {
    out.data_files = {std::string(*field)};
    return {};
  }
  const auto first = whole_of(words[1]), last = whole_of(words[2]), step = whole_of(words[3]);
  if (first && last && step) out.numbered = numbered_names(words.front(), *first, *last, *step);
  const bool by_slice = words.size() == 4 || (words.size() == 5 && (words[4] == "2" || words[4] == "3"));
  if (!out.numbered || !by_slice) return bad_input("data file: its numbered names are of a form not read");
  return {};
}

Status set_skips(const Fields& fields, NrrdHeader& out) {
  if (const auto lines = value_of(fields, "line skip", "lineskip")) {
    const auto count = whole_of(*lines);
    if (!count || *count < 0 || *count > kMostSkipped) return bad_input("line skip is not an integer of at least 0");
    out.line_skip = static_cast<std::uint64_t>(*count);
  }
  if (const auto bytes = value_of(fields, "byte skip", "byteskip")) {
    const auto count = whole_of(*bytes);
    if (!count || *count < -1 || *count > kMostSkipped) return bad_input("byte skip is not an integer of at least -1");
    out.at_end = *count == -1;
    out.byte_skip = out.at_end ? 0 : static_cast<std::uint64_t>(*count);
  }
  if (out.at_end && out.packing != Packing::raw) return bad_input("byte skip -1 goes with encoding raw only");
  return {};
}

}  // namespace

Result<NrrdHeader> parse_nrrd(std::string_view text) {
  Result<Lines> lines = split(text);
  if (!lines) return lines.error();
  NrrdHeader out;
  out.header_bytes = lines->bytes;
  out.image.own_density = lines->own_density;
  const Result<Vec3i> dims = dims_of(lines->fields);
  if (!dims) return dims.error();
  out.image.dims = dims.value();
  if (const Status slices = check_colours(lines->fields, *dims); !slices) return slices.error();
  if (const Status status = set_form(lines->fields, out); !status) return status.error();
  const Result<Affine> affine = affine_of(lines->fields, out.image.assumed);
  if (!affine) return affine.error();
  out.image.bone_from_index = affine.value();
  if (const auto error = affine_error(affine.value())) return bad_input(*error);
  if (const Status status = set_skips(lines->fields, out); !status) return status.error();
  if (const Status status = set_files(lines.value(), out); !status) return status.error();
  return out;
}

}  // namespace burrhole
