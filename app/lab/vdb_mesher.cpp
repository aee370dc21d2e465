#include "app/lab/vdb_mesher.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

#include <array>
#include <utility>

namespace burrhole {
namespace {

using Grid = openvdb::FloatGrid;

constexpr double kLevel = 0.5;
constexpr int kMargin = 2;  // [voxels] a cell next to the box, and the voxel beyond it

Grid::Ptr make_grid(const DensityBlock& block, const VoxelBox& box) {
  Grid::Ptr grid = Grid::create(0.0f);
  auto write = grid->getAccessor();
  for_each_voxel(box.intersect(block.box), [&](const Vec3i& v) {
    const float value = block.density[block.box.offset_of(v)];
    if (value != 0.0f) write.setValueOn({v.x, v.y, v.z}, value);
  });
  return grid;
}

}  // namespace

struct VdbMesher::Impl {
  Grid::Ptr grid;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;

  void extract(const Grid& from) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    points.clear();
    triangles.clear();
    quads.clear();
    openvdb::tools::volumeToMesh(from, points, triangles, quads, kLevel, 0.0);
  }
};

VdbMesher::VdbMesher(const DensityBlock& block) : impl_(std::make_unique<Impl>()) {
  openvdb::initialize();
  impl_->grid = make_grid(block, block.box);
  impl_->grid->pruneGrid();
}
VdbMesher::~VdbMesher() = default;

void VdbMesher::write(const DensityBlock& block, const VoxelBox& changed) {
  auto write = impl_->grid->getAccessor();
  for_each_voxel(changed.intersect(block.box), [&](const Vec3i& v) {
    const float value = block.density[block.box.offset_of(v)];
    if (value != 0.0f)
      write.setValueOn({v.x, v.y, v.z}, value);
    else
      write.setValueOff({v.x, v.y, v.z}, value);
  });
}

void VdbMesher::extract() { impl_->extract(*impl_->grid); }

void VdbMesher::extract_box(const DensityBlock& block, const VoxelBox& changed) {
  impl_->extract(*make_grid(block, changed.grown(kMargin)));
}

SurfaceMesh VdbMesher::surface() const {
  SurfaceMesh out;
  for (const openvdb::Vec3s& p : impl_->points) out.positions.emplace_back(p.x(), p.y(), p.z());
  for (const openvdb::Vec3I& triangle : impl_->triangles)
    for (int n = 0; n < 3; ++n) out.indices.push_back(triangle[n]);
  for (const openvdb::Vec4I& quad : impl_->quads) {
    const auto apart = [&](int m, int n) { return (impl_->points[quad[m]] - impl_->points[quad[n]]).lengthSqr(); };
    const int first = apart(0, 2) <= apart(1, 3) ? 0 : 1;
    for (const int n : {0, 1, 2, 0, 2, 3}) out.indices.push_back(quad[(first + n) % 4]);
  }
  // The orientation depends on the class of the grid; a solid has a positive volume.
  if (check_mesh(out).volume < 0.0)
    for (std::size_t n = 0; n + 2 < out.indices.size(); n += 3) std::swap(out.indices[n + 1], out.indices[n + 2]);
  return out;
}

std::size_t VdbMesher::bytes() const {
  return static_cast<std::size_t>(impl_->grid->memUsage()) + impl_->points.capacity() * sizeof(openvdb::Vec3s) +
         impl_->triangles.capacity() * sizeof(openvdb::Vec3I) + impl_->quads.capacity() * sizeof(openvdb::Vec4I);
}

}  // namespace burrhole
