#include "volumes/write/bone_surface.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <exception>

namespace burrhole {
namespace {

using Grid = openvdb::FloatGrid;
using Leaf = Grid::TreeType::LeafNodeType;

constexpr double kSurface = 0.5;  ///< [-] level of the density that is the surface of bone

/// Fills whole leaves: a region may be part of one.
Grid::Ptr density_grid(const DensitySource& density) {
  Grid::Ptr grid = Grid::create(0.0f);
  auto& tree = grid->tree();
  std::vector<float> values(Leaf::SIZE);
  for (const VoxelBox& region : density.regions) {
    const auto block = [](int x) { return x & ~(static_cast<int>(Leaf::DIM) - 1); };
    const VoxelBox blocks{{block(region.lo.x), block(region.lo.y), block(region.lo.z)}, region.hi};
    for (int z = blocks.lo.z; z < blocks.hi.z; z += Leaf::DIM)
      for (int y = blocks.lo.y; y < blocks.hi.y; y += Leaf::DIM)
        for (int x = blocks.lo.x; x < blocks.hi.x; x += Leaf::DIM) {
          const VoxelBox box{{x, y, z}, Vec3i(x, y, z) + static_cast<int>(Leaf::DIM)};
          density.read(box, values);
          if (std::all_of(values.begin(), values.end(), [](float v) { return v == 0.0f; })) continue;
          Leaf* leaf = tree.touchLeaf({x, y, z});
          std::size_t n = 0;
          for_each_voxel(box, [&](const Vec3i& v) {
            const float value = values[n++];
            const auto at = Leaf::coordToOffset({v.x, v.y, v.z});
            if (value == 0.0f)
              leaf->setValueOff(at, value);
            else
              leaf->setValueOn(at, value);
          });
        }
  }
  return grid;
}

double signed_volume(const SurfaceMesh& mesh) {
  double six = 0.0;
  const Vec3 origin = mesh.positions.front();
  for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3)
    six += glm::dot(mesh.positions[mesh.indices[n]] - origin,
                    glm::cross(mesh.positions[mesh.indices[n + 1]] - origin, mesh.positions[mesh.indices[n + 2]] - origin));
  return six / 6.0;
}

/// Splits a four-sided polygon along its shorter diagonal.
void add_polygon(SurfaceMesh& mesh, const openvdb::Vec4I& quad) {
  const auto square = [&](openvdb::Index32 a, openvdb::Index32 b) {
    const Vec3 between = mesh.positions[a] - mesh.positions[b];
    return glm::dot(between, between);
  };
  const bool first = square(quad[0], quad[2]) <= square(quad[1], quad[3]);
  const std::array<int, 6> order = first ? std::array{0, 1, 2, 0, 2, 3} : std::array{1, 2, 3, 1, 3, 0};
  for (const int corner : order) mesh.indices.push_back(quad[corner]);
}

Result<SurfaceMesh> mesh_of(const Grid& grid, const Affine& bone_from_index) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, kSurface, 0.0);
  if (quads.empty() && triangles.empty()) return bad_input("there is no bone: its density reaches 0.5 nowhere");
  SurfaceMesh mesh;
  mesh.positions.reserve(points.size());
  mesh.indices.reserve(3 * triangles.size() + 6 * quads.size());
  for (const openvdb::Vec3s& p : points) mesh.positions.push_back(bone_from_index * Vec3(p.x(), p.y(), p.z()));
  for (const openvdb::Vec3I& triangle : triangles)
    for (int corner = 0; corner < 3; ++corner) mesh.indices.push_back(triangle[corner]);
  for (const openvdb::Vec4I& quad : quads) add_polygon(mesh, quad);
  // The orientation depends on the class of the grid and on the handedness of its map; a solid has a positive volume.
  if (signed_volume(mesh) < 0.0)
    for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) std::swap(mesh.indices[n + 1], mesh.indices[n + 2]);
  return mesh;
}

}  // namespace

Result<SurfaceMesh> make_bone_surface(const DensitySource& density) {
  try {
    return mesh_of(*density_grid(density), density.bone_from_index);
  } catch (const std::exception& e) {
    return Error{ErrorCode::unavailable, std::string("the surface cannot be computed: ") + e.what(), {}};
  }
}

}  // namespace burrhole
