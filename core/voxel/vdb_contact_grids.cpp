#include "core/voxel/vdb_contact_grids.h"

#include <openvdb/openvdb.h>

namespace burrhole {

struct VdbContactGrids::Impl {
  openvdb::FloatGrid::Ptr density = openvdb::FloatGrid::create(0.0f);
  openvdb::Vec3SGrid::Ptr gradient = openvdb::Vec3SGrid::create(openvdb::Vec3f(0.0f));
  // An accessor caches the last leaf: the locality of the point shell is what makes this storage usable.
  openvdb::FloatGrid::ConstAccessor density_probe = density->getConstAccessor();
  openvdb::Vec3SGrid::ConstAccessor gradient_probe = gradient->getConstAccessor();
  std::size_t listener = 0;

  void write(Voxmap& voxmap, const VoxelBox& box) {
    std::vector<float> d(box.count());
    std::vector<Vec3f> g(box.count());
    voxmap.read_density(box, d);
    voxmap.read_gradient(box, g);
    auto write_density = density->getAccessor();
    auto write_gradient = gradient->getAccessor();
    std::size_t n = 0;
    for_each_voxel(box, [&](const Vec3i& v) {
      const openvdb::Coord c(v.x, v.y, v.z);
      if (d[n] != write_density.getValue(c)) write_density.setValue(c, d[n]);
      const openvdb::Vec3f value(g[n].x, g[n].y, g[n].z);
      if (value != write_gradient.getValue(c)) write_gradient.setValue(c, value);
      ++n;
    });
  }
};

VdbContactGrids::VdbContactGrids(Voxmap& voxmap) : impl_(std::make_unique<Impl>()) {
  impl_->listener = voxmap.add_listener();
  const VoxelBox all = voxmap.bone().bounds().grown(1);
  for (int k = all.lo.z; k < all.hi.z; k += 8)
    impl_->write(voxmap, {{all.lo.x, all.lo.y, k}, {all.hi.x, all.hi.y, std::min(k + 8, all.hi.z)}});
}
VdbContactGrids::~VdbContactGrids() = default;

void VdbContactGrids::update(Voxmap& voxmap) {
  for (const VoxelBox& box : voxmap.take_dirty(impl_->listener)) impl_->write(voxmap, box);
}

float VdbContactGrids::density(const Vec3i& v) const noexcept { return impl_->density_probe.getValue(openvdb::Coord(v.x, v.y, v.z)); }

Vec3f VdbContactGrids::gradient(const Vec3i& v) const noexcept {
  const openvdb::Vec3f g = impl_->gradient_probe.getValue(openvdb::Coord(v.x, v.y, v.z));
  return {g.x(), g.y(), g.z()};
}

}  // namespace burrhole
