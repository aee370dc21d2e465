#include "core/voxel/vdb_grids.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <ostream>
#include <system_error>

#include "core/base/assert.h"
#include "core/base/input_file.h"
#include "core/base/output_stream.h"
#include "core/voxel/vdb_header.h"

namespace burrhole {
namespace {

using Grid = openvdb::FloatGrid;
using Tree = Grid::TreeType;
using Leaf = Tree::LeafNodeType;

constexpr const char* kAffineKey = "burrhole_bone_from_index";

void start_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

openvdb::Coord coord(const Vec3i& v) { return {v.x, v.y, v.z}; }

VoxelBox box_of(const openvdb::CoordBBox& b) {
  return {{b.min().x(), b.min().y(), b.min().z()}, {b.max().x() + 1, b.max().y() + 1, b.max().z() + 1}};
}

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

/// Writes what io::File would, which opens a file of its own and does not check whether its writes succeed.
class CheckedArchive final : public openvdb::io::Archive {
 public:
  void write_grids(std::ostream& out, const openvdb::GridCPtrVec& grids) const { Archive::write(out, grids, /*seekable=*/true); }
};

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
      const auto is_background = [&] {
        for (int k = part.lo.z; k < part.hi.z; ++k)
          for (int j = part.lo.y; j < part.hi.y; ++j) {
            const float* row = &in[box.offset_of({part.lo.x, j, k})];
            bool same = true;
            for (int i = 0; i < part.hi.x - part.lo.x; ++i) same = same && row[i] == background;
            if (!same) return false;
          }
        return true;
      };
      if (tree.getValue(origin) == background && is_background()) return;
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

FloatVdb::Part FloatVdb::part_from(float least) const {
  Part out;
  const auto& tree = impl_->grid->tree();
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const openvdb::Coord origin = leaf->origin();
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      if (!leaf->isValueOn(n) || !(leaf->getValue(n) >= least)) continue;
      const openvdb::Coord at = origin + Leaf::offsetToLocalCoord(n);
      out.box.include({at.x(), at.y(), at.z()});
      ++out.voxels;
    }
  }
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (!(*tile >= least)) continue;
    const VoxelBox box = box_of(tile.getBoundingBox());
    out.box = out.box.unite(box);
    out.voxels += box.count();
  }
  return out;
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

void FloatVdb::for_each_region(const std::function<void(const VoxelBox&)>& f) const {
  const auto& tree = impl_->grid->tree();
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    openvdb::CoordBBox box;
    leaf->evalActiveBoundingBox(box, true);
    if (!box.empty()) f(box_of(box));
  }
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) f(box_of(tile.getBoundingBox()));
}

VoxelBox FloatVdb::active_bounds() const {
  const openvdb::CoordBBox b = impl_->grid->evalActiveVoxelBoundingBox();
  return b.empty() ? VoxelBox() : box_of(b);
}

Status write_vdb(const std::string& path, const Vec3i& dims, const Affine& bone_from_index, std::span<const FloatVdb* const> grids,
                 const std::string& notes, const std::atomic<bool>* stop) {
  auto file = OutputFile::create(path, stop);
  if (!file) return file.error();
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
      if (!notes.empty()) copy->insertMeta("burrhole_notes", openvdb::StringMetadata(notes));
      copy->setSaveFloatAsHalf(false);
      out.push_back(copy);
    }
    OutputStreambuf buffer(*file);
    std::ostream stream(&buffer);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    CheckedArchive().write_grids(stream, out);
  } catch (const std::exception& e) {
    if (Status written = file->write(""); !written) return written;
    return bad_input(std::string("cannot be written: ") + e.what(), path);
  }
  const auto done = file->commit();
  return done ? Status() : Status(done.error());
}

namespace {

static_assert(openvdb::OPENVDB_FILE_VERSION >= kNewestVdbVersion);

/// @returns why OpenVDB may not read a file.
std::optional<std::string> start_fault(const std::string& path) {
  if (Status regular = check_regular_file(path); !regular) return regular.error().message;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return "cannot be read: " + error.message();
  std::ifstream stream(path, std::ios::binary);
  return vdb_header_fault(stream, size);
}

/// All grids of a file. Read as a stream that throws at its end: io::File does not check whether reads succeed, and builds
/// trees from whatever was in memory (measured: up to 9 GB, or without end, from 100 kB with a few damaged bytes). What is left is a length
/// of a name that vdb_header_fault() did not see, up to 4 GB for a moment, and what OpenVDB loses when reading throws within a tree: a path of nodes, once a refused file.
openvdb::GridPtrVecPtr read_all_grids(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  return openvdb::io::Stream(stream, /*delayLoad=*/false).getGrids();
}

}  // namespace

Result<VdbFileContent> read_vdb(const std::string& path) {
  start_openvdb();
  if (const auto fault = start_fault(path)) return bad_input(*fault, path);
  try {
    VdbFileContent content;
    const openvdb::GridPtrVecPtr grids = read_all_grids(path);  // held: a range-for does not keep what a dereferenced temporary points to
    for (const auto& base : *grids) {
      const Grid::Ptr grid = openvdb::gridPtrCast<Grid>(base);
      if (!grid) continue;
      if (const auto affine = grid->getMetadata<openvdb::Mat4DMetadata>(kAffineKey)) content.bone_from_index = affine_of(affine->value());
      if (const auto dims = grid->getMetadata<openvdb::Vec3IMetadata>("burrhole_dims")) {
        const openvdb::Vec3i d = dims->value();
        content.dims = {d.x(), d.y(), d.z()};
      }
      if (const auto notes = grid->getMetadata<openvdb::StringMetadata>("burrhole_notes")) content.notes = notes->value();
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

namespace {

std::string quoted(const std::string& name) { return "\"" + name + "\""; }

/// The float grid of that name, or without a name the one with most active voxels, the first when equal; null when there is none.
Grid::Ptr choose_grid(const openvdb::GridPtrVec& grids, const std::string& name) {
  Grid::Ptr best;
  for (const auto& base : grids) {
    const Grid::Ptr grid = openvdb::gridPtrCast<Grid>(base);
    if (!grid || (!name.empty() && grid->getName() != name)) continue;
    if (!best || grid->activeVoxelCount() > best->activeVoxelCount()) best = grid;
  }
  return best;
}

Error no_float_grid(const openvdb::GridPtrVec& grids, const std::string& name) {
  std::string names;
  for (const auto& grid : grids)
    if (grid->isType<Grid>()) names += (names.empty() ? "" : ", ") + quoted(grid->getName());
  return bad_input(names.empty() ? "holds no float grid" : "holds no float grid " + quoted(name) + "; it has " + names);
}

Result<ForeignGrid> take_foreign(const openvdb::GridPtrVec& grids, const std::string& name) {
  const Grid::Ptr grid = choose_grid(grids, name);
  if (!grid) return no_float_grid(grids, name);
  const auto affine = grid->transform().isLinear() ? grid->transform().baseMap()->getAffineMap() : nullptr;
  if (!affine) return bad_input("grid " + quoted(grid->getName()) + " lies in a camera's frustum, not on an affine grid");
  FloatVdb wrapped(grid->getName(), grid->background());
  wrapped.impl().grid = grid;
  ForeignGrid out{
      std::move(wrapped), grid->getGridClass() == openvdb::GRID_LEVEL_SET, affine_of(affine->getMat4()), grid->activeVoxelCount(), {}, 0};
  if (out.active == 0) return bad_input("grid " + quoted(grid->getName()) + " is empty");
  for (const auto& other : grids) {
    if (!other->isType<Grid>()) ++out.other_type;
    if (other->isType<Grid>() && other != grid) out.other_float.push_back(other->getName());
  }
  return out;
}

}  // namespace

Result<ForeignGrid> read_foreign_grid(const std::string& path, const std::string& name) {
  start_openvdb();
  if (const auto fault = start_fault(path)) return bad_input(*fault, path);
  try {
    const openvdb::GridPtrVecPtr grids = read_all_grids(path);
    Result<ForeignGrid> out = take_foreign(*grids, name);
    if (!out) return bad_input(out.error().message, path);
    return out;
  } catch (const std::exception& e) {
    return bad_input(std::string("cannot be read as .vdb: ") + e.what(), path);
  }
}

}  // namespace burrhole
