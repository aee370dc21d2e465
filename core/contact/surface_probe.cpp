#include "core/contact/surface_probe.h"

#include <algorithm>

#include "core/base/bounds.h"
#include "core/contact/surface_probe_kernel.h"

namespace burrhole {
namespace {

void copy_matrix(const Mat3& m, const Vec3& offset, float* linear, float* moved) {
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r) linear[3 * c + r] = static_cast<float>(m[c][r]);
  for (std::size_t r = 0; r < 3; ++r) moved[r] = static_cast<float>(offset[r]);
}

// A cell holds a convex edge where the slope rises by more than kCurved, a radius of 2 voxels, or where the change of distance differs from
// the mean slope by more than kUneven [voxel edges]: a sphere of that radius has 0.01. At 1.5 and 2 times these it holds nothing else.
constexpr double kCurved = 0.5, kUneven = 0.1;

/// One axis of a cell: distance and its slope along the axis at the cell's lower and upper side, between the other axes.
struct Across {
  double distance[2] = {0.0, 0.0}, slope[2] = {0.0, 0.0};  // [voxel edges], [voxel edges per cell]

  [[nodiscard]] double turn() const noexcept { return slope[1] - slope[0]; }
  /// @returns how much of a convex edge there is [-].
  [[nodiscard]] double sharpness() const noexcept {
    if (turn() <= 0.0) return 0.0;
    const double uneven = distance[1] - distance[0] - 0.5 * (slope[0] + slope[1]);
    return std::clamp(std::max(2.0 * (turn() / kCurved - 1.0), std::abs(uneven) / kUneven - 1.0), 0.0, 1.0);
  }
};

/// Interpolates between the eight records of the cell that begins at `first`; not normalised. @param cut the cell may hold a cut surface.
template <class Record>
SurfaceSample between(const Record* first, const Vec3i& size, const Vec3& f, const Mat3& metric, bool cut, double distance_step,
                      double normal_step) {
  SurfaceSample out{0.0, Vec3(0.0), 0.0};
  Across axes[3];
  double tangent = -kRecordBand;  // the highest
  const Vec3 rest = 1.0 - f;
  for (unsigned n = 0; n < 8; ++n) {
    const Vec3i d = cell_corner(n);
    const Vec3 side(d.x != 0 ? f.x : rest.x, d.y != 0 ? f.y : rest.y, d.z != 0 ? f.z : rest.z);
    const double weight = side.x * side.y * side.z;
    const Record& r = first[(static_cast<std::ptrdiff_t>(d.z) * size.y + d.y) * size.x + d.x];
    const double distance = distance_step * r.distance;
    const Vec3 normal = normal_step * Vec3(r.nx, r.ny, r.nz), slope = normal * metric;
    out.distance += weight * distance;
    out.normal += weight * normal;
    tangent = std::max(tangent, distance + glm::dot(slope, f - Vec3(d)));
    for (std::size_t a = 0; a < 3; ++a) {
      const double share = side[(a + 1) % 3] * side[(a + 2) % 3];
      axes[a].distance[d[a]] += share * distance;
      axes[a].slope[d[a]] += share * slope[a];
    }
  }
  double sharp = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    out.distance -= 0.5 * f[a] * rest[a] * axes[a].turn();
    out.bend += axes[a].turn() / glm::dot(metric[a], metric[a]);
    sharp = std::max(sharp, axes[a].sharpness());
  }
  if (cut) out.distance += sharp * (tangent - out.distance);
  return out;
}

}  // namespace

void HitBlocks::reserve(std::size_t points) {
  // Each of the two parts of a shell ends with a block of its own; a vector may read beyond the last.
  const std::size_t room = points / kHitBlock + 2 + kShellPad;
  end.assign(room, 0);
  distance.assign(room, 0.0f);
  for (auto* axes : {&lo, &hi})
    for (std::vector<float>& axis : *axes) axis.assign(room, 0.0f);
}

void ProbeHits::reserve(std::size_t points) {
  // Vector stores may write up to one vector beyond the kept elements.
  for (LineVector<float>* array : {&x, &y, &z, &distance, &nx, &ny, &nz, &lower}) array->assign(points + kShellPad, 0.0f);
  point.assign(points + kShellPad, 0);
  blocks.reserve(points);
}

void ProbeHits::clear(bool blocked) noexcept {
  count = 0;
  blocks.count = 0;
  blocks.wanted = blocked;
  nearest = static_cast<float>(kRecordBand);
  outside = false;
  lowered = false;
}

void probe_surface(const RecordView& bone, const ContactShellPart& points, const Affine& index_from_tool, double look_ahead,
                   ProbeHits& hits) noexcept {
  if (points.size() == 0) return;
  const Vec3i size = bone.box.size();
  const bool small = bone.records8 != nullptr;
  const double edge = bone.bone_from_index.mean_edge();
  const Mat3& cell = bone.bone_from_index.linear;
  const double diagonal = std::max({glm::length(cell[0] + cell[1] + cell[2]), glm::length(cell[0] + cell[1] - cell[2]),
                                    glm::length(cell[0] - cell[1] + cell[2]), glm::length(cell[0] - cell[1] - cell[2])});
  ProbeJob job{};
  job.records8 = reinterpret_cast<const std::int8_t*>(bone.records8);
  job.records16 = reinterpret_cast<const std::int16_t*>(bone.records16);
  job.row = size.x;
  job.slab = size.x * size.y;
  const VoxelBox known{bone.valid.lo - bone.box.lo, bone.valid.hi - bone.box.lo};
  for (std::size_t a = 0; a < 3; ++a) {
    job.lo[a] = static_cast<float>(known.lo[a]);
    job.hi[a] = static_cast<float>(known.hi[a] - 1);
  }
  job.any_cut = !bone.cut.empty();
  for (std::size_t a = 0; a < 3; ++a) {
    job.cut_lo[a] = static_cast<float>(bone.cut.lo[a] - bone.box.lo[a]);
    job.cut_hi[a] = static_cast<float>(bone.cut.hi[a] - bone.box.lo[a]);
  }
  copy_matrix(index_from_tool.linear, index_from_tool.offset - Vec3(bone.box.lo), job.linear, job.offset);
  job.steps_per_edge = static_cast<float>(1.0 / (small ? kRecord8Distance : kRecord16Distance));
  job.normal_scale = static_cast<float>(small ? kRecord8Normal : kRecord16Normal);
  job.metric[0] = static_cast<float>(4.0 / kCurved) / job.steps_per_edge;
  job.metric[4] = static_cast<float>(1.0 / kUneven) / job.steps_per_edge;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t c = 0; c < 3; ++c)
      job.metric[4 * axis + 1 + c] = static_cast<float>(
          -0.5 * (small ? kRecord8Normal / kRecord8Distance : kRecord16Normal / kRecord16Distance) * cell[axis][c] / edge);
  job.diagonal = true;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t c = 0; c < 3; ++c) job.diagonal = job.diagonal && (c == axis || job.metric[4 * axis + 1 + c] == 0.0f);
  job.look_ahead = static_cast<float>(look_ahead - bone.lying);
  // The change of distance is at most the path length: half a cell's diagonal, plus a hundredth for rounding of stored values.
  job.slack = static_cast<float>(0.5 * diagonal / edge + 0.02);
  const float nearest_before = hits.nearest;
  hits.nearest = static_cast<float>(kRecordBand);
  const std::size_t hits_before = hits.count, blocks_before = hits.blocks.count;
  probe_points(job, points, hits);
  const auto lying = static_cast<float>(bone.lying);
  hits.nearest = std::min(nearest_before, hits.nearest - job.slack + lying);
  if (lying == 0.0f) return;
  for (std::size_t n = hits_before; n < hits.count; ++n) hits.distance[n] += lying;
  for (std::size_t n = blocks_before; n < hits.blocks.count; ++n) hits.blocks.distance[n] += lying;
}

RecordSampler::RecordSampler(const RecordView& bone) noexcept
    : bone_(bone), metric_(bone.bone_from_index.linear / bone.bone_from_index.mean_edge()) {}

std::optional<SurfaceSample> RecordSampler::at(const Vec3& index) const noexcept {
  if (!is_finite(index) || glm::any(glm::lessThan(index, Vec3(bone_.valid.lo))) ||
      glm::any(glm::greaterThanEqual(index, Vec3(bone_.valid.hi - 1))))
    return std::nullopt;
  const Vec3i base = floor_int(index), size = bone_.box.size();
  const Vec3 f = index - Vec3(base);
  const std::size_t first = bone_.box.offset_of(base);
  const bool cut = bone_.cut.contains(base);
  SurfaceSample out = bone_.records8 != nullptr
                          ? between(bone_.records8 + first, size, f, metric_, cut, kRecord8Distance, kRecord8Normal)
                          : between(bone_.records16 + first, size, f, metric_, cut, kRecord16Distance, kRecord16Normal);
  const double length = glm::length(out.normal);
  out.normal = length > 0.0 ? out.normal / length : Vec3(0.0);
  out.distance += bone_.lying;
  return out;
}

}  // namespace burrhole
