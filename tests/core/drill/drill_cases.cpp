#include "tests/core/drill/drill_cases.h"

#include <cmath>
#include <cstdlib>

#include "core/base/random.h"

namespace burrhole::test {

Voxmap voxmap_of(const DenseBone& dense) {
  auto bone = BoneModel::create(dense);
  if (!bone) std::abort();
  auto voxmap = Voxmap::create(*bone, {});
  if (!voxmap || !voxmap->place_window(VoxelBox{Vec3i(0), dense.dims}.grown(2)).ok()) std::abort();
  return std::move(voxmap).value();
}

Voxmap Block::make() const {
  DenseBone dense;
  dense.dims = dims;
  dense.bone_from_index = Affine::scaling(pitch, Vec3(0.0));
  const std::size_t count = VoxelBox{Vec3i(0), dims}.count();
  dense.occupancy.assign(count, occupancy);
  dense.hardness.assign(count, hardness);
  return voxmap_of(dense);
}

Voxmap random_block(const Vec3i& dims, double pitch, std::uint64_t seed) {
  DenseBone dense;
  dense.dims = dims;
  dense.bone_from_index = Affine::scaling(pitch, Vec3(0.0));
  const std::size_t count = VoxelBox{Vec3i(0), dims}.count();
  for (std::uint64_t n = 0; n < count; ++n) {
    const double kind = uniform01(seed, 3 * n);
    dense.occupancy.push_back(kind < 0.2 ? 0.0f : kind < 0.4 ? 1.0f : static_cast<float>(uniform01(seed, 3 * n + 1)));
    dense.hardness.push_back(static_cast<float>(uniform01(seed, 3 * n + 2)));
  }
  return voxmap_of(dense);
}

bool Cylinder::holds(const Vec3& p) const { return p.z >= 0.0 && p.z <= height && p.x * p.x + p.y * p.y <= radius * radius; }
bool Ball::holds(const Vec3& p) const { return p.x * p.x + p.y * p.y + (p.z - radius) * (p.z - radius) <= radius * radius; }

ErosionPoints lattice(const std::function<bool(const Vec3&)>& holds, double reach, double pitch, float factor) {
  ErosionPoints points;
  points.pitch = pitch;
  const int half = static_cast<int>(std::ceil(reach / pitch));
  for (int k = 0; k < 2 * half; ++k)
    for (int j = -half; j < half; ++j)
      for (int i = -half; i < half; ++i) {
        const Vec3 p((i + 0.5) * pitch, (j + 0.5) * pitch, (k + 0.5) * pitch);
        if (holds(p)) points.positions.push_back(p);
      }
  points.factors.assign(points.positions.size(), factor);
  return points;
}

ErosionPoints lattice(const Cylinder& solid, double pitch, float factor) {
  return lattice([&](const Vec3& p) { return solid.holds(p); }, std::max(solid.radius, solid.height), pitch, factor);
}
ErosionPoints lattice(const Ball& solid, double pitch, float factor) {
  return lattice([&](const Vec3& p) { return solid.holds(p); }, solid.radius, pitch, factor);
}

ErosionPoints one_voxel(double voxel_pitch, float factor) {
  ErosionPoints points = lattice([](const Vec3&) { return true; }, 0.5 * voxel_pitch, 0.5 * voxel_pitch, factor);
  for (Vec3& p : points.positions) p.z -= 0.5 * voxel_pitch;
  return points;
}

Erosion make_erosion(const ErosionPoints& points, const ErosionConfig& config) {
  auto erosion = Erosion::create(config, points);
  if (!erosion) std::abort();
  return std::move(erosion).value();
}

Affine turned_pose(double voxel_pitch, const Vec3& tip, std::uint64_t seed) {
  const Vec3 axis = glm::normalize(Vec3(uniform11(seed, 1), uniform11(seed, 2), 0.3 + uniform01(seed, 3)));
  const double half_twist = 1.5 * uniform01(seed, 4);
  const Quat twist(std::cos(half_twist), 0.0, 0.0, std::sin(half_twist));
  return {glm::mat3_cast(rotation_from_z(axis) * twist) * (1.0 / voxel_pitch), tip};
}

Affine upright_pose(double voxel_pitch, const Vec3& tip) { return {Mat3(1.0 / voxel_pitch), tip}; }
Affine moved(const Affine& pose, const Vec3& by) { return {pose.linear, pose.offset + by}; }

void drill_step(Voxmap& voxmap, Erosion& erosion, const Affine& start, const Vec3& way, int n, int steps) {
  const auto at = [&](int m) { return moved(start, way * (static_cast<double>(m) / steps)); };
  voxmap.commit(erosion.step(voxmap, {at(n), at(n + 1)}, 1.0, 1e-3).changed);
}

void bring_back(Voxmap& voxmap) {
  voxmap.write_back();
  std::vector<BlockChange> changes;
  const VoxelBox box = voxmap.changed_bounds();
  for_each_voxel({Vec3i(glm::floor(Vec3(box.lo) / 8.0)), Vec3i(glm::ceil(Vec3(box.hi) / 8.0))}, [&](const Vec3i& block) {
    changes.push_back({block, nullptr});
  });
  voxmap.put_blocks(changes);
}

Drilling drill(Voxmap& voxmap, Erosion& erosion, const ErosionPath& path, double spin, double duration, int steps) {
  Drilling sum;
  const auto at = [&](int n) { return moved(path.from, (path.to.offset - path.from.offset) * (static_cast<double>(n) / steps)); };
  for (int n = 0; n < steps; ++n) {
    const ErosionOutcome outcome = erosion.step(voxmap, {at(n), at(n + 1)}, spin, duration / steps);
    voxmap.commit(outcome.changed);
    sum.mass += outcome.removed_mass;
    sum.touched += outcome.touched;
    sum.outside += outcome.outside;
    sum.substeps += outcome.substeps;
  }
  return sum;
}

double missing_mass(const Voxmap& voxmap) {
  const MasterWindow& window = voxmap.window();
  double sum = 0.0;
  for (std::size_t n = 0; n < window.remaining.size(); ++n)
    sum += static_cast<double>(window.occupancy[n]) * (1.0 - static_cast<double>(window.remaining[n]));
  return sum * voxmap.bone().bone_from_index().cell_volume();
}

PlainErosion::PlainErosion(const Voxmap& voxmap, const ErosionPoints& points, const ErosionConfig& config)
    : voxmap_(&voxmap), points_(points), config_(config) {}

void PlainErosion::step(const ErosionPath& path, int substeps, double spin, double dt) {
  const double edge = std::cbrt(voxmap_->bone().bone_from_index().cell_volume());
  const double share = std::pow(points_.pitch / edge, 3.0);
  for (int n = 0; n < substeps; ++n) {
    const double t = (n + 0.5) / substeps;
    std::map<Key, double> exposure;
    for (std::size_t m = 0; m < points_.size(); ++m) {
      const Vec3 a = path.from * points_.positions[m], b = path.to * points_.positions[m];
      const Vec3 p = a * (1.0 - t) + b * t;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double past_face = p[axis] + 0.5 - std::floor(p[axis] + 0.5);
        on_a_face_ += past_face < 1e-9 || past_face > 1.0 - 1e-9 ? 1 : 0;
      }
      ++met_;
      const Key key{static_cast<int>(std::floor(p.x + 0.5)), static_cast<int>(std::floor(p.y + 0.5)),
                    static_cast<int>(std::floor(p.z + 0.5))};
      exposure[key] += static_cast<double>(points_.factors[m]);
    }
    for (const auto& [key, e] : exposure) {
      const Vec3i v(std::get<0>(key), std::get<1>(key), std::get<2>(key));
      const double occupancy = static_cast<double>(voxmap_->bone().occupancy(v));
      if (occupancy == 0.0) continue;
      float hardness = 0.0f;
      voxmap_->bone().read_hardness({v, v + 1}, {&hardness, 1});
      Cell& cell = cells_[key];
      if (cell.remaining == 0.0) continue;
      cell.remaining *= std::exp(-e * spin * share * (dt / substeps) / std::max(0.1, static_cast<double>(hardness)));
      const double density = occupancy * cell.remaining, least = static_cast<double>(config_.minimum_density);
      // A thousand float roundings of 6e-8 each.
      cell.at_threshold = cell.at_threshold || std::abs(density - least) < 1e-4 * least;
      if (density < least) cell.remaining = 0.0;
    }
  }
}

TwinComparison compare(const Voxmap& voxmap, const PlainErosion& twin) {
  TwinComparison result;
  const MasterWindow& window = voxmap.window();
  for_each_voxel(window.box, [&](const Vec3i& v) {
    const auto found = twin.cells().find({v.x, v.y, v.z});
    const double expected = found == twin.cells().end() ? 1.0 : found->second.remaining;
    const double actual = static_cast<double>(window.remaining[window.box.offset_of(v)]);
    result.cleared += expected == 0.0 ? 1 : 0;
    result.differently_cleared += (expected == 0.0) != (actual == 0.0) ? 1 : 0;
    if (found != twin.cells().end() && found->second.at_threshold)
      ++result.at_threshold;
    else
      result.worst = std::max(result.worst, std::abs(expected - actual));
  });
  return result;
}

}  // namespace burrhole::test
