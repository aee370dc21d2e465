#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "volumes/read/mesh_formats.h"
#include "volumes/read/text_words.h"

namespace burrhole {
namespace {

/// Words that do not affect the shape of the surface.
constexpr std::array<std::string_view, 14> kIgnored = {"vt",     "vn",     "g",     "o",        "s",        "mg",     "usemtl",
                                                       "mtllib", "usemap", "bevel", "c_interp", "d_interp", "maplib", "lod"};

class ObjParser {
 public:
  /// @returns the error of the line, empty if none.
  std::string add_line(std::string_view line) {
    Words words(line.substr(0, line.find('#')));
    const std::string_view key = words.next();
    if (key.empty() || std::find(kIgnored.begin(), kIgnored.end(), key) != kIgnored.end()) return {};
    if (key == "v") return add_vertex(words);
    if (key == "f") return add_face(words);
    if (key == "l" || key == "p") return "points or lines beside faces";
    return fmt::format("\"{:.20}\" is not a word of a polygon mesh", key);
  }

  /// Faces may name later vertices, so polygons are triangulated at the end.
  Result<SurfaceMesh> finish() {
    std::size_t first = 0;
    std::uint64_t steps = 0;
    for (const std::size_t end : face_ends_) {
      for (std::size_t n = first; n < end; ++n)
        if (corners_[n] >= mesh_.positions.size())
          return bad_input(fmt::format("a face names vertex {} of {}", std::size_t{corners_[n]} + 1, mesh_.positions.size()));
      if (std::string error = append_polygon({corners_.data() + first, end - first}, mesh_, steps); !error.empty())
        return bad_input(std::move(error));
      first = end;
    }
    return std::move(mesh_);
  }

 private:
  std::string add_vertex(Words& words) {
    const auto x = number_of<double>(words.next()), y = number_of<double>(words.next()), z = number_of<double>(words.next());
    if (!x || !y || !z) return "a vertex needs three numbers";
    mesh_.positions.emplace_back(*x, *y, *z);
    return {};
  }

  std::string add_face(Words& words) {
    const std::size_t first = corners_.size();
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      const auto number = number_of<std::int64_t>(word.substr(0, word.find('/')));
      // Counted from 1; negative numbers count back from the latest vertex.
      const auto last = static_cast<std::int64_t>(mesh_.positions.size());
      const std::int64_t index = !number ? -1 : *number < 0 ? last + *number : *number - 1;
      if (index < 0 || index >= std::numeric_limits<std::uint32_t>::max()) return fmt::format("\"{:.20}\" names no vertex", word);
      corners_.push_back(static_cast<std::uint32_t>(index));
    }
    const std::size_t count = corners_.size() - first;
    if (count < 3 || count > kMaxPolygonCorners) return fmt::format("a face of {} corners, 3 to {} are read", count, kMaxPolygonCorners);
    face_ends_.push_back(corners_.size());
    return {};
  }

  SurfaceMesh mesh_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::size_t> face_ends_;
};

}  // namespace

Result<SurfaceMesh> parse_obj(std::string_view bytes) {
  ObjParser parser;
  Lines lines(bytes);
  std::string joined;  // lines that end in a backslash, joined
  for (std::string_view line; lines.next(line);) {
    if (!line.empty() && line.back() == '\\') {
      joined.append(line.substr(0, line.size() - 1)).append(1, ' ');
      continue;
    }
    const std::string error = joined.empty() ? parser.add_line(line) : parser.add_line(joined.append(line));
    if (!error.empty()) return bad_input(fmt::format("line {}: {}", lines.number(), error));
    joined.clear();
  }
  if (!joined.empty()) return bad_input("ends within a line");
  return parser.finish();
}

}  // namespace burrhole
