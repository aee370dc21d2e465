#include "core/drill/erosion_memory.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/bounds.h"
#include "core/drill/cut_face.h"
#include "core/tool/field_sampler.h"

namespace burrhole {
namespace {

constexpr std::uint64_t kBlockOverhead = 64;  // [bytes] of the allocator and of the table of blocks, for each block
// [bytes] of the tile in which SurfaceReader makes the records of a block: 36 bytes a voxel of the block and seven voxels round it.
constexpr std::uint64_t kTileBytes = 36 * 22 * 22 * 22;
constexpr double kLongestStep = 2.0;  // [voxels] between two poses at which blocks are counted

/// Distances [voxel edges] of voxels to a cutting part at a pose.
class PosedField {
 public:
  PosedField(const CuttingField& field, const Affine& index_from_tool, double edge)
      : sampler_(field),
        edge_(static_cast<float>(edge)),
        place_(Affine::scaling(1.0 / field.pitch, -field.origin / field.pitch) * index_from_tool.inverse()) {}
  [[nodiscard]] double operator()(const Vec3& index) const noexcept {
    return static_cast<double>(sampler_.distance(Vec3f(place_ * index)) / edge_);
  }

 private:
  FieldSampler sampler_;
  float edge_;
  Affine place_;
};

/// Whether a voxel of the block is within the band of the cutting part.
bool reaches(const PosedField& distance, const Vec3i& block) {
  constexpr double kHalf = 0.5 * (kBlockEdge - 1);
  const double middle = distance(Vec3(block * kBlockEdge) + kHalf);
  if (middle <= static_cast<double>(CutFace::kFollow)) return true;
  if (middle > static_cast<double>(CutFace::kFollow) + 1.05 * std::sqrt(3.0) * kHalf) return false;
  bool near = false;
  for_each_voxel(box_of_block(block), [&](const Vec3i& v) { near = near || distance(Vec3(v)) <= static_cast<double>(CutFace::kFollow); });
  return near;
}

/// Points, their runs along the lattice, the order of the points while the runs are made, and the sums by voxel.
std::uint64_t scatter_bytes(const ErosionConfig& config, const ErosionPoints& points, const Affine& index_from_tool) {
  const std::uint64_t lists = config.form == ErosionForm::scatter ? PointScatter(points).bytes() : 0;
  const auto [lo, hi] = bounds_under(index_from_tool, bounds_of_points(points.positions));
  const Vec3 size = glm::ceil(hi - lo) + 1.0;
  const double row = 8.0 * std::ceil((size.x + 7.0) / 8.0);  // rows are whole vectors
  const auto sums = static_cast<std::uint64_t>(row * size.y * size.z) * sizeof(std::int64_t);
  return points.size() * (sizeof(Vec3) + sizeof(float)) + lists + points.size() * sizeof(std::uint32_t) + sums;
}

}  // namespace

std::uint64_t count_cut_blocks(const CuttingField& field, const DrillingWay& way, double voxel_edge) {
  if (field.empty()) return 0;
  const int steps = std::max(1, static_cast<int>(std::ceil(glm::length(way.along) / kLongestStep)));
  const double reach = static_cast<double>(CutFace::kFollow) * voxel_edge;
  std::set<std::uint64_t> found;
  for (int n = 0; n <= steps; ++n) {
    const Affine pose{way.index_from_tool.linear, way.index_from_tool.offset + way.along * (static_cast<double>(n) / steps)};
    const PosedField distance(field, pose, voxel_edge);
    const auto [lo, hi] = bounds_under(pose, {field.bounds.lo - reach, field.bounds.hi + reach});
    for_each_voxel(blocks_of({Vec3i(glm::ceil(lo)), Vec3i(glm::floor(hi)) + 1}), [&](const Vec3i& block) {
      const std::uint64_t key = key_of_block(block);
      if (!found.contains(key) && reaches(distance, block)) found.insert(key);
    });
  }
  return found.size();
}

std::uint64_t erosion_bytes(const ErosionConfig& config, const Tool& tool, const DrillingWay& way, double voxel_edge,
                            std::uint64_t window_voxels) {
  if (config.subvoxel) {
    if (!tool.cutting) return 0;
    const std::size_t nodes = CutFace::reserved_nodes(*tool.cutting, voxel_edge);
    return tool.cutting->bytes() +
           count_cut_blocks(*tool.cutting, way, voxel_edge) * (sizeof(CutSurface::Block) + CutFace::quiet_bytes() + 2 * kBlockOverhead) +
           CutFace::list_bytes(nodes) + sizeof(CutFace) + kTileBytes;
  }
  if (config.law == ErosionLaw::threshold || config.law == ErosionLaw::progressive) return window_voxels / 512 * sizeof(TileMarks::Tile);
  if (config.law != ErosionLaw::energy) return scatter_bytes(config, tool.erosion, way.index_from_tool);
  return tool.erosion.size() * (sizeof(Vec3) + sizeof(float)) + window_voxels * sizeof(std::uint32_t);
}

}  // namespace burrhole
