#include "volumes/read/mesh_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <new>

#include "core/base/input_file.h"
#include "volumes/read/mesh_formats.h"

namespace burrhole {
namespace {

namespace fs = std::filesystem;

/// First bytes of a text STL and of any PLY; a binary STL has no fixed first bytes.
std::string format_by_content(const std::string& path) {
  if (!check_regular_file(path)) return "";
  std::array<char, 6> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  const std::string_view text(first.data(), static_cast<std::size_t>(file.gcount()));
  if (text.starts_with("ply\n") || text.starts_with("ply\r")) return "PLY";
  return text == "solid " ? "STL" : "";
}

Result<std::string> read_bytes(const std::string& path) {
  auto bytes = read_input(path, kMeshInput);
  if (!bytes) return Error{bytes.error().code, bytes.error().message, {}};  // the caller adds the path
  if (bytes->empty()) return bad_input("is empty");
  return bytes;
}

Result<SurfaceMesh> parse(const std::string& bytes, const std::string& format) {
  return format == "STL" ? parse_stl(bytes) : format == "OBJ" ? parse_obj(bytes) : parse_ply(bytes);
}

Result<SurfaceMesh> read_and_weld(const std::string& path, double unit) {
  const std::string format = mesh_format(path);
  if (format.empty()) return bad_input("is not a supported mesh: .stl, .obj or .ply");
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return bytes.error();
  Result<SurfaceMesh> mesh = parse(*bytes, format);
  if (!mesh) return mesh;
  if (mesh->indices.empty()) return bad_input("holds no triangles");
  for (Vec3& p : mesh->positions) {
    p *= unit;
    if (!is_finite(p)) return bad_input("holds a vertex that is not finite");
  }
  return weld(*mesh);
}

}  // namespace

std::string mesh_format(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  for (const char* const format : {"STL", "OBJ", "PLY"})
    if (ending == std::string(".") + format) return format;
  return format_by_content(path);
}

Result<SurfaceMesh> read_mesh(const std::string& path, double unit) {
  try {
    Result<SurfaceMesh> mesh = read_and_weld(path, unit);
    if (mesh) return mesh;
    return bad_input(mesh.error().message, path);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::unavailable, "no memory for the mesh", path};
  }
}

}  // namespace burrhole
