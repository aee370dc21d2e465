#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volumes/read/mesh_formats.h"
#include "volumes/read/text_words.h"

namespace burrhole {
namespace {

enum class Form { text, little_endian, big_endian };
enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

std::optional<Type> type_of(std::string_view word) {
  constexpr std::pair<std::string_view, Type> kNames[] = {
      {"char", Type::i8},   {"int8", Type::i8},     {"uchar", Type::u8},   {"uint8", Type::u8},
      {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16}, {"uint16", Type::u16},
      {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},   {"uint32", Type::u32},
      {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64}, {"float64", Type::f64}};
  for (const auto& [name, type] : kNames)
    if (name == word) return type;
  return std::nullopt;
}

struct Property {
  std::string_view name;
  Type type = Type::f32;
  std::optional<Type> count_type;  ///< of a list
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  /// Smallest size of one value [bytes]: in text, a digit and a blank per number.
  [[nodiscard]] std::size_t least_bytes(Form form) const {
    std::size_t sum = 0;
    for (const Property& p : properties) sum += form == Form::text ? 2 : size_of(p.count_type.value_or(p.type));
    return sum;
  }
};

struct Header {
  Form form = Form::text;
  std::vector<Element> elements;
  std::string_view body;
};

/// @returns the error, empty if none.
std::string add_property(Words& words, Header& header) {
  if (header.elements.empty()) return "a property before any element";
  Property property;
  std::string_view word = words.next();
  if (word == "list") {
    property.count_type = type_of(words.next());
    if (!property.count_type || *property.count_type >= Type::f32) return "a list whose length has no whole type";
    word = words.next();
  }
  const auto type = type_of(word);
  if (!type) return fmt::format("\"{:.20}\" is not a PLY type", word);
  property.type = *type;
  property.name = words.next();
  header.elements.back().properties.push_back(property);
  return {};
}

std::string add_line(std::string_view line, Header& header, bool& formatted) {
  Words words(line);
  const std::string_view key = words.next();
  if (key.empty() || key == "comment" || key == "obj_info") return {};
  if (key == "property") return add_property(words, header);
  if (key == "element") {
    const std::string_view name = words.next();
    const auto count = number_of<std::uint64_t>(words.next());
    if (name.empty() || !count) return "an element without a count";
    header.elements.push_back({name, *count, {}});
    return {};
  }
  if (key != "format") return fmt::format("\"{:.20}\" is not a word of a PLY header", key);
  const std::string_view form = words.next();
  formatted = form == "ascii" || form == "binary_little_endian" || form == "binary_big_endian";
  header.form = form == "ascii" ? Form::text : form == "binary_big_endian" ? Form::big_endian : Form::little_endian;
  return formatted ? std::string() : fmt::format("\"{:.30}\" is not a PLY format", form);
}

Result<Header> parse_header(std::string_view bytes) {
  Lines lines(bytes);
  std::string_view line;
  if (!lines.next(line) || line != "ply") return bad_input("does not begin with a line \"ply\"");
  Header header;
  bool formatted = false;
  while (lines.next(line)) {
    if (Words(line).next() == "end_header") {
      if (!formatted) return bad_input("has no format line");
      header.body = lines.rest();
      return header;
    }
    if (const std::string error = add_line(line, header, formatted); !error.empty())
      return bad_input(fmt::format("line {}: {}", lines.number(), error));
  }
  return bad_input("has no end_header");
}

/// Numbers of the body, one after another.
class Body {
 public:
  Body(std::string_view bytes, Form form) : bytes_(bytes), words_(bytes), form_(form) {}

  std::optional<double> next(Type type) {
    if (form_ == Form::text) return number_of<double>(words_.next());
    const std::size_t size = size_of(type);
    if (bytes_.size() - at_ < size) return std::nullopt;
    char raw[8] = {};
    std::memcpy(raw, bytes_.data() + at_, size);
    at_ += size;
    if (form_ == Form::big_endian) std::reverse(raw, raw + size);
    return number_from(raw, type);
  }
  [[nodiscard]] std::size_t left() const { return form_ == Form::text ? words_.rest().size() : bytes_.size() - at_; }

 private:
  template <class T>
  static double as(const char* raw) {
    T value;
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  }
  static double number_from(const char* raw, Type type) {
    switch (type) {
      case Type::i8:
        return as<std::int8_t>(raw);
      case Type::u8:
        return as<std::uint8_t>(raw);
      case Type::i16:
        return as<std::int16_t>(raw);
      case Type::u16:
        return as<std::uint16_t>(raw);
      case Type::i32:
        return as<std::int32_t>(raw);
      case Type::u32:
        return as<std::uint32_t>(raw);
      case Type::f32:
        return as<float>(raw);
      case Type::f64:
        return as<double>(raw);
    }
    return 0.0;
  }

  std::string_view bytes_;
  Words words_;
  Form form_;
  std::size_t at_ = 0;
};

constexpr const char* kCut = "ends within its elements: cut off?";

/// One list; an error is written to `error`.
std::vector<double> read_list(Body& body, const Property& property, std::string& error) {
  const auto count = body.next(*property.count_type);
  // No list is longer than the bytes left: nothing is allocated for a count that cannot be.
  if (!count || !(*count >= 0.0) || *count != std::floor(*count) || *count > static_cast<double>(body.left())) {
    error = count ? fmt::format("a list of {:g} numbers in {} bytes", *count, body.left()) : kCut;
    return {};
  }
  const auto length = static_cast<std::size_t>(*count);
  std::vector<double> list;
  for (std::size_t n = 0; n < length; ++n) {
    const auto value = body.next(property.type);
    if (!value) {
      error = kCut;
      return {};
    }
    list.push_back(*value);
  }
  return list;
}

std::string add_vertices(Body& body, const Element& element, SurfaceMesh& mesh) {
  std::size_t axis[3] = {};
  for (std::size_t x = 0; x < 3; ++x) {
    const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                    [&](const Property& p) { return !p.count_type && p.name == std::string_view("xyz").substr(x, 1); });
    if (found == element.properties.end()) return "its vertices lack x, y or z";
    axis[x] = static_cast<std::size_t>(found - element.properties.begin());
  }
  std::string error;
  std::vector<double> values(element.properties.size());
  for (std::uint64_t n = 0; n < element.count; ++n) {
    for (std::size_t p = 0; p < values.size(); ++p) {
      if (element.properties[p].count_type) {
        read_list(body, element.properties[p], error);
      } else if (const auto value = body.next(element.properties[p].type)) {
        values[p] = *value;
      } else {
        error = kCut;
      }
      if (!error.empty()) return error;
    }
    mesh.positions.emplace_back(values[axis[0]], values[axis[1]], values[axis[2]]);
  }
  return {};
}

std::string add_face(const std::vector<double>& list, SurfaceMesh& mesh, std::uint64_t& steps) {
  if (list.size() < 3 || list.size() > kMaxPolygonCorners)
    return fmt::format("a face of {} corners, 3 to {} are read", list.size(), kMaxPolygonCorners);
  std::vector<std::uint32_t> corners;
  for (const double index : list) {
    if (!(index >= 0.0) || index != std::floor(index) || index >= static_cast<double>(mesh.positions.size()))
      return fmt::format("a face names vertex {:.{}g} of {}", index, 15, mesh.positions.size());
    corners.push_back(static_cast<std::uint32_t>(index));
  }
  return append_polygon(corners, mesh, steps);
}

/// Faces, or any element that is passed over: `mesh` null.
std::string walk(Body& body, const Element& element, SurfaceMesh* mesh) {
  std::string error;
  std::uint64_t steps = 0;
  for (std::uint64_t n = 0; n < element.count; ++n)
    for (const Property& p : element.properties) {
      if (p.count_type) {
        const std::vector<double> list = read_list(body, p, error);
        if (error.empty() && mesh != nullptr && (p.name == "vertex_indices" || p.name == "vertex_index"))
          error = add_face(list, *mesh, steps);
      } else if (!body.next(p.type)) {
        error = kCut;
      }
      if (!error.empty()) return error;
    }
  return {};
}

std::string add_element(Body& body, const Element& element, Form form, SurfaceMesh& mesh) {
  if (element.count == 0) return {};
  if (element.properties.empty()) return fmt::format("element {:.20} has no properties", element.name);
  if (static_cast<double>(element.count) * static_cast<double>(element.least_bytes(form)) > static_cast<double>(body.left()) + 1.0)
    return fmt::format("counts {} of element {:.20}, more than its {} bytes can hold", element.count, element.name, body.left());
  if (element.name == "edge" || element.name == "tristrips") return fmt::format("holds {:.20} beside faces", element.name);
  if (element.name == "vertex") return add_vertices(body, element, mesh);
  return walk(body, element, element.name == "face" ? &mesh : nullptr);
}

}  // namespace

Result<SurfaceMesh> parse_ply(std::string_view bytes) {
  const Result<Header> header = parse_header(bytes);
  if (!header) return header.error();
  SurfaceMesh mesh;
  Body body(header->body, header->form);
  for (const Element& element : header->elements)
    if (const std::string error = add_element(body, element, header->form, mesh); !error.empty()) return bad_input(error);
  return mesh;
}

}  // namespace burrhole
