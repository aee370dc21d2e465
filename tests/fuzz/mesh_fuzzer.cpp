// Any bytes as STL, OBJ or PLY: what is read has whole triangles over vertices that are there, and can be asked whether it is closed.
#include <cstdlib>
#include <string_view>

#include "volumes/read/mesh_formats.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace burrhole;
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto mesh = data[0] % 3 == 0 ? parse_stl(bytes) : data[0] % 3 == 1 ? parse_obj(bytes) : parse_ply(bytes);
  if (!mesh) return 0;
  if (mesh->indices.size() % 3 != 0) std::abort();
  for (const std::uint32_t index : mesh->indices)
    if (index >= mesh->positions.size()) std::abort();
  for (const Vec3& p : mesh->positions)
    if (!is_finite(p)) return 0;  // told by the caller
  if (check_mesh(*mesh).triangles != mesh->indices.size() / 3) std::abort();
  return 0;
}
