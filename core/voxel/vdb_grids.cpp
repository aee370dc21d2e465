#include "core/voxel/vdb_grids.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <filesystem>
#include <mutex>

#include "core/base/assert.h"

namespace burrhole {
namespace {

using Grid = openvdb::FloatGrid;
using Leaf = Grid::TreeType::LeafNodeType;

constexpr const char* kAffineKey = "burrhole_bone_from_index";

void start_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

openvdb::Coord coord(const Vec3i& v) { return {v.x, v.y, v.z}; }

/// Calls f(leaf origin, part of the box inside that leaf).
template <class F>
void for_each_leaf_box(const VoxelBox& box, F&& f) {
  constexpr int kDim = Leaf::DIM;
  const auto floor_leaf = [](int x) { return x & ~(kDim - 1); };
  for (int z = floor_leaf(box.lo.z); z < box.hi.z; z += kDim)
    for (int y = floor_leaf(box.lo.y); y < box.hi.y; y += kDim)
      for (int x = floor_leaf(box.lo.x); x < box.hi.x; x += kDim) {
        const VoxelBox leaf{{x, y, z}, {x + kDim, y + kDim, z + kDim}};
        f(openvdb::Coord(x, y, z), box.intersect(leaf));
      }
}

openvdb::Mat4d matrix_of(const Affine& a) {
  // OpenVDB multiplies row vectors: its matrix is ours transposed.
  openvdb::Mat4d m = openvdb::Mat4d::identity();
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) m(column, row) = a.linear[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)];
  for (int row = 0; row < 3; ++row) m(3, row) = a.offset[static_cast<std::size_t>(row)];
  return m;
}

Affine affine_of(const openvdb::Mat4d& m) {
  Affine a;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) a.linear[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)] = m(column, row);
  for (int row = 0; row < 3; ++row) a.offset[static_cast<std::size_t>(row)] = m(3, row);
  return a;
}

}  // namespace

struct FloatVdb::Impl {
  Grid::Ptr grid;
  std::string name;
};

FloatVdb::FloatVdb(std::string name, float background) : impl_(std::make_unique<Impl>()) {
  start_openvdb();
  impl_->grid = Grid::create(background);
  impl_->grid->setName(name);
  impl_->name = std::move(name);
}
FloatVdb::FloatVdb(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FloatVdb::FloatVdb(FloatVdb&&) noexcept = default;
FloatVdb& FloatVdb::operator=(FloatVdb&&) noexcept = default;
FloatVdb::~FloatVdb() = default;

FloatVdb FloatVdb::clone() const {
  auto copy = std::make_unique<Impl>();
  copy->grid = impl_->grid->deepCopy();
  copy->name = impl_->name;
  return FloatVdb(std::move(copy));
}

const std::string& FloatVdb::name() const noexcept { return impl_->name; }
float FloatVdb::background() const noexcept { return impl_->grid->background(); }
float FloatVdb::value(const Vec3i& v) const { return impl_->grid->tree().getValue(coord(v)); }
std::size_t FloatVdb::bytes() const { return impl_->grid->memUsage(); }
void FloatVdb::clear() { impl_->grid->clear(); }

void FloatVdb::read_box(const VoxelBox& box, std::span<float> out) const {
  BH_ASSERT(out.size() == box.count());
  const auto& tree = impl_->grid->tree();
  for_each_leaf_box(box, [&](const openvdb::Coord& origin, const VoxelBox& part) {
    const Leaf* leaf = tree.probeConstLeaf(origin);
    const float tile = leaf == nullptr ? tree.getValue(origin) : 0.0f;
    for_each_voxel(part,
                   [&](const Vec3i& v) { out[box.offset_of(v)] = leaf == nullptr ? tile : leaf->getValue(Leaf::coordToOffset(coord(v))); });
  });
}

void FloatVdb::write_box(const VoxelBox& box, std::span<const float> in) {
  BH_ASSERT(in.size() == box.count());
  auto& tree = impl_->grid->tree();
  const float background = impl_->grid->background();
  for_each_leaf_box(box, [&](const openvdb::Coord& origin, const VoxelBox& part) {
    Leaf* leaf = tree.probeLeaf(origin);
    if (leaf == nullptr) {
      bool same = tree.getValue(origin) == background;
      if (same) for_each_voxel(part, [&](const Vec3i& v) { same = same && in[box.offset_of(v)] == background; });
      if (same) return;
      leaf = tree.touchLeaf(origin);
    }
    for_each_voxel(part, [&](const Vec3i& v) {
      const float value = in[box.offset_of(v)];
      const auto n = Leaf::coordToOffset(coord(v));
      if (value == background)
        leaf->setValueOff(n, value);
      else
        leaf->setValueOn(n, value);
    });
  });
}

void FloatVdb::for_each_sorted(const std::function<void(const Vec3i&, float)>& f) const {
  const VoxelBox bounds = active_bounds();
  if (bounds.empty()) return;
  // One slab of leaves at a time keeps the sort in bounded memory.
  std::vector<float> slab;
  for (int k = bounds.lo.z; k < bounds.hi.z; k += 8) {
    const VoxelBox part{{bounds.lo.x, bounds.lo.y, k}, {bounds.hi.x, bounds.hi.y, std::min(k + 8, bounds.hi.z)}};
    slab.resize(part.count());
    read_box(part, slab);
    std::size_t n = 0;
    for_each_voxel(part, [&](const Vec3i& v) {
      const float value = slab[n++];
      if (value != background()) f(v, value);
    });
  }
}

VoxelBox FloatVdb::active_bounds() const {
  const openvdb::CoordBBox b = impl_->grid->evalActiveVoxelBoundingBox();
  if (b.empty()) return {};
  return {{b.min().x(), b.min().y(), b.min().z()}, {b.max().x() + 1, b.max().y() + 1, b.max().z() + 1}};
}

Status write_vdb(const std::string& path, const Vec3i& dims, const Affine& bone_from_index, std::span<const FloatVdb* const> grids) {
  const std::string temporary = path + ".tmp";
  // The transform is for other programs. It takes edges for equal, and shear for none, below an absolute 5e-7, and edges below 1.4e-5 for
  // singular, so it is given in mm; the exact map is kept beside it.
  const Affine in_millimetres{bone_from_index.linear * 1e3, bone_from_index.offset * 1e3};
  try {
    openvdb::GridCPtrVec out;
    for (const FloatVdb* grid : grids) {
      Grid::Ptr copy = grid->impl().grid->copy();  // shares the tree, owns transform and metadata
      copy->setTransform(openvdb::math::Transform::createLinearTransform(matrix_of(in_millimetres)));
      copy->insertMeta(kAffineKey, openvdb::Mat4DMetadata(matrix_of(bone_from_index)));
      copy->insertMeta("burrhole_dims", openvdb::Vec3IMetadata(openvdb::Vec3i(dims.x, dims.y, dims.z)));
      copy->setSaveFloatAsHalf(false);
      out.push_back(copy);
    }
    openvdb::io::File file(temporary);
    file.write(out);
    file.close();
    std::filesystem::rename(temporary, path);
    return {};
  } catch (const std::exception& e) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return bad_input(std::string("cannot be written: ") + e.what(), path);
  }
}

Result<VdbFileContent> read_vdb(const std::string& path) {
  start_openvdb();
  try {
    openvdb::io::File file(path);
    file.open(false);
    VdbFileContent content;
    const openvdb::GridPtrVecPtr grids = file.getGrids();  // held: a range-for does not keep what a dereferenced temporary points to
    for (const auto& base : *grids) {
      const Grid::Ptr grid = openvdb::gridPtrCast<Grid>(base);
      if (!grid) continue;
      if (const auto affine = grid->getMetadata<openvdb::Mat4DMetadata>(kAffineKey)) content.bone_from_index = affine_of(affine->value());
      if (const auto dims = grid->getMetadata<openvdb::Vec3IMetadata>("burrhole_dims")) {
        const openvdb::Vec3i d = dims->value();
        content.dims = {d.x(), d.y(), d.z()};
      }
      FloatVdb wrapped(grid->getName(), grid->background());
      wrapped.impl().grid = grid;
      content.grids.push_back(std::move(wrapped));
    }
    if (content.grids.empty()) return bad_input("holds no float grid", path);
    return content;
  } catch (const std::exception& e) {
    return bad_input(std::string("cannot be read as .vdb: ") + e.what(), path);
  }
}

}  // namespace burrhole
