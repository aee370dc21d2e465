#include "app/lab/local_net.h"

#include <algorithm>

#include "core/base/bounds.h"
#include "core/base/trilinear.h"

namespace burrhole {
namespace {

constexpr int kSteps = 3;              // of Newton's method
constexpr double kLeastSquare = 1e-6;  // [1/voxel^2] of the gradient

/// Densities minus 0.5 at the corners of a cell; 0 outside of the block.
std::array<double, 8> corners_of(const DensityBlock& block, const Vec3i& cell) {
  std::array<double, 8> out{};
  const bool whole = block.box.contains(VoxelBox{cell, cell + 2});
  for (unsigned n = 0; n < 8; ++n) {
    const Vec3i v = cell + cell_corner(n);
    const bool there = whole || block.box.contains(v);
    out[n] = (there ? static_cast<double>(block.density[block.box.offset_of(v)]) : 0.0) - 0.5;
  }
  return out;
}

bool is_solid(const DensityBlock& block, const Vec3i& v) { return block.box.contains(v) && block.density[block.box.offset_of(v)] >= 0.5f; }

double value_at(const std::array<double, 8>& f, const Vec3& t) {
  return trilinear(t, [&](unsigned n) { return f[n]; });
}

Vec3 gradient_at(const std::array<double, 8>& f, const Vec3& t) {
  Vec3 out;
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    Vec3 lo = t, hi = t;
    lo[axis] = 0.0;
    hi[axis] = 1.0;
    out[axis] = value_at(f, hi) - value_at(f, lo);
  }
  return out;
}

/// @returns the mean of the crossings of the cell's edges, within the cell. @pre there is one.
Vec3 mean_crossing(const std::array<double, 8>& f) {
  Vec3 sum(0.0);
  int count = 0;
  for (unsigned n = 0; n < 8; ++n)
    for (const unsigned bit : {1u, 2u, 4u}) {
      if ((n & bit) != 0 || (f[n] >= 0.0) == (f[n | bit] >= 0.0)) continue;
      const Vec3 from(cell_corner(n)), to(cell_corner(n | bit));
      sum += from + (to - from) * (f[n] / (f[n] - f[n | bit]));
      ++count;
    }
  return sum / static_cast<double>(count);
}

Vec3 moved_onto_surface(const std::array<double, 8>& f, Vec3 t) {
  for (int step = 0; step < kSteps; ++step) {
    const Vec3 g = gradient_at(f, t);
    const double square = glm::dot(g, g);
    if (!(square > kLeastSquare)) break;
    t = glm::clamp(t - g * (value_at(f, t) / square), 0.0, 1.0);
  }
  return t;
}

}  // namespace

LocalNet::LocalNet(const VoxelBox& box, bool onto_surface) : box_(box), onto_surface_(onto_surface), cells_(VoxelBox{box.lo - 1, box.hi}) {
  edges_.fill(VertexMap(VoxelBox{box.lo - 1, box.hi}));
}

void LocalNet::fill(const DensityBlock& block) {
  cells_.clear();
  for (VertexMap& edges : edges_) edges.clear();
  positions_.clear();
  quads_.clear();
  free_vertices_.clear();
  free_quads_.clear();
  update(block, box_);
}

void LocalNet::update(const DensityBlock& block, const VoxelBox& changed) {
  const VoxelBox part = changed.intersect(box_);
  if (part.empty()) return;
  for_each_voxel(VoxelBox{part.lo - 1, part.hi}, [&](const Vec3i& cell) { place_vertex(block, cell); });
  // All edges with such a cell beside them: their quads have moved.
  for_each_voxel(VoxelBox{part.lo - 1, part.hi + 1}.intersect({box_.lo - 1, box_.hi}), [&](const Vec3i& v) { place_quads(block, v); });
}

void LocalNet::place_vertex(const DensityBlock& block, const Vec3i& cell) {
  const std::array<double, 8> f = corners_of(block, cell);
  unsigned solid = 0;
  for (unsigned n = 0; n < 8; ++n) solid |= static_cast<unsigned>(f[n] >= 0.0) << n;
  std::uint32_t vertex = cells_.find(cell);
  if (solid == 0 || solid == 0xff) {
    if (vertex == kNone) return;
    free_vertices_.push_back(vertex);
    cells_.set(cell, kNone);
    return;
  }
  if (vertex == kNone) {
    if (free_vertices_.empty()) {
      vertex = static_cast<std::uint32_t>(positions_.size());
      positions_.emplace_back();
    } else {
      vertex = free_vertices_.back();
      free_vertices_.pop_back();
    }
    cells_.set(cell, vertex);
  }
  const Vec3 mean = mean_crossing(f);
  positions_[vertex] = Vec3f(Vec3(cell) + (onto_surface_ ? moved_onto_surface(f, mean) : mean));
}

void LocalNet::place_quads(const DensityBlock& block, const Vec3i& voxel) {
  for (glm::length_t axis = 0; axis < 3; ++axis) set_quad(block, voxel, axis);
}

void LocalNet::set_quad(const DensityBlock& block, const Vec3i& voxel, glm::length_t axis) {
  Vec3i along(0), b(0), c(0);
  along[axis] = b[(axis + 1) % 3] = c[(axis + 2) % 3] = 1;
  const bool here = is_solid(block, voxel), there = is_solid(block, voxel + along);
  std::uint32_t quad = edges_[axis].find(voxel);
  if (here == there) {
    if (quad == kNone) return;
    quads_[quad][0] = kNone;
    free_quads_.push_back(quad);
    edges_[axis].set(voxel, kNone);
    return;
  }
  if (quad == kNone) {
    if (free_quads_.empty()) {
      quad = static_cast<std::uint32_t>(quads_.size());
      quads_.emplace_back();
    } else {
      quad = free_quads_.back();
      free_quads_.pop_back();
    }
    edges_[axis].set(voxel, quad);
  }
  Quad round{cells_.find(voxel - b - c), cells_.find(voxel - c), cells_.find(voxel), cells_.find(voxel - b)};
  if (there) std::swap(round[1], round[3]);
  const auto apart = [&](std::size_t m, std::size_t n) {
    const Vec3f between = positions_[round[m]] - positions_[round[n]];
    return glm::dot(between, between);
  };
  if (apart(1, 3) < apart(0, 2)) std::ranges::rotate(round, round.begin() + 1);
  quads_[quad] = round;
}

SurfaceMesh LocalNet::surface() const {
  SurfaceMesh out;
  std::vector<std::uint32_t> number(positions_.size(), kNone);  // of the vertices in use
  for (const Quad& quad : quads_) {
    if (quad[0] == kNone) continue;
    for (const std::size_t n : {0, 1, 2, 0, 2, 3}) {
      std::uint32_t& vertex = number[quad[n]];
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(out.positions.size());
        out.positions.emplace_back(positions_[quad[n]]);
      }
      out.indices.push_back(vertex);
    }
  }
  return out;
}

std::size_t LocalNet::bytes() const noexcept {
  std::size_t out = cells_.bytes() + positions_.capacity() * sizeof(Vec3f) + quads_.capacity() * sizeof(Quad) +
                    (free_vertices_.capacity() + free_quads_.capacity()) * sizeof(std::uint32_t);
  for (const VertexMap& edges : edges_) out += edges.bytes();
  return out;
}

}  // namespace burrhole
