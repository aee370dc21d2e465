#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "volumes/read/mesh_formats.h"
#include "volumes/read/text_words.h"

namespace burrhole {
namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50;  // [bytes]

Error line_error(const Lines& lines, const std::string& what) { return bad_input(fmt::format("line {}: {}", lines.number(), what)); }

/// Little-endian, as the supported machines.
Result<SurfaceMesh> parse_binary(std::string_view bytes) {
  SurfaceMesh mesh;
  const std::size_t count = (bytes.size() - kHeader) / kTriangle;
  mesh.positions.reserve(3 * count);
  mesh.indices.reserve(3 * count);
  for (std::size_t n = 0; n < count; ++n) {
    float numbers[12];  // the normal is not used: the order of the corners defines it
    std::memcpy(numbers, bytes.data() + kHeader + n * kTriangle, sizeof numbers);
    for (std::size_t c = 3; c < 12; c += 3) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.emplace_back(numbers[c], numbers[c + 1], numbers[c + 2]);
    }
  }
  return mesh;
}

std::string lower(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return out;
}

Result<SurfaceMesh> parse_text(std::string_view text) {
  SurfaceMesh mesh;
  Lines lines(text);
  std::size_t corners = 0;
  bool in_solid = false, in_facet = false;
  for (std::string_view line; lines.next(line);) {
    Words words(line);
    const std::string key = lower(words.next());
    if (key.empty()) continue;
    if (key == "vertex" && in_facet) {
      const auto x = number_of<double>(words.next()), y = number_of<double>(words.next()), z = number_of<double>(words.next());
      if (!x || !y || !z) return line_error(lines, "a vertex needs three numbers");
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.emplace_back(*x, *y, *z);
      ++corners;
    } else if (key == "facet" && in_solid && !in_facet) {
      in_facet = true;
      corners = 0;
    } else if (key == "endfacet" && in_facet) {
      if (corners != 3) return line_error(lines, fmt::format("a facet of {} vertices", corners));
      in_facet = false;
    } else if ((key == "solid" && !in_solid) || (key == "endsolid" && in_solid && !in_facet)) {
      in_solid = key == "solid";
    } else if ((key != "outer" && key != "endloop") || !in_facet) {
      return line_error(lines, "unexpected word in a text STL");
    }
  }
  if (in_solid) return bad_input("ends without endsolid: cut off?");
  return mesh;
}

}  // namespace

Result<SurfaceMesh> parse_stl(std::string_view bytes) {
  // Binary files may begin with "solid" too. In a complete binary file the count of triangles matches the size exactly.
  std::uint32_t count = 0;
  const bool counted = bytes.size() >= kHeader;
  if (counted) std::memcpy(&count, bytes.data() + kHeader - 4, 4);
  const std::size_t needed = kHeader + kTriangle * std::size_t{count};
  if (counted && bytes.size() == needed) return parse_binary(bytes);
  const std::string_view start = bytes.substr(0, std::min<std::size_t>(bytes.size(), kHeader));
  if (lower(Words(start).next()) == "solid" && start.find('\0') == std::string_view::npos) return parse_text(bytes);
  if (!counted) return bad_input(fmt::format("has {} bytes, too few for an STL", bytes.size()));
  return bad_input(fmt::format("counts {} triangles, which take {} bytes; it has {}", count, needed, bytes.size()));
}

}  // namespace burrhole
