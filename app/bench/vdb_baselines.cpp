#include "app/bench/vdb_baselines.h"

#include <openvdb/openvdb.h>

#include "core/base/portable_math.h"

namespace burrhole {
namespace {

constexpr float kLeastHardness = 0.1f;  // of the rate law, see core/drill/erosion.h

openvdb::Coord coord(const Vec3i& v) { return {v.x, v.y, v.z}; }

/// @returns a grid with a leaf for every voxel of the box.
template <class Grid = openvdb::FloatGrid>
typename Grid::Ptr make_grid(const VoxelBox& box, std::span<const typename Grid::ValueType> values) {
  auto grid = Grid::create();
  auto write = grid->getAccessor();
  std::size_t n = 0;
  for_each_voxel(box, [&](const Vec3i& v) { write.setValueOn(coord(v), values[n++]); });
  return grid;
}

std::vector<float> read_grid(const openvdb::FloatGrid& grid, const VoxelBox& box) {
  std::vector<float> out;
  auto read = grid.getConstAccessor();
  for_each_voxel(box, [&](const Vec3i& v) { out.push_back(read.getValue(coord(v))); });
  return out;
}

}  // namespace

struct VdbErosion::Impl {
  ErosionPoints points;
  VoxelBox box;
  std::vector<float> as_made;
  openvdb::FloatGrid::Ptr occupancy, hardness, density, remaining;
  openvdb::DoubleGrid::Ptr exposure;  // double: exact sums of float factors, as in the window; 0 between steps
  std::vector<openvdb::Coord> touched;
};

VdbErosion::VdbErosion(const ErosionPoints& points, const MasterWindow& window) : impl_(std::make_unique<Impl>()) {
  impl_->points = points;
  impl_->box = window.box;
  impl_->as_made = window.remaining;
  impl_->occupancy = make_grid(window.box, window.occupancy);
  impl_->hardness = make_grid(window.box, window.hardness);
  impl_->density = make_grid(window.box, window.density);
  impl_->remaining = make_grid(window.box, window.remaining);
  impl_->exposure = make_grid<openvdb::DoubleGrid>(window.box, std::vector<double>(window.box.count(), 0.0));
}
VdbErosion::~VdbErosion() = default;

void VdbErosion::reset() {
  auto write = impl_->remaining->getAccessor();
  std::size_t n = 0;
  for_each_voxel(impl_->box, [&](const Vec3i& v) { write.setValueOnly(coord(v), impl_->as_made[n++]); });
}

void VdbErosion::step_rate(const VdbErosionStep& step) {
  Impl& d = *impl_;
  auto density = d.density->getConstAccessor();
  auto exposure = d.exposure->getAccessor();
  d.touched.clear();
  for (std::size_t n = 0; n < d.points.size(); ++n) {
    const openvdb::Coord v = coord(voxel_of(step.index_from_tool * d.points.positions[n]));
    if (density.getValue(v) == 0.0f) continue;
    exposure.modifyValue(v, [&](double& sum) {
      if (sum == 0.0) d.touched.push_back(v);
      sum += static_cast<double>(d.points.factors[n]);
    });
  }
  // A point represents a cube of edge pitch; in index space voxels have edge 1.
  const double relative_pitch = d.points.pitch * std::cbrt(std::abs(glm::determinant(step.index_from_tool.linear)));
  const double rate = step.spin * relative_pitch * relative_pitch * relative_pitch;
  auto occupancy = d.occupancy->getConstAccessor();
  auto hardness = d.hardness->getConstAccessor();
  auto remaining = d.remaining->getAccessor();
  for (const openvdb::Coord& v : d.touched) {
    const double lambda = exposure.getValue(v) * rate;
    exposure.setValueOnly(v, 0.0);
    const double h = static_cast<double>(std::max(hardness.getValue(v), kLeastHardness));
    float after = static_cast<float>(static_cast<double>(remaining.getValue(v)) * portable_exp(-lambda * step.dt / h));
    if (occupancy.getValue(v) * after < step.minimum_density) after = 0.0f;
    remaining.setValueOnly(v, after);
  }
}

void VdbErosion::step_per_update(const VdbErosionStep& step) {
  Impl& d = *impl_;
  auto occupancy = d.occupancy->getConstAccessor();
  auto keeps = d.exposure->getAccessor();  // product of the points' factors minus 1: 0 between steps, as the sums are
  d.touched.clear();
  for (std::size_t n = 0; n < d.points.size(); ++n) {
    const openvdb::Coord v = coord(voxel_of(step.index_from_tool * d.points.positions[n]));
    if (occupancy.getValue(v) == 0.0f) continue;
    const double keep = std::max(0.0, 1.0 - static_cast<double>(d.points.factors[n]) * step.spin);  // [AcostaLiu07] eq. 4
    keeps.modifyValue(v, [&](double& lost) {
      if (lost == 0.0) d.touched.push_back(v);
      lost = (lost + 1.0) * keep - 1.0;
    });
  }
  auto remaining = d.remaining->getAccessor();
  for (const openvdb::Coord& v : d.touched) {
    const double keep = keeps.getValue(v) + 1.0;
    keeps.setValueOnly(v, 0.0);
    remaining.modifyValue(v, [&](float& left) {
      left = static_cast<float>(static_cast<double>(left) * keep);
      if (occupancy.getValue(v) * left < step.minimum_density) left = 0.0f;
    });
  }
}

std::vector<float> VdbErosion::remaining() const { return read_grid(*impl_->remaining, impl_->box); }

struct VdbGradient::Impl {
  VoxelBox box;
  float dead_zone = 0.0f;
  openvdb::FloatGrid::Ptr occupancy, remaining, density;
  openvdb::Vec3SGrid::Ptr gradient = openvdb::Vec3SGrid::create(openvdb::Vec3f(0.0f));
};

VdbGradient::VdbGradient(const MasterWindow& window, float dead_zone) : impl_(std::make_unique<Impl>()) {
  impl_->box = window.box;
  impl_->dead_zone = dead_zone;
  impl_->occupancy = make_grid(window.box, window.occupancy);
  impl_->remaining = make_grid(window.box, window.remaining);
  impl_->density = make_grid(window.box, window.density);
  auto write = impl_->gradient->getAccessor();
  std::vector<Vec3f> gradient(window.box.count());
  derive_gradient(window, window.box, gradient);
  std::size_t n = 0;
  for_each_voxel(window.box, [&](const Vec3i& v) {
    const Vec3f& g = gradient[n++];
    write.setValueOn(coord(v), openvdb::Vec3f(g.x, g.y, g.z));
  });
}
VdbGradient::~VdbGradient() = default;

void VdbGradient::commit(const VoxelBox& touched) {
  auto occupancy = impl_->occupancy->getConstAccessor();
  auto remaining = impl_->remaining->getConstAccessor();
  auto density = impl_->density->getAccessor();
  for_each_voxel(touched,
                 [&](const Vec3i& v) { density.setValueOnly(coord(v), occupancy.getValue(coord(v)) * remaining.getValue(coord(v))); });
  auto read = impl_->density->getConstAccessor();
  auto gradient = impl_->gradient->getAccessor();
  const float shortest2 = impl_->dead_zone * impl_->dead_zone;
  for_each_voxel(touched.grown(1), [&](const Vec3i& v) {
    const auto along = [&](int x, int y, int z) {
      return 0.5f * (read.getValue(coord(v).offsetBy(x, y, z)) - read.getValue(coord(v).offsetBy(-x, -y, -z)));
    };
    const openvdb::Vec3f g(along(1, 0, 0), along(0, 1, 0), along(0, 0, 1));
    const float length2 = g.x() * g.x() + g.y() * g.y() + g.z() * g.z();
    gradient.setValueOnly(coord(v), length2 < shortest2 ? openvdb::Vec3f(0.0f) : g);
  });
}

std::vector<float> VdbGradient::density() const { return read_grid(*impl_->density, impl_->box); }

std::vector<Vec3f> VdbGradient::gradient() const {
  std::vector<Vec3f> out;
  auto read = impl_->gradient->getConstAccessor();
  for_each_voxel(impl_->box, [&](const Vec3i& v) {
    const openvdb::Vec3f g = read.getValue(coord(v));
    out.emplace_back(g.x(), g.y(), g.z());
  });
  return out;
}

}  // namespace burrhole
